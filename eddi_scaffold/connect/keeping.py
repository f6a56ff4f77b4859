"""Drafts put into the text of a configuration: what a person wrote stays, to the byte."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from itertools import chain, repeat

from eddi_scaffold.common.files import Source
from eddi_scaffold.common.identifiers import TODO
from eddi_scaffold.common.problems import EddiError, Place, problem
from eddi_scaffold.config.topic_block import ConfigText
from eddi_scaffold.connect.draft import MARK, EntryDraft, is_own, option_lines
from eddi_scaffold.connect.topics import RobotTopic
from eddi_scaffold.kinds import JsonValue
from eddi_scaffold.yaml_text.nodes import (
    Items,
    Map,
    Node,
    Scalar,
    items_of,
    read_map,
    scalars_of,
    text_of,
)
from eddi_scaffold.yaml_text.spans import TextEditor, comments

_OUTPUTS = ("EDDIOutputs", "EDDIOoutputs", "EDDIOOutputs")
_SOURCES = ("from", "requires", "field", "expression", "expression_file", "event", "states")
_READ = ("from", "requires", "expression")
_MARKED = re.compile(rf"^[ \t]*{MARK}[^\n]*\n", re.MULTILINE)
_HEAD = (
    f"{MARK} drafted; lines that begin like this one are rewritten by the next run, all others",
    f"{MARK} are yours. What says TODO is to be decided: eddi-scaffold check lists it.",
)


@dataclass(frozen=True)
class Draft:
    """What a configuration should say."""

    model: Mapping[str, JsonValue]  # keys of `Model:` of a new configuration
    options: Mapping[str, JsonValue]  # keys of `Model:` that are added where they are missing
    notes: Mapping[tuple[str, ...], str]  # key path of an option -> what there is to decide
    entries: Sequence[EntryDraft]  # of `EDDIInputs`
    # id of a simulator output -> line of the age limit, empty where it needs none, `None` where it
    # is not known
    ages: Mapping[str, str | None] = field(default_factory=dict)


def with_draft(document: ConfigText, draft: Draft) -> str:
    """Return a configuration with what it does not say yet (EddiError K001: it has no place)."""
    text = document.text
    if text and not text.endswith("\n"):
        text += TextEditor(text).newline
    editor = _Editor(text)
    root = document.root
    sections = {key.text: (key, value) for key, value in root.entries}
    options = option_lines({**draft.model, **draft.options}, draft.notes)
    new_model = ["Model:", *(f"  {line}" for line in options)]
    if not sections:
        editor.replace(len(text), len(text), [*_HEAD, *new_model])
    elif "Model" not in sections:
        head = () if text[: root.start].strip() else _HEAD
        editor.replace(root.start, root.start, [*head, *new_model])
    else:
        editor.add_options(sections["Model"][1], draft.options, draft.notes)
    outputs = [sections[name][0].start for name in _OUTPUTS if name in sections]
    if "EDDIInputs" in sections:
        editor.complete_entries(*sections["EDDIInputs"], draft, document.name)
    else:
        lines = [line for entry in draft.entries for line in entry.lines()]
        body = ["EDDIInputs:", *(f"  {line}" for line in lines)] if lines else ["EDDIInputs: []"]
        place = min(outputs, default=len(text))
        editor.replace(place, place, body)
    after = editor.result()
    _refuse_loss(document, after)
    return after


class _Editor(TextEditor):
    def add_options(
        self,
        section: Node,
        options: Mapping[str, JsonValue],
        notes: Mapping[tuple[str, ...], str],
        path: tuple[str, ...] = (),
    ) -> None:
        """Add the keys that a map lacks, at its end."""
        if not isinstance(section, Map) or section.is_flow or not section.entries:
            return  # a person wrote something else there, or all of it in braces
        missing = {key: value for key, value in options.items() if section.get(key) is None}
        for key, value in options.items():
            below = section.get(key)
            if below is not None and isinstance(value, Mapping):
                self.add_options(below, value, notes, (*path, key))
        end = self.line_end(section.end)
        self.replace(end, end, option_lines(missing, notes, path), self.column(section.start))

    def complete_entries(self, key: Scalar, section: Node, draft: Draft, name: str) -> None:
        """Rewrite what is open in the entries that there are, and add the others behind them."""
        items = items_of(section)
        drafted = {entry.id: entry for entry in draft.entries}
        for item in items:
            entry = drafted.pop(text_of(item, "id") or "", None)
            if entry is not None and isinstance(item, Map) and not item.is_flow:
                self._refresh(item, entry, draft.ages)
        new = [line for entry in drafted.values() for line in entry.lines()]
        if new and items and isinstance(section, Items) and section.is_flow:
            raise EddiError(problem("K001.brackets", Place(name, section.place.line, 1)))
        if new and items:
            dash = self.text.rfind("-", 0, items[0].start)
            end = self.line_end(section.end)
            self.replace(end, end, new, self.column(dash))
        elif new:  # nothing yet, or []
            end = self.line_end(max(key.end, section.end))
            comments = self._comments(section, key.start, end)
            lines = [*comments, "EDDIInputs:", *(f"  {line}" for line in new)]
            self.replace(key.start, end, lines)

    def _refresh(self, item: Map, draft: EntryDraft, ages: Mapping[str, str | None]) -> None:
        """Decide anew what is TODO in an entry, and rewrite its comments."""
        pairs = {key.text: (key, value) for key, value in item.entries if key.text}
        column, end = self.column(item.start), self.line_end(item.end)
        open_keys = [key for key, (_, value) in pairs.items() if self._is_open(value)]
        sources = [key for key in pairs if key in _SOURCES]
        is_free = all(key in open_keys for key in sources)
        written = {
            key: "".join(scalar.text for scalar in scalars_of(value))
            for key, (_, value) in pairs.items()
            if key in (*_SOURCES, "unit")
        }
        is_taken = bool(written) and written == draft.taken
        is_ours = is_free or is_taken
        has_reasons = is_ours or any(key in open_keys for key in sources)
        why, is_new = draft.why if has_reasons else (), bool(open_keys or not sources)
        self._comment(item, why, column, is_new=is_new)
        if is_free:
            for key in sources:
                self._replace_line(*pairs[key], draft.source if key == sources[0] else (), column)
            if not sources:
                self.replace(end, end, draft.source, column)
        age: str | None = draft.age
        if not is_ours:  # of the output that it is made of, if that is only one
            values = [pairs[key][1] for key in _READ if key in pairs]
            text = " ".join(self.text[value.start : value.end] for value in values)
            used = {*re.findall(r"\w+", text)} & {*ages}
            age = ages[used.pop()] if len(used) == 1 else None
        if "max_age" in open_keys and age is not None:
            self._replace_line(*pairs["max_age"], (age,) if age else (), column)

    def _comment(self, item: Map, why: Sequence[str], column: int, *, is_new: bool) -> None:
        """Replace the comments of this command in an entry by others, behind its first line."""
        start, end = self.line_start(item.start), self.line_end(item.end)
        value = item.entries[0][1]
        first = self.line_end(value.end)
        if not isinstance(value, Scalar) or first > end:
            return  # the first value takes several lines
        # a text of several lines may have one that looks like ours
        ours = [
            line.span()
            for line in _MARKED.finditer(self.text, start, end)
            if not any(s.start < line.end() and line.start() < s.end for s in scalars_of(item))
        ]
        new = "".join(f"{' ' * column}{line}{self.newline}" for line in why)
        is_there = len(ours) == len(why) and self.text.startswith(new, first)
        if not is_there and (ours or is_new):
            for line_start, line_end in ours:
                self.replace(line_start, line_end, ())
            self.replace(first, first, why, column)

    def _replace_line(self, key: Scalar, value: Node, lines: Sequence[str], column: int) -> None:
        """Replace the line of a key whose value is TODO; comments of a person get lines above."""
        start, end = self.line_start(key.start), self.line_end(max(key.end, value.end))
        if self.text[start : key.start].strip():  # the first one, behind the dash
            return
        comments = self._comments(value, start, end)
        was = self.text[start:end].partition("#")[0].split()
        if comments and [line.partition("#")[0].split() for line in lines] == [was]:
            return  # still open, and a person says why
        self.replace(start, end, [*comments, *lines], column)

    def _comments(self, value: Node, start: int, end: int) -> list[str]:
        """Return what a person wrote as comments between two offsets."""
        texts = comments(self.text, value, start, end).values()
        return [text for text in texts if not is_own(text)]

    def _is_open(self, value: Node) -> bool:
        """Return whether a value is TODO, or a map of nothing else."""
        if isinstance(value, Map) and value.entries:
            return all(self._is_open(inner) for _, inner in value.entries)
        return self.text[value.start : value.end] == TODO


def _refuse_loss(document: ConfigText, after: str) -> None:
    """Refuse a text in which something that a person wrote would be gone or elsewhere."""
    new, problems = read_map(Source(document.name, after.encode()), "K001")
    lost = next(_lost(document.root, new), None)
    if problems or lost is not None:
        place = lost.place if lost is not None else Place(document.name)
        raise EddiError(problem("K001.crowded", place))


def _lost(old: Node, new: Node | None) -> Iterator[Node]:
    """Yield what is not in the new document, of all that is decided in the old one."""
    if isinstance(old, Scalar):
        if old != new and not (old.plain and old.text in (TODO, "", "null", "~")):
            yield old
    elif isinstance(old, Map):
        for key, value in old.entries:
            yield from _lost(value, new.get(key.text) if isinstance(new, Map) else None)
    else:
        items = new.items if isinstance(new, Items) else ()
        for item, other in zip(old.items, chain(items, repeat(None)), strict=False):
            yield from _lost(item, other)


def model_id(root: Map) -> str | None:
    """Return the id of the model that a configuration is of, ``None`` while that is open."""
    name = text_of(root.get("Model"), "id")
    return name if name and name != TODO else None


def topics_of(document: ConfigText) -> list[RobotTopic]:
    """Return the topics of a configuration, the first of each id."""
    topics: dict[str, RobotTopic] = {}
    for old in (entry for entry in document.old if entry.type):
        message = old.type.replace("/msg/", "/").replace(".", "/")
        topics.setdefault(old.id, RobotTopic(old.id, message, old.topic))
    return list(topics.values())
