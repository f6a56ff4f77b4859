"""A file split at its markers, and what is wrong with them."""

from __future__ import annotations

import re
from collections.abc import Sequence
from functools import lru_cache
from typing import NamedTuple

from .markers import Digests, Look, Marker, digest, encode_id, indent_of, read_marker

_DEFINITION = re.compile(r"[ \t]*(?:async\s+)?(def|class)\s+(\w+)")
_SIDE = re.compile(r"^(?:<{7}|>{7})(?=\s|$)", re.MULTILINE)
_HUNK = re.compile(
    r"^<{7}(?: [^\n]*)?\n(.*?)(?:^\|{7}(?: [^\n]*)?\n.*?)?^={7}\r?\n"
    r"(.*?)^>{7}(?: [^\n]*)?(?:\n|\Z)",
    re.MULTILINE | re.DOTALL,
)


class Fault(NamedTuple):
    """Why a file's markers cannot be trusted."""

    line: int  # counted from 1
    reason: str  # what is wrong and what to do about it


class Region(NamedTuple):
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

    @property
    def untouched(self) -> bool:
        """Whether no person wrote the body."""
        return digest(self.body) == self.digests.of


class MarkedFile:
    """A file split at its markers: lines outside of regions, with line end, and regions."""

    def __init__(self, parts: Sequence[str | Region]) -> None:
        self.parts = parts
        self.regions = {part.id: part for part in parts if isinstance(part, Region)}
        self.outside = [  # what no person writes, with one line for each region
            p if isinstance(p, str) else f"region {encode_id(p.id)}\n" for p in parts
        ]


def split_lines(text: str) -> list[str]:
    r"""Split at ``\n`` only: form feeds and Unicode separators belong to the text."""
    return re.findall(r"[^\n]*\n|[^\n]+", text)


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
    ids: set[str] = set()
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
            if begin:
                faults.append(_missing_end(begin))
            begin, body = marker, []
        elif begin is None:
            reason = "end marker without begin; put the begin marker back above it"
            faults.append(Fault(number, reason))
        else:
            id_ = begin.id or marker.id or _enclosing_function(lines, begin)
            if begin.id and marker.id and begin.id != marker.id:
                reason = f"this end marker is of {marker.id!r}, its begin marker of {begin.id!r}"
                faults.append(Fault(number, f"{reason}; give both the same id"))
            if not id_:
                reason = "a marker without id must be inside a function"
                faults.append(Fault(begin.line, f"{reason}; write '# region: ID' behind it"))
            elif id_ in ids:
                reason = f"second region {id_!r}; keep one or give it another id"
                faults.append(Fault(begin.line, reason))
            ids.add(id_)
            known = (begin.digests, begin.was, begin.now, begin.line, begin.text)
            parts.append(Region(id_, *known, "".join(body), marker.text))
            begin = None
    if begin:
        faults.append(_missing_end(begin))
    return MarkedFile(parts), tuple(sorted(faults, key=lambda fault: fault.line))


def _missing_end(begin: Marker) -> Fault:
    name = f"region {begin.id!r}" if begin.id else "the region"
    return Fault(begin.line, f"{name} has no end marker; put it back below the hand code")


def _enclosing_function(lines: Sequence[str], begin: Marker) -> str:
    # An editor may have stripped the marker's blanks: then any definition above encloses it.
    limit = len(indent_of(begin.text)) or 10**6
    for line in reversed(lines[: begin.line - 1]):
        match = _DEFINITION.match(line)
        if match and len(indent_of(line)) < limit:
            return match[2] if match[1] == "def" else ""
    return ""
