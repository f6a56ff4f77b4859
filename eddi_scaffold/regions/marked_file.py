"""A file split at its markers, and what is wrong with them."""

from __future__ import annotations

import re
from bisect import bisect_left
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from functools import cached_property, lru_cache

from .conflicts import CONFLICT, conflict_lines
from .markers import Marker, decode_id, encode_id, indent_of, read_marker

_DEFINITION = re.compile(r"^([ \t]*)(?:async\s+)?(def|class)\s+(\w+)")
_PLACEHOLDER = re.compile(r"^\s*'''eddi region (\S+)'''\s*$")


@dataclass(frozen=True)
class Fault:
    """Why a file's markers cannot be trusted.

    Attributes:
        line: line in the file, counted from 1.
        reason: what is wrong and what to do about it.
    """

    line: int
    reason: str


@dataclass(frozen=True)
class Region:
    """One editable region of a file.

    Attributes:
        id: ``<kind>:<id>``, decoded; of a region without id ``function:<Class.method>``.
        explicit: whether a marker names the id.
        function: qualified name of the enclosing function, empty outside of functions.
        was: ids under which the element was known before, the newest first.
        sig: hash of what the body may use when it was written, ``None`` when not given.
        line: line of the begin marker, counted from 1.
        begin: the begin marker's line, without line end.
        body: the text between the markers, byte for byte.
        end: the end marker's line, without line end.
    """

    id: str
    explicit: bool
    function: str
    was: tuple[str, ...]
    sig: str | None
    line: int
    begin: str
    body: str
    end: str

    @property
    def indent(self) -> str:
        """Blanks before the begin marker."""
        return indent_of(self.begin)


@dataclass(frozen=True)
class MarkedFile:
    """A file split at its markers.

    Attributes:
        parts: lines outside of regions (with line end) and regions, in file order.
    """

    parts: tuple[str | Region, ...]

    @cached_property
    def regions(self) -> dict[str, Region]:
        """The regions by id, in file order."""
        return {part.id: part for part in self.parts if isinstance(part, Region)}

    @cached_property
    def skeleton(self) -> list[str]:
        """The lines with one placeholder line for each region: what is compared and merged."""
        return [p if isinstance(p, str) else placeholder(p.id, p.indent) for p in self.parts]


@dataclass(frozen=True)
class Scope:
    """A line that begins a class or function, with the definition around it."""

    line: int
    indent: int
    kind: str
    name: str
    parent: Scope | None

    @property
    def qualified(self) -> str:
        """The name with those of the definitions around it."""
        return f"{self.parent.qualified}.{self.name}" if self.parent else self.name


def placeholder(region_id: str, indent: str = "") -> str:
    """Return the skeleton line that represents a region; a statement, so that Python parses."""
    return f"{indent}'''eddi region {encode_id(region_id)}'''\n"


def placeholder_id(line: str) -> str | None:
    """Return the region that a skeleton line represents, ``None`` for every other line."""
    match = _PLACEHOLDER.match(line)
    return decode_id(match[1]) if match else None


def split_lines(text: str) -> list[str]:
    r"""Split at ``\n`` only: form feeds and Unicode separators belong to the text."""
    lines = text.split("\n")
    ends = [line + "\n" for line in lines[:-1]]
    return [*ends, lines[-1]] if lines[-1] else ends


def parse(text: str) -> tuple[MarkedFile, list[Fault]]:
    """Split a file's text at its markers.

    Returns:
        The document, and the faults; with any fault the document must not be used.
    """
    document, faults = _parsed(text)
    return document, list(faults)


@lru_cache(maxsize=32)  # a sync looks at a rendering and a person's text several times
def _parsed(text: str) -> tuple[MarkedFile, tuple[Fault, ...]]:
    lines = split_lines(text)
    faults = [Fault(number, CONFLICT) for number in conflict_lines(text)]
    parts: list[str | Region] = []
    around = scopes(lines)
    begin: Marker | None = None
    body: list[str] = []
    for number, line in enumerate(lines, 1):
        marker = read_marker(line, number)
        if isinstance(marker, str):
            faults.append(Fault(number, marker))
        if marker is None or isinstance(marker, str):
            # Outside, line ends are the generator's; inside, every byte is the person's.
            body.append(line) if begin else parts.append(line.replace("\r\n", "\n"))
        elif marker.what == "begin":
            if begin and _is_stray(begin, marker, lines):
                faults.append(Fault(number, f"{_inside(begin)}; remove this line"))
                continue
            if begin:
                faults.append(_nested(begin, marker, lines))
            begin, body = marker, []
        elif begin is None:
            faults.append(
                Fault(number, "end marker without begin; put the begin marker back above it")
            )
        else:
            parts.append(_region(begin, marker, "".join(body), around, faults))
            begin = None
    if begin:
        faults.append(
            Fault(begin.line, "the region has no end marker; put it back below the hand code")
        )
    faults.extend(_duplicates(parts))
    return MarkedFile(tuple(parts)), tuple(sorted(faults, key=lambda f: f.line))


