"""A file split at its markers, and what is wrong with them."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property, lru_cache

from .markers import Digests, Look, Marker, digest, encode_id, indent_of, read_marker, text_digest

_DEFINITION = re.compile(r"[ \t]*(?:async\s+)?(def|class)\s+(\w+)")
_SIDE = re.compile(r"^(?:<{7}|>{7})(?=\s|$)", re.MULTILINE)
_HUNK = re.compile(
    r"^<{7}(?: [^\n]*)?\n(.*?)(?:^\|{7}(?: [^\n]*)?\n.*?)?^={7}\r?\n"
    r"(.*?)^>{7}(?: [^\n]*)?(?:\n|\Z)",
    re.MULTILINE | re.DOTALL,
)


@dataclass(frozen=True)
class Fault:
    """Why a file's markers cannot be trusted."""

    line: int  # counted from 1
    reason: str  # what is wrong and what to do about it


@dataclass(frozen=True)
class Region:
    """One editable region of a file."""

    id: str  # decoded; of a region without id (D7.2) the name of the enclosing function
    digests: Digests  # what the body stood for when it was written
    was: tuple[str, ...]  # ids under which the element was known before, the newest first
    now: Look | None  # why a person must look at the body
    line: int  # of the begin marker, counted from 1
    begin: str  # the begin marker's line, without line end
    body: str  # the text between the markers, byte for byte
    end: str  # the end marker's line, without line end

    @property
    def indent(self) -> str:
        """Blanks before the begin marker."""
        return indent_of(self.begin)

    @cached_property
    def untouched(self) -> bool:
        """Whether no person wrote the body."""
        return digest(self.body) == self.digests.of


@dataclass(frozen=True)
class MarkedFile:
    """A file split at its markers."""

    parts: tuple[str | Region, ...]  # lines outside of regions, with line end, and regions

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
    """Split a file's text at its markers; with any fault the document must not be used."""
    lines = split_lines(text)
    faults: list[Fault] = []
    parts: list[str | Region] = []
    lines_of: dict[str, int] = {}
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
            region = _region(begin, marker, "".join(body), lines)
            faults += _faults_of(begin, marker, region, lines_of.setdefault(region.id, begin.line))
            parts.append(region)
            begin = None
    if begin:
        faults.append(_missing_end(begin, len(lines) + 1, lines))
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
    begins = f"which begins in line {outer.line}, is missing"
    return Fault(at + 1, f"the end marker of {name}, {begins}; put it back before line {at + 1}")


def _region(begin: Marker, end: Marker, body: str, lines: Sequence[str]) -> Region:
    id_ = begin.id or end.id or _enclosing_function(lines, begin)
    digests, now = begin.digests, begin.now
    return Region(id_, digests, begin.was, now, begin.line, begin.text, body, end.text)


def _enclosing_function(lines: Sequence[str], begin: Marker) -> str:
    # An editor may have stripped the marker's blanks: then any definition above encloses it.
    limit = len(indent_of(begin.text)) or 10**6
    for line in reversed(lines[: begin.line - 1]):
        match = _DEFINITION.match(line)
        if match and len(indent_of(line)) < limit:
            return match[2] if match[1] == "def" else ""
    return ""


def _faults_of(begin: Marker, end: Marker, region: Region, first: int) -> Iterator[Fault]:
    """Yield what is wrong with the ids of a region, of which the first one is in some line."""
    if begin.id and end.id and begin.id != end.id:
        there = f"the begin marker in line {begin.line} has {begin.id!r}; give both the same id"
        yield Fault(end.line, f"this end marker has the id {end.id!r} but {there}")
    if not region.id:
        reason = "a marker without id must be inside a function; write '# region: ID' behind it"
        yield Fault(begin.line, reason)
    elif first != begin.line:
        keep = "keep one or give it another id"
        yield Fault(
            begin.line, f"second region {region.id!r}, the first is in line {first}; {keep}"
        )
