"""A three-way merge by lines that refuses, or marks, what it cannot decide.

Our own instead of ``git merge-file``: the same result on every machine, no process, and
touching changes are not united, because in generated files neighbours look alike.
"""

from __future__ import annotations

import difflib
from collections.abc import Sequence
from typing import NamedTuple


class _Hunk(NamedTuple):
    start: int
    stop: int
    lines: tuple[str, ...]


def merge_lines(
    base: Sequence[str], mine: Sequence[str], theirs: Sequence[str]
) -> list[str] | None:
    """Return the text with both changes, ``None`` when they touch each other."""
    hunks = sorted({*_hunks(base, mine), *_hunks(base, theirs)})  # the same change counts once
    merged: list[str] = []
    at = 0
    previous: _Hunk | None = None
    for hunk in hunks:
        if previous is not None and hunk.start <= previous.stop:
            # Two hunks of one side never touch, so these come from different sides.
            return None
        merged.extend(base[at : hunk.start])
        merged.extend(hunk.lines)
        at, previous = hunk.stop, hunk
    merged.extend(base[at:])
    return merged


def mark_lines(
    base: Sequence[str], ours: Sequence[str], theirs: Sequence[str]
) -> tuple[list[str], bool]:
    """Return the text with both changes, marked as git does where they touch; whether they do."""
    sides = (_hunks(base, ours), _hunks(base, theirs))
    merged: list[str] = []
    at, conflict = 0, False
    for start, stop in _touching(sorted(hunk for side in sides for hunk in side)):
        merged += base[at:start]
        own, new = (_applied(base, side, start, stop) for side in sides)
        before = list(base[start:stop])
        if new in (own, before):
            merged += own
        elif own == before:
            merged += new
        else:
            merged += [
                "<<<<<<< ours\n",
                *_ended(own),
                "=======\n",
                *_ended(new),
                ">>>>>>> theirs\n",
            ]
            conflict = True
        at = stop
    return [*merged, *base[at:]], conflict


def _touching(hunks: Sequence[_Hunk]) -> list[tuple[int, int]]:
    """Return the ranges of the base in which changes touch each other."""
    ranges: list[tuple[int, int]] = []
    for hunk in hunks:
        if ranges and hunk.start <= ranges[-1][1]:
            start, stop = ranges.pop()
            ranges.append((start, max(stop, hunk.stop)))
        else:
            ranges.append((hunk.start, hunk.stop))
    return ranges


def _applied(base: Sequence[str], hunks: Sequence[_Hunk], start: int, stop: int) -> list[str]:
    """Return a range of the base with one side's changes."""
    out: list[str] = []
    at = start
    for hunk in hunks:
        if start <= hunk.start and hunk.stop <= stop:
            out += [*base[at : hunk.start], *hunk.lines]
            at = hunk.stop
    return [*out, *base[at:stop]]


def _ended(lines: Sequence[str]) -> list[str]:
    return [line if line.endswith("\n") else line + "\n" for line in lines]


def _hunks(base: Sequence[str], other: Sequence[str]) -> list[_Hunk]:
    matcher = difflib.SequenceMatcher(
        None, [line.rstrip() for line in base], [line.rstrip() for line in other], autojunk=False
    )
    return [
        _Hunk(i1, i2, tuple(other[j1:j2]))
        for tag, i1, i2, j1, j2 in matcher.get_opcodes()
        if tag != "equal"
    ]
