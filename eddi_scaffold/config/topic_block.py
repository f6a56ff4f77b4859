"""Replace the block ``SimulatorOutputs`` of an ``eddi_config.yml`` as text.

Every other byte stays. In the block itself, an entry whose id, type and topic are the same stays as
it is written; of others the further keys (``max_age``) and the comments stay with their topic.
"""

from __future__ import annotations

import re
from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass, field

from eddi_scaffold.common.files import Source
from eddi_scaffold.common.problems import EddiError, Place, Problem, SimilarNames, problem
from eddi_scaffold.mros.topics import TopicEntry
from eddi_scaffold.yaml_text.nodes import (
    NOT_YAML,
    Map,
    Node,
    Scalar,
    items_of,
    quoted,
    read_document,
    scalars_of,
    text_of,
)
from eddi_scaffold.yaml_text.spans import TextEditor, comments

_NAMES = ("SimulatorOutputs", "SimulatorOutput")
_KEYS = ("id", "type", "topic")
_WORDS = re.compile(r"\w+")
_NOTHING = re.compile(r"(?:[ \t]*(?:#[^\n]*)?\r?\n)*[ \t]*(?:#[^\n]*)?")


@dataclass(frozen=True)
class OldEntry(TopicEntry):
    """One entry of the block, with its type as written."""

    text: str = ""  # as written, without the dash, to the end of its last line
    column: int = 0  # blanks in front of it, which its further lines have as well
    more: tuple[str, ...] = ()  # the keys other than id, type and topic, as written
    above: Mapping[int, str] = field(default_factory=dict)  # line -> comment in front of it
    inside: Mapping[int, str] = field(default_factory=dict)  # line -> comment in its text

    def lines(self) -> list[str]:
        """Return its lines as they are, two blanks in."""
        first, *rest = self.text.split("\n")
        more = (_dedented(line, self.column) for line in rest)
        comments = (f"  {comment}" for comment in self.above.values())
        return [*comments, f"  - {first}", *(f"    {line}" if line else "" for line in more)]


@dataclass(frozen=True)
class ConfigText:
    """A configuration as text, with the places that matter here."""

    name: str  # of the file
    text: str  # without byte order mark; empty where there is no file
    root: Map = field(default=Map(()))  # its content, empty where it says nothing
    start: int = 0  # offset of the block; where it would be put when there is none
    end: int = 0  # offset behind the line in which it ends; equal to `start` when there is none
    old: tuple[OldEntry, ...] = ()  # its entries
    head: str = ""  # the comment behind the name of the block
    # lines of the block that hold a comment, where it is a list in brackets
    comments: tuple[int, ...] = ()
    is_new: bool = False  # there is no file

    def inputs(self) -> Iterator[Map]:
        """Yield the entries of ``EDDIInputs``."""
        return (item for item in items_of(self.root.get("EDDIInputs")) if isinstance(item, Map))

    def used(self) -> set[str]:
        """Return the words of the inputs, among them the ids that their expressions name."""
        pairs = (pair for entry in self.inputs() for pair in entry.entries if pair[0].text != "id")
        texts = [scalar.text for _, value in pairs for scalar in scalars_of(value)]
        return {word for text in texts for word in (text, *_WORDS.findall(text))}


def read_block(source: Source) -> ConfigText:
    """Find the block in a configuration (EddiError K001: its form does not allow a change)."""
    text = source.data.decode("utf-8-sig", "replace")
    if _NOTHING.fullmatch(text) and not NOT_YAML.search(text):
        return ConfigText(source.name, text, start=len(text), end=len(text))
    node, problems = read_document(source, "K001")
    if node is None or problems:
        raise EddiError(*problems)
    if not isinstance(node, Map):
        raise EddiError(problem("K001.map", node.place))
    if node.is_flow:
        raise EddiError(problem("K001.braces", node.place))
    block = [(key, value) for key, value in node.entries if key.text in _NAMES]
    editor = TextEditor(text)
    if not block:
        sections = {key.text: (key, value) for key, value in node.entries}
        start = len(text)
        if "Model" in sections:
            start = editor.line_end(max(part.end for part in sections["Model"]))
        elif "EDDIInputs" in sections:
            start = sections["EDDIInputs"][0].start
        return ConfigText(source.name, text, node, start, start)
    if len(block) > 1:
        lines = " and ".join(f"{key.text} in line {key.place.line}" for key, _ in block)
        place = Place(source.name, block[1][0].place.line, 1)
        raise EddiError(problem("K001.two_spellings", place, spellings=lines))
    ((key, value),) = block
    end = editor.line_end(max(value.end, key.end) if value.end > value.start else key.end)
    is_flow = not isinstance(value, Scalar) and value.is_flow
    behind = value.end if is_flow else key.end
    head = re.search(r"\s+#.*", text[behind : editor.line_end(behind)].rstrip())
    return ConfigText(
        source.name,
        text,
        node,
        key.start,
        end,
        tuple(_old_entries(editor, source.name, key, value)),
        head[0] if head else "",
        tuple(comments(text, value, key.start, value.end)) if is_flow else (),
    )