def _is_stray(outer: Marker, inner: Marker, lines: Sequence[str]) -> bool:
    """Return whether a begin marker is one too many, by the end marker that follows."""
    if outer.id is None or outer.id == inner.id:
        return outer.id is not None
    following = (read_marker(lines[at], at + 1) for at in range(inner.line, len(lines)))
    marker = next((one for one in following if one is not None), None)
    return isinstance(marker, Marker) and (marker.what, marker.id) == ("end", outer.id)


def _inside(outer: Marker) -> str:
    return f"begin marker inside the region that begins in line {outer.line}"


def _nested(outer: Marker, inner: Marker, lines: Sequence[str]) -> Fault:
    """Report a region without its end marker, where that belongs."""
    body, indent = range(outer.line, inner.line - 1), len(indent_of(outer.text))
    outside = (at for at in body if lines[at].strip() and len(indent_of(lines[at])) < indent)
    at = next(outside, inner.line - 1)
    while at > outer.line and not lines[at - 1].strip():
        at -= 1
    begins = f"begins in line {outer.line}"
    name = f"region {outer.id!r}, which {begins}," if outer.id else f"the region that {begins}"
    reason = f"the end marker of {name} is missing; put it back before line {at + 1}"
    return Fault(at + 1, reason)


def _region(
    begin: Marker, end: Marker, body: str, around: Sequence[Scope], faults: list[Fault]
) -> Region:
    if begin.id and end.id and begin.id != end.id:
        reason = (
            f"this end marker has the id {end.id!r} but the begin marker in line {begin.line} has "
            f"{begin.id!r}; give both the same id"
        )
        faults.append(Fault(end.line, reason))
    function = _enclosing_function(around, begin)
    region_id = begin.id or end.id
    if region_id is None and not function:
        reason = "a marker without id must be inside a function; write '# region: <kind>:<id>'"
        faults.append(Fault(begin.line, reason))
    return Region(
        id=region_id or f"function:{function}",
        explicit=region_id is not None,
        function=function,
        was=begin.was,
        sig=begin.sig,
        line=begin.line,
        begin=begin.text,
        body=body,
        end=end.text,
    )


def scopes(lines: Sequence[str]) -> list[Scope]:
    """Return where definitions begin, with the nearest one above that is indented less."""
    found: list[Scope] = []
    for number, line in enumerate(lines, 1):
        match = _DEFINITION.match(line)
        if match:
            indent, above = len(match[1]), found[-1] if found else None
            while above is not None and above.indent >= indent:
                above = above.parent
            found.append(Scope(number, indent, match[2], match[3], above))
    return found


def _enclosing_function(around: Sequence[Scope], begin: Marker) -> str:
    # An editor may have stripped the marker's blanks: then any definition above encloses it.
    limit = len(indent_of(begin.text)) or 10**6
    names: list[str] = []
    before = bisect_left(around, begin.line, key=lambda scope: scope.line)
    scope = around[before - 1] if before else None
    while scope is not None:
        if scope.indent < limit:
            if not names and scope.kind == "class":
                return ""
            names.append(scope.name)
            limit = scope.indent
            if limit == 0:
                break
        scope = scope.parent
    return ".".join(reversed(names))


def _duplicates(parts: Iterable[str | Region]) -> list[Fault]:
    seen: dict[str, int] = {}
    faults = []
    for part in parts:
        if isinstance(part, Region):
            if part.id in seen:
                what = "region" if part.explicit else "region without id in this function"
                reason = (
                    f"second {what} {part.id!r}, the first is in line {seen[part.id]}; "
                    "keep one or give it another id"
                )
                faults.append(Fault(part.line, reason))
            seen.setdefault(part.id, part.line)
    return faults
