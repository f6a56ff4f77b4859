"""Drafts put into the text of a configuration: what a person wrote stays, to the byte."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

from eddi_scaffold.common.files import Source
from eddi_scaffold.common.problems import EddiError, Place, problem
from eddi_scaffold.config.message_types import Fields, declared
from eddi_scaffold.config.topic_block import ConfigText
from eddi_scaffold.connect.draft import MARK, EntryDraft, is_own, option_lines
from eddi_scaffold.connect.name_words import Synonyms, words
from eddi_scaffold.connect.topics import RobotTopic
from eddi_scaffold.kinds import TODO, JsonValue
from eddi_scaffold.yaml_text.nodes import (
    Items,
    Map,
    Node,
    Scalar,
    dump_plain,
    items_of,
    read_map,
    value_11,
)
from eddi_scaffold.yaml_text.spans import Span, comment_texts, spans

_OUTPUTS = ("EDDIOutputs", "EDDIOoutputs", "EDDIOOutputs")
_SOURCES = ("requires", "field", "expression", "expression_file", "event", "states")
_MARKED = re.compile(rf"[ \t]*{MARK}")
_HEAD = (
    f"{MARK} drafted; lines that begin like this one are rewritten by the next run, all others",
    f"{MARK} are yours. What says TODO is to be decided: eddi-scaffold check lists it.",
)


@dataclass(frozen=True)
class Draft:
    """What a configuration should say.

    Attributes:
        model: keys of ``Model:`` of a new configuration.
        options: keys of ``Model:`` that are added where they are missing.
        notes: key path of an option -> what there is to decide.
        entries: of ``EDDIInputs``.
        outputs: of ``EDDIOutputs``.
        ages: id of a simulator output -> line of the age limit, empty where it needs none, ``None``
            where it is not known.
    """

    model: Mapping[str, JsonValue]
    options: Mapping[str, JsonValue]
    notes: Mapping[tuple[str, ...], str]
    entries: Sequence[EntryDraft]
    outputs: Sequence[Mapping[str, JsonValue]]
    ages: Mapping[str, str | None] = field(default_factory=dict)


def with_draft(document: ConfigText, draft: Draft) -> str:
    """Return the text of a configuration with what it does not say yet.

    Raises:
        EddiError: it is written so that nothing can be added (K001).
    """
    text = document.text
    if text and not text.endswith("\n"):
        text += document.line_end
    root = spans(text, document.name)
    editor = _Editor(text, document.name, document.line_end)
    if root is None or not root.children:
        editor.insert(len(text), [*_HEAD, *_model(draft)])
        root = None
    elif root.get("Model") is None:
        head = [] if text[: root.start].strip() else _HEAD
        editor.insert(root.start, [*head, *_model(draft)])
    else:
        editor.add_options(root, draft)
    editor.add_entries(root, draft)
    if root is None or all(root.get(name) is None for name in _OUTPUTS):
        lines = dump_plain({"EDDIOutputs": list(draft.outputs)}).splitlines()
        editor.insert(len(text), lines)
    after = editor.result()
    _refuse_loss(document, text, after)
    return after


def _model(draft: Draft) -> list[str]:
    lines = option_lines({**draft.model, **draft.options}, draft.notes)
    return ["Model:", *(f"  {line}" for line in lines)]


@dataclass
class _Editor:
    """Changes of a text, each between two offsets of it."""

    text: str
    name: str
    line_end: str
    edits: list[tuple[int, int, int, str]] = field(default_factory=list)

    def insert(self, at: int, lines: Sequence[str], column: int = 0) -> None:
        self.replace(at, at, lines, column)

    def replace(self, start: int, end: int, lines: Sequence[str], column: int = 0) -> None:
        new = "".join(f"{' ' * column}{line}{self.line_end}" for line in lines)
        if self.text[start:end] != new:
            self.edits.append((start, len(self.edits), end, new))

    def result(self) -> str:
        """Return the text with all changes; those at one offset in the order they came."""
        parts, done = [], 0
        for start, _, end, new in sorted(self.edits):
            parts += [self.text[done:start], new]
            done = max(done, end)
        return "".join([*parts, self.text[done:]])

    def add_options(self, root: Span, draft: Draft) -> None:
        model = root.get("Model")
        assert model is not None
        self._add_below(model, draft.options, draft.notes, ())

    def _add_below(
        self,
        into: Span,
        options: Mapping[str, JsonValue],
        notes: Mapping[tuple[str, ...], str],
        path: tuple[str, ...],
    ) -> None:
        """Add the keys that a map lacks, at its end."""
        if not into.is_map or into.is_flow or not into.children:
            return  # a person wrote something else there, or all of it in braces
        column = into.children[0].start - self._line_start(into.children[0].start)
        missing = {key: value for key, value in options.items() if into.get(key) is None}
        for key, value in options.items():
            below = into.get(key)
            if below is not None and isinstance(value, Mapping):
                self._add_below(below, value, notes, (*path, key))
        lines = option_lines(missing, notes, path)
        self.insert(self._line_end(into.end), lines, column)

    def add_entries(self, root: Span | None, draft: Draft) -> None:
        """Rewrite what is open in the entries that there are, and add the others behind them."""
        entries = draft.entries
        key, section = _section(root, "EDDIInputs")
        if key is None or section is None:
            new = [line for entry in entries for line in entry.lines()]
            body = ["EDDIInputs:", *(f"  {line}" for line in new)] if new else ["EDDIInputs: []"]
            before = next((k for k in _keys_of(root) if k.text in _OUTPUTS), None)
            self.insert(len(self.text) if before is None else before.start, body)
            return
        items = section.children if not section.is_map else []
        there = {entry.id: entry for entry in entries}
        known = set()
        for item in items:
            id_ = item.get("id") if item.is_map else None
            if id_ is not None and id_.text is not None:
                known.add(id_.text)
                if id_.text in there:
                    refresh = self._refresh_age if item.is_flow else self._refresh
                    refresh(item, there[id_.text], draft.ages)
        new = [line for entry in entries if entry.id not in known for line in entry.lines()]
        if new and items and section.is_flow:
            place = Place(self.name, section.line, 1)
            raise EddiError(problem("K001.brackets", place))
        if new and items:
            dash = self.text.rfind("-", 0, items[0].start)
            self.insert(self._line_end(section.end), new, dash - self._line_start(dash))
        elif new:  # nothing yet, or []
            end = self._line_end(max(key.end, section.end))
            theirs = self._comments(section, key.start, end)
            self.replace(key.start, end, [*theirs, "EDDIInputs:", *(f"  {line}" for line in new)])

    def _refresh(self, item: Span, draft: EntryDraft, ages: Mapping[str, str | None]) -> None:
        """Decide anew what is TODO in an entry, and rewrite its comments."""
        pairs = {key.text: (key, value) for key, value in item.entries() if key.text}
        column = item.start - self._line_start(item.start)
        open_ = [key for key, (_, value) in pairs.items() if self._is_open(value)]
        sources = [key for key in pairs if key in _SOURCES]
        is_free = all(key in open_ for key in sources)
        is_ours = is_free or self._takes(pairs, draft)
        has_reasons = is_ours or any(key in open_ for key in sources)
        self._comment(
            item, draft.why if has_reasons else (), column, is_new=bool(open_ or not sources)
        )
        if is_free and sources:
            for number, key in enumerate(sources):
                self._replace_line(pairs[key], draft.source if number == 0 else (), column)
        elif is_free:
            self.insert(self._line_end(item.end), draft.source, column)
        age = draft.age if is_ours else self._age(pairs, ages)
        if "max_age" in open_ and age is not None:
            self._replace_line(pairs["max_age"], (age,) if age else (), column)

    def _refresh_age(self, item: Span, draft: EntryDraft, ages: Mapping[str, str | None]) -> None:
        """Decide an open age limit of an entry in braces, where the source is decided."""
        pairs = {key.text: (key, value) for key, value in item.entries() if key.text}
        age = draft.age if self._takes(pairs, draft) else self._age(pairs, ages)
        if "max_age" in pairs and self._is_open(pairs["max_age"][1]) and age:
            key, value = pairs["max_age"]
            text, _, _ = age.partition("  #")  # a comment would end the braces
            self.edits.append((key.start, len(self.edits), value.end, text))

    def _age(
        self, pairs: Mapping[str, tuple[Span, Span]], ages: Mapping[str, str | None]
    ) -> str | None:
        """Return the age limit of the output that an entry is made of, if it is only one."""
        values = [pairs[key][1] for key in ("requires", "expression") if key in pairs]
        words = {
            word
            for value in values
            for word in re.findall(r"\w+", self.text[value.start : value.end])
        }
        used = [line for name, line in ages.items() if name in words]
        return used[0] if len(used) == 1 else None

    def _takes(self, pairs: Mapping[str, tuple[Span, Span]], draft: EntryDraft) -> bool:
        """Return whether an entry says what would be drafted."""
        said = {
            key: value.text or "".join(child.text or "" for child in value.children)
            for key, (_, value) in pairs.items()
            if key in (*_SOURCES, "unit")
        }
        return bool(said) and said == dict(draft.taken)

    def _comment(self, item: Span, why: Sequence[str], column: int, *, is_new: bool) -> None:
        """Replace the comments of this command in an entry by others, behind its first line."""
        start, end = self._line_start(item.start), self._line_end(item.end)
        first = self._line_end(item.children[1].end)
        if item.children[1].children or first > end:
            return  # the first value takes several lines
        texts = item.scalars  # a text of several lines may have one that looks like ours
        old = [
            (start + found.start(), start + found.end())
            for found in re.finditer(r"[^\n]*\n", self.text[start:end])
            if _MARKED.match(found[0])
            and not any(a < start + found.end() and start + found.start() < b for a, b in texts)
        ]
        new = "".join(f"{' ' * column}{line}{self.line_end}" for line in why)
        is_there = len(old) == len(why) and self.text.startswith(new, first)
        if is_there or not (old or is_new):
            return
        for a, b in old:
            self.replace(a, b, ())
        self.insert(first, why, column)

    def _replace_line(self, pair: tuple[Span, Span], lines: Sequence[str], column: int) -> None:
        """Replace the line of a key whose value is TODO; comments of a person get lines above."""
        key, value = pair
        start, end = self._line_start(key.start), self._line_end(max(key.end, value.end))
        if self.text[start : key.start].strip():  # the first one, behind the dash
            return
        theirs = self._comments(value, start, end)
        was = self.text[start:end].partition("#")[0].split()
        if theirs and [line.partition("#")[0].split() for line in lines] == [was]:
            return  # still open, and a person says why
        self.replace(start, end, [*theirs, *lines], column)

    def _comments(self, value: Span, start: int, end: int) -> list[str]:
        """Return what a person wrote as comments between two offsets."""
        return [
            comment_text
            for comment_text in comment_texts(self.text, value, start, end)
            if not is_own(comment_text)
        ]

    def _is_open(self, value: Span) -> bool:
        """Return whether a value is TODO, or a map of nothing else."""
        if value.is_map and value.children:
            return all(self._is_open(one) for _, one in value.entries())
        return self.text[value.start : value.end] == TODO

    def _line_start(self, offset: int) -> int:
        return self.text.rfind("\n", 0, offset) + 1

    def _line_end(self, offset: int) -> int:
        return self.text.find("\n", offset) + 1 or len(self.text)


def _keys_of(root: Span | None) -> Iterator[Span]:
    return (key for key, _ in root.entries()) if root is not None else iter(())


def _section(root: Span | None, name: str) -> tuple[Span | None, Span | None]:
    pairs = root.entries() if root is not None else iter(())
    return next(((key, value) for key, value in pairs if key.text == name), (None, None))


def _refuse_loss(document: ConfigText, before: str, after: str) -> None:
    """Refuse a text in which something that a person wrote would be gone or elsewhere.

    Raises:
        EddiError: it is written in a way that was not foreseen (K001).
    """
    old, _ = read_map(Source(document.name, before.encode()), "K001")
    new, problems = read_map(Source(document.name, after.encode()), "K001")
    lost = _lost(old, new) if old is not None and new is not None else None
    if problems or new is None or lost is not None:
        place = lost.place if lost is not None else Place(document.name)
        raise EddiError(problem("K001.crowded", place))


def _lost(old: Node, new: Node | None) -> Node | None:
    """Return what is not in the new document, of all that is decided in the old one."""
    if isinstance(old, Scalar):
        is_open = old.plain and old.text in (TODO, "", "null", "~")
        return None if is_open or old == new else old
    if isinstance(old, Map):
        there = new if isinstance(new, Map) else None
        inner = ((value, there.get(key.text) if there else None) for key, value in old.entries)
    else:
        items: tuple[Node | None, ...] = new.items if isinstance(new, Items) else ()
        filled = (*items, *([None] * len(old.items)))
        inner = ((item, filled[k]) for k, item in enumerate(old.items))
    return next((lost for a, b in inner if (lost := _lost(a, b)) is not None), None)


def content(document: ConfigText) -> Map:
    """Return the content of a configuration, empty where it says nothing.

    Raises:
        EddiError: it is no YAML map (K001).
    """
    lines = (line.strip() for line in document.text.splitlines())
    if all(not line or line.startswith("#") for line in lines):
        return Map(())
    node, problems = read_map(Source(document.name, document.text.encode()), "K001")
    if node is None or problems:
        raise EddiError(*problems)
    return node


def section_of(root: Map) -> Mapping[str, Any]:
    """Return the values of ``Model:``."""
    section = root.get("Model")
    return value_11(section) if isinstance(section, Map) else {}


def model_id(root: Map) -> str | None:
    """Return the id of the model that a configuration is of, ``None`` while that is open."""
    section = root.get("Model")
    name = text_of(section, "id") if section is not None else None
    return name if name and name != TODO else None


def text_of(node: Node, key: str) -> str | None:
    """Return the text of a key, ``None`` where there is none."""
    value = node.get(key) if isinstance(node, Map) else None
    return value.text if isinstance(value, Scalar) else None


def topics_of(root: Map) -> list[RobotTopic]:
    """Return the topics of a configuration, the first of each id."""
    section = root.get("SimulatorOutputs") or root.get("SimulatorOutput")
    found: dict[str, RobotTopic] = {}
    for item in items_of(section):
        id_, type_, topic = (text_of(item, key) for key in ("id", "type", "topic"))
        if id_ and type_ and topic:
            name = type_.replace("/msg/", "/").replace(".", "/")
            found.setdefault(id_, RobotTopic(id_, name, topic))
    return list(found.values())


def declared_types(root: Map) -> dict[str, Fields]:
    """Return the message types that a configuration declares itself."""
    given = root.get("MessageTypes")
    return {
        name.text: declared(
            ((text_of(fields, one) or "", one) for one in fields.keys()),  # noqa: SIM118 - no dict
            name.text.partition("/")[0],
        )
        for name, fields in (given.entries if isinstance(given, Map) else ())
        if isinstance(fields, Map)
    }


def synonyms_of(root: Map) -> Synonyms:
    """Return the words that a configuration says mean the same."""
    section = root.get("connect")
    groups = items_of(section.get("synonyms")) if isinstance(section, Map) else ()
    return frozenset(
        frozenset(
            word
            for item in items_of(group)
            if isinstance(item, Scalar)
            for word in words(item.text)
        )
        for group in groups
    )