def rewritten(
    document: ConfigText, entries: Sequence[TopicEntry], lost: Collection[str] = ()
) -> tuple[str, list[Problem]]:
    """Return the text with another block, and what a person should know.

    An entry of the old block whose topic is not among the new ones is dropped, unless that is
    ``lost``, because something did not resolve, or an input requires its id: that one is typically
    the output of another monitor.
    """
    topics, ids = {entry.topic for entry in entries}, {entry.id for entry in entries}
    old = {entry.topic: entry for entry in document.old}
    lines = [line for entry in entries for line in _lines(entry, old.get(entry.topic))]
    problems: list[Problem] = []
    used, gone, kept = document.used(), set(document.comments), []
    for entry in document.old:
        if entry.topic in topics:
            continue
        case = "M026.stays" if entry.topic in lost else "M026.needed"
        if entry.id in ids or not (entry.topic in lost or entry.id in used):
            case = "M026.dropped"
            gone.update(entry.above, entry.inside)
        else:
            lines += entry.lines()
            kept.append(entry.id)
        problems.append(problem(case, entry.place, id=entry.id, topic=entry.topic))
    if gone:
        numbers = ", ".join(map(str, sorted(gone)))
        place = Place(document.name, min(gone), 1)
        problems.append(problem("M026.comments", place, lines=numbers))
    lines = [f"SimulatorOutputs:{'' if lines else ' []'}{document.head}", *lines]
    editor = TextEditor(document.text)
    editor.replace(document.start, document.end, lines)
    similar, known = SimilarNames(sorted({*ids, *kept})), {"", *ids, *kept}
    for scalar in (s for entry in document.inputs() for s in scalars_of(entry.get("requires"))):
        name, place = scalar.text, Place(document.name, scalar.place.line, 1)
        if name not in known:
            problems.append(problem("M023.requires", place, hint=similar.hint(name), name=name))
        known.add(name)
    text = editor.result()
    _, faults = read_document(Source(document.name, text.encode()), "K001")
    if faults:  # an anchor that was in the block is used elsewhere
        raise EddiError(*faults)
    return text, problems


def extended(document: ConfigText, entries: Sequence[TopicEntry]) -> str:
    """Return the text with more entries, behind those that there are."""
    if not entries:
        return document.text
    dash = re.search(r"(?m)^([ ]*)-", document.text[document.start : document.end])
    if dash is None or not document.old:  # no block yet, or one in brackets
        return rewritten(document, entries, {old.topic for old in document.old})[0]
    lines = [line.removeprefix("  ") for entry in entries for line in _lines(entry, None)]
    editor = TextEditor(document.text)
    editor.replace(document.end, document.end, lines, len(dash[1]))
    return editor.result()


def _lines(entry: TopicEntry, old: OldEntry | None) -> list[str]:
    if old is not None and (old.id, old.type) == (entry.id, entry.type):
        return old.lines()
    values = (quoted(entry.id), quoted(entry.type), quoted(entry.topic))
    first, *rest = [f"{key}: {value}" for key, value in zip(_KEYS, values, strict=True)]
    more = [line for text in (old.more if old else ()) for line in text.split("\n")]
    comments = {**old.above, **old.inside} if old else {}
    above = (f"  {comment}" for comment in comments.values())
    return [*above, f"  - {first}", *(f"    {line}" for line in (*rest, *more))]


def _dedented(line: str, column: int) -> str:
    return line[column:] if not line[:column].strip() else line.lstrip()


def _old_entries(editor: TextEditor, name: str, key: Scalar, value: Node) -> Iterator[OldEntry]:
    text, done = editor.text, editor.line_end(key.end)
    is_flow = not isinstance(value, Scalar) and value.is_flow
    for item in items_of(value):
        before, done = done, editor.line_end(item.end)
        id_, type_, topic = (text_of(item, of) for of in _KEYS)
        if not isinstance(item, Map) or not id_ or not topic:
            continue
        column = editor.column(item.start)
        more = []
        for own_key, inner in item.entries:
            if own_key.text not in _KEYS:
                written = text[own_key.start : max(own_key.end + 1, inner.end)].replace("\r", "")
                first, *rest = written.split("\n")
                more.append("\n".join([first, *(_dedented(line, column) for line in rest)]))
        end = item.end if is_flow else done
        # comments in brackets are those of the block: it is not known of which entry they are
        comments_from, comments_to = (item.start, item.start) if is_flow else (before, done)
        yield OldEntry(
            id_,
            type_ or "",
            topic,
            Place(name, item.place.line, 1),
            text[item.start : end].replace("\r", "").rstrip(),
            column,
            tuple(more),
            comments(text, value, comments_from, item.start),
            comments(text, value, item.start, comments_to),
        )
