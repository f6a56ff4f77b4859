"""Replace the block ``SimulatorOutputs`` of an ``eddi_config.yml`` as text.

Every other byte stays: comments, order, quoting, line ends. Of the block itself, keys other than
id, type and topic (``max_age``) stay with their topic.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass

from eddi_scaffold.positioned_yaml.nodes import quoted, read_document
from eddi_scaffold.positioned_yaml.scalars import Map
from eddi_scaffold.positioned_yaml.spans import Span, comments, spans
from eddi_scaffold.problems import EddiError, NearNames, Place, Problem, error, warning
from eddi_scaffold.source import Source

KEPT_ENTRY = "M026"
_NAMES = ("SimulatorOutputs", "SimulatorOutput")
_KEYS = ("id", "type", "topic")
_NOTHING = re.compile(rb"(?:\xef\xbb\xbf)?(?:[ \t]*(?:#[^\n]*)?\r?\n)*[ \t]*(?:#[^\n]*)?")


@dataclass(frozen=True)
class TopicEntry:
    """One entry to be written: id, type and topic."""

    id: str
    type: str
    topic: str


@dataclass(frozen=True)
class OldEntry:
    """One entry of the block.

    Attributes:
        text: as written, without the dash.
        column: blanks in front of it, which its further lines have as well.
        more: the keys other than id, type and topic, as written.
    """

    id: str
    topic: str
    text: str
    column: int
    line: int
    more: tuple[str, ...] = ()


@dataclass(frozen=True)
class Absence:
    """Why an entry of the old block is not among the new ones.

    Attributes:
        why: what is reported about it.
        stays: it is kept, whether an input requires it or not.
    """

    why: str = "is not published by the system"
    stays: bool = False


@dataclass(frozen=True)
class ConfigText:
    """A configuration as text, with the places that matter here.

    Attributes:
        name: of the file.
        text: without byte order mark.
        start: offset of the block; where it would be put when there is none.
        end: offset behind the line in which it ends; equal to ``start`` when there is none.
        old: its entries.
        comments: lines of the block that hold a comment.
        required: id that an input requires -> line.
    """

    name: str
    text: str
    start: int
    end: int
    old: tuple[OldEntry, ...] = ()
    comments: tuple[int, ...] = ()
    required: Mapping[str, int] | None = None

    @property
    def line_end(self) -> str:
        """The line end of the file."""
        return "\r\n" if "\r\n" in self.text else "\n"


def read_block(source: Source) -> ConfigText:
    """Find the block in a configuration.

    Raises:
        EddiError: the file is not a YAML mapping (K001), is written in one pair of braces (K037),
            has the block under both of its names (K035), or uses an anchor of it elsewhere (K036).
    """
    if _NOTHING.fullmatch(source.data):
        text = source.data.decode("utf-8-sig", "replace")
        return ConfigText(source.name, text, len(text), len(text))
    node, problems = read_document(source, "K001")
    if node is None or problems:
        raise EddiError(*problems)
    text = source.data.decode("utf-8-sig")
    if not isinstance(node, Map):
        message = "the top level must be a map with the sections of an eddi_config.yml"
        raise EddiError(error("K001", message, node.place))
    root = spans(text, source.name)
    if root is None or root.is_flow:
        message = "the file is one map in braces, in which no block can be replaced"
        hint = "write each section on lines of its own"
        raise EddiError(error("K037", message, node.place, hint))
    found = [(key, value) for key, value in root.entries() if key.text in _NAMES]
    required = _required(root)
    if not found:
        where = _insertion(text, root)
        return ConfigText(source.name, text, where, where, required=required)
    if len(found) > 1:
        lines = " and ".join(f"{key.text} in line {key.line}" for key, _ in found)
        place = Place(source.name, found[1][0].line, 1)
        hint = "keep SimulatorOutputs, which is the name that is written"
        raise EddiError(error("K035", f"there are both {lines}", place, hint))
    ((key, value),) = found
    _refuse_anchors(source.name, root, value)
    start = key.start
    end = _line_end(text, max(value.end, key.end) if value.end > value.start else key.end)
    return ConfigText(
        source.name,
        text,
        start,
        end,
        tuple(_old_entries(text, value)),
        tuple(comments(text, value, start, end)),
        required,
    )


def rewritten(
    document: ConfigText,
    entries: Sequence[TopicEntry],
    absence: Callable[[OldEntry], Absence] = lambda _: Absence(),
) -> tuple[str, list[Problem]]:
    """Return the text with another block, and what a person should know.

    An entry of the old block whose topic is not among the new ones is dropped, unless ``absence``
    shows that it stays, or an input requires its id: that one is typically the output of another
    monitor, and stays.
    """
    topics = {entry.topic for entry in entries}
    old = {entry.topic: entry for entry in document.old}
    foreign = [(entry, absence(entry)) for entry in document.old if entry.topic not in topics]
    required = document.required or {}
    ids = {entry.id for entry in entries}
    kept = [
        one for one, absent in foreign if (absent.stays or one.id in required) and one.id not in ids
    ]
    lines = [line for one in entries for line in _lines(one, old.get(one.topic))]
    lines += [line for one in kept for line in _item(one.text, one.column)]
    body = ["SimulatorOutputs:", *lines] if lines else ["SimulatorOutputs: []"]
    block = "".join(line + document.line_end for line in body)
    before, after = document.text[: document.start], document.text[document.end :]
    if before and not before.endswith("\n"):
        before += document.line_end
    problems = _notes(document, foreign, kept)
    problems += _unmet(document, [*ids, *(one.id for one in kept)])
    return before + block + after, problems


def extended(document: ConfigText, entries: Sequence[TopicEntry]) -> str:
    """Return the text with more entries, behind those that there are."""
    if not entries:
        return document.text
    dash = re.search(r"(?m)^([ ]*)-", document.text[document.start : document.end])
    if dash is None or not document.old:  # no block yet, or one in brackets
        return rewritten(document, entries, lambda _: Absence(stays=True))[0]
    lines = [line.removeprefix("  ") for one in entries for line in _lines(one, None)]
    new = "".join(f"{dash[1]}{line}{document.line_end}" for line in lines)
    before = document.text[: document.end]
    before += "" if before.endswith("\n") else document.line_end
    return before + new + document.text[document.end :]


def _notes(
    document: ConfigText, foreign: Sequence[tuple[OldEntry, Absence]], kept: Sequence[OldEntry]
) -> list[Problem]:
    problems: list[Problem] = []
    for one, absent in foreign:
        place = Place(document.name, one.line, 1)
        what = f"{one.id!r} ({one.topic}) {absent.why}"
        if one not in kept:
            problems.append(warning("M027", f"{what}; it is dropped", place))
        elif absent.stays:
            problems.append(warning(KEPT_ENTRY, f"{what}; it stays as it is", place))
        else:
            message = f"{what}; it stays, because an input needs it"
            problems.append(warning(KEPT_ENTRY, message, place))
    if document.comments:
        lines = ", ".join(str(line) for line in document.comments)
        message = f"comments inside SimulatorOutputs are not kept (line {lines})"
        place = Place(document.name, document.comments[0], 1)
        problems.append(warning("M028", message, place))
    return problems


def _unmet(document: ConfigText, ids: Sequence[str]) -> Iterable[Problem]:
    known = set(ids)
    near = NearNames(ids)
    for name, line in (document.required or {}).items():
        if name not in known:
            message = f"an input requires {name!r}, which is not a simulator output"
            place = Place(document.name, line, 1)
            yield warning("M025", message, place, near.hint(name))


def _lines(entry: TopicEntry, old: OldEntry | None) -> list[str]:
    values = (quoted(entry.id), quoted(entry.type), quoted(entry.topic))
    first, *rest = [f"{key}: {value}" for key, value in zip(_KEYS, values, strict=True)]
    more = [line for text in (old.more if old else ()) for line in text.split("\n")]
    return [f"  - {first}", *(f"    {line}" for line in (*rest, *more))]


def _item(text: str, column: int) -> list[str]:
    first, *rest = text.split("\n")
    return [f"  - {first}", *(f"    {_dedented(line, column)}" for line in rest)]


def _dedented(line: str, column: int) -> str:
    return line[column:] if not line[:column].strip() else line.lstrip()


def _old_entries(text: str, value: Span) -> Iterable[OldEntry]:
    for item in value.children if not value.is_map else []:
        if not item.is_map:
            continue
        values = {key.text: inner for key, inner in item.entries()}
        name, topic = values.get("id"), values.get("topic")
        if name is None or topic is None or not name.text or not topic.text:
            continue
        column = item.start - (text.rfind("\n", 0, item.start) + 1)
        more = tuple(
            _slice(text, key.start, max(key.end + 1, inner.end), column)
            for key, inner in item.entries()
            if key.text not in _KEYS
        )
        whole = text[item.start : item.end].replace("\r", "")
        yield OldEntry(name.text, topic.text, whole, column, item.line, more)


def _slice(text: str, start: int, end: int, column: int) -> str:
    first, *rest = text[start:end].replace("\r", "").split("\n")
    return "\n".join([first, *(_dedented(line, column) for line in rest)])


def _insertion(text: str, root: Span) -> int:
    """Return where a new block goes: behind Model, else before EDDIInputs, else to the end."""
    by_name = {key.text: (key, value) for key, value in root.entries()}
    if "Model" in by_name:
        key, value = by_name["Model"]
        return _line_end(text, max(key.end, value.end))
    if "EDDIInputs" in by_name:
        return by_name["EDDIInputs"][0].start
    return len(text)


def _line_end(text: str, offset: int) -> int:
    end = text.find("\n", offset)
    return len(text) if end < 0 else end + 1


def _required(root: Span) -> dict[str, int]:
    inputs = root.get("EDDIInputs")
    found: dict[str, int] = {}
    for item in inputs.children if inputs is not None and not inputs.is_map else []:
        required = item.get("requires") if item.is_map else None
        for one in [required, *required.children] if required is not None else []:
            if one.text:
                found.setdefault(one.text, one.line)
    return found


def _refuse_anchors(name: str, root: Span, value: Span) -> None:
    elsewhere: dict[str, int] = {}
    for _, other in root.entries():
        if other is not value:
            elsewhere |= other.aliases
    for anchor, line in value.anchors.items():
        if anchor in elsewhere:
            message = (
                f"the anchor &{anchor} of line {line} is inside SimulatorOutputs and is used "
                f"in line {elsewhere[anchor]}"
            )
            place = Place(name, line, 1)
            hint = "replace the alias by its value"
            raise EddiError(error("K036", message, place, hint))


def new_document(name: str) -> ConfigText:
    """Return a configuration that is not there yet."""
    return ConfigText(name, "", 0, 0)
