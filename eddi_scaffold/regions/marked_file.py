"""A file split at its markers, and what is wrong with them."""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from functools import cached_property, lru_cache

from .markers import Digests, Look, Marker, encode_id, indent_of, read_marker, text_digest

_DEFINITION = re.compile(r"[ \t]*(?:async\s+)?(def|class)\s+(\w+)")
_SIDE = re.compile(r"^(?:<{7}|>{7})(?=\s|$)", re.MULTILINE)
_HUNK = re.compile(
    r"^<{7}(?: [^\n]*)?\n(.*?)(?:^\|{7}(?: [^\n]*)?\n.*?)?^={7}\r?\n"
    r"(.*?)^>{7}(?: [^\n]*)?(?:\n|\Z)",
    re.MULTILINE | re.DOTALL,
)


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
        id: decoded; of a region without id (D7.2) the name of the enclosing function.
        digests: what the body stood for when it was written.
        was: ids under which the element was known before, the newest first.
        now: why a person must look at the body.
        line: line of the begin marker, counted from 1.
        begin: the begin marker's line, without line end.
        body: the text between the markers, byte for byte.
        end: the end marker's line, without line end.
    """

    id: str
    digests: Digests
    was: tuple[str, ...]
    now: Look | None
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
    def outside(self) -> list[str]:
        """The lines with one line for each region: what no person writes."""
        return [p if isinstance(p, str) else f"region {encode_id(p.id)}\n" for p in self.parts]

    @cached_property
    def digest(self) -> str:
        """Of all that stands outside of regions."""
        return text_digest("".join(self.outside))


def split_lines(text: str) -> list[str]:
    r"""Split at ``\n`` only: form feeds and Unicode separators belong to the text."""
    lines = text.split("\n")
    ends = [line + "\n" for line in lines[:-1]]
    return [*ends, lines[-1]] if lines[-1] else ends


def sides_of(text: str) -> tuple[str, ...]:
    """Return the text, or one for each side of the conflicts that git left in it."""
    if not _SIDE.search(text):
        return (text,)
    ours, theirs = _HUNK.sub(r"\1", text), _HUNK.sub(r"\2", text)
    return (text,) if _SIDE.search(ours) else (ours, theirs)


@lru_cache(maxsize=32)
def parse(text: str) -> tuple[MarkedFile, tuple[Fault, ...]]:
    """Split a file's text at its markers.

    Returns:
        The document, and the faults; with any fault the document must not be used.
    """
    lines = split_lines(text)
    faults: list[Fault] = []
    parts: list[str | Region] = []
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
                inside = f"begin marker inside the region that begins in line {begin.line}"
                faults.append(Fault(number, f"{inside}; remove this line"))
                continue
            if begin:
                faults.append(_missing_end(begin, number, lines))
            begin, body = marker, []
        elif begin is None:
            reason = "end marker without begin; put the begin marker back above it"
            faults.append(Fault(number, reason))
        else:
            parts.append(_region(begin, marker, "".join(body), lines, faults))
            begin = None
    if begin:
        faults.append(_missing_end(begin, len(lines) + 1, lines))
    faults.extend(_duplicates(parts))
    return MarkedFile(tuple(parts)), tuple(sorted(faults, key=lambda f: f.line))


def _is_stray(outer: Marker, inner: Marker, lines: Sequence[str]) -> bool:
    """Return whether a begin marker is one too many, by the end marker that follows."""
    if outer.id is None or outer.id == inner.id:
        return outer.id is not None
    following = (read_marker(lines[at], at + 1) for at in range(inner.line, len(lines)))
    after = next((one for one in following if isinstance(one, Marker)), None)
    return after is not None and (after.what, after.id) == ("end", outer.id)


def _missing_end(outer: Marker, limit: int, lines: Sequence[str]) -> Fault:
    """Report a region without its end marker, where that belongs."""
    indent = len(indent_of(outer.text))
    body = range(outer.line, limit - 1)
    outside = (at for at in body if lines[at].strip() and len(indent_of(lines[at])) < indent)
    at = next(outside, limit - 1)
    while at > outer.line and not lines[at - 1].strip():
        at -= 1
    name = f"region {outer.id!r}" if outer.id else "the region"
    reason = (
        f"the end marker of {name}, which begins in line {outer.line}, is missing; "
        f"put it back before line {at + 1}"
    )
    return Fault(at + 1, reason)


def _region(
    begin: Marker, end: Marker, body: str, lines: Sequence[str], faults: list[Fault]
) -> Region:
    if begin.id and end.id and begin.id != end.id:
        reason = (
            f"this end marker has the id {end.id!r} but the begin marker in line {begin.line} has "
            f"{begin.id!r}; give both the same id"
        )
        faults.append(Fault(end.line, reason))
    region_id = begin.id or end.id or _enclosing_function(lines, begin)
    if not region_id:
        reason = "a marker without id must be inside a function; write '# region: ID' behind it"
        faults.append(Fault(begin.line, reason))
    return Region(
        region_id, begin.digests, begin.was, begin.now, begin.line, begin.text, body, end.text
    )


def _enclosing_function(lines: Sequence[str], begin: Marker) -> str:
    # An editor may have stripped the marker's blanks: then any definition above encloses it.
    limit = len(indent_of(begin.text)) or 10**6
    for line in reversed(lines[: begin.line - 1]):
        match = _DEFINITION.match(line)
        if match and len(indent_of(line)) < limit:
            return match[2] if match[1] == "def" else ""
    return ""


def _duplicates(parts: Iterable[str | Region]) -> list[Fault]:
    seen: dict[str, int] = {}
    faults = []
    for part in parts:
        if isinstance(part, Region) and part.id:
            if part.id in seen:
                reason = (
                    f"second region {part.id!r}, the first is in line {seen[part.id]}; "
                    "keep one or give it another id"
                )
                faults.append(Fault(part.line, reason))
            seen.setdefault(part.id, part.line)
    return faults
