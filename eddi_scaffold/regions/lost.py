"""Regions that lost both markers: without them hand-written text would pass as generated."""

from __future__ import annotations

import difflib
from collections.abc import Iterator, Sequence

from .marked_file import Fault, MarkedFile, Region, scopes
from .markers import indent_of


def lost_markers(base: MarkedFile, mine: MarkedFile) -> list[Fault]:
    """Return where text of a region of the last rendering stands without its markers.

    A function, or lines, that a person removed altogether hold no such text.

    Args:
        base: the rendering that ``mine`` was made from.
        mine: the person's file; regions that the generator never knew are ordinary lines.
    """
    gone = [region for region in base.regions.values() if region.id not in mine.regions]
    if not gone:
        return []
    numbers = list(_numbers(mine))
    faults = []
    for region in gone:
        find = _in_function if region.function else _in_place
        at = find(region, base, mine.skeleton)
        if at is not None:
            reason = (
                f"both markers of region {region.id!r} are damaged or gone, and text is in their "
                "place; put the generated lines back around it"
            )
            faults.append(Fault(numbers[at], reason))
    return faults


def _numbers(document: MarkedFile) -> Iterator[int]:
    """Yield for each line of the skeleton the line of the file."""
    number = 1
    for part in document.parts:
        yield number
        number += 1 if isinstance(part, str) else 2 + part.body.count("\n")


def _in_function(region: Region, base: MarkedFile, lines: Sequence[str]) -> int | None:
    """Return the first line of the region's function that is not generated."""
    known = {line.strip() for line in base.skeleton} | {"", "pass"}
    for scope in scopes(lines):
        if scope.qualified == region.function:
            start = scope.line  # counted from 1: the line below the definition
            for at in range(start, len(lines)):
                bare = lines[at].strip()
                if bare and bare[0] not in ")#" and len(indent_of(lines[at])) <= scope.indent:
                    break
                if bare not in known:
                    return at
    return None


def _in_place(region: Region, base: MarkedFile, lines: Sequence[str]) -> int | None:
    """Return the first of the lines that replaced the region."""
    before = [line.strip() for line in base.skeleton]
    after = [line.strip() for line in lines]
    parts = (part.id if isinstance(part, Region) else None for part in base.parts)
    place = list(parts).index(region.id)
    matcher = difflib.SequenceMatcher(None, before, after, autojunk=False)
    for _, start, stop, first, last in matcher.get_opcodes():
        if start <= place < stop:
            return next((at for at in range(first, last) if after[at]), None)
    return None
