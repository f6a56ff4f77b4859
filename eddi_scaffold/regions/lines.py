"""A three-way merge by lines that refuses what it cannot decide.

Our own instead of ``git merge-file``: the same result on every machine, no process, no conflict
markers, and touching changes are refused, because in generated files neighbours look alike.
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


def _hunks(base: Sequence[str], other: Sequence[str]) -> list[_Hunk]:
    matcher = difflib.SequenceMatcher(
        None, [line.rstrip() for line in base], [line.rstrip() for line in other], autojunk=False
    )
    return [
        _Hunk(i1, i2, tuple(other[j1:j2]))
        for tag, i1, i2, j1, j2 in matcher.get_opcodes()
        if tag != "equal"
    ]
