"""Conflict markers that git or Copier left in a text."""

from __future__ import annotations

import re

CONFLICT = "unresolved merge conflict; resolve it first"
_SIDE = re.compile(r"^(?:<{7}|\|{7}|>{7})(?=\s|$)", re.MULTILINE)
_HUNK = re.compile(
    r"^<{7}(?: [^\n]*)?\n(.*?)(?:^\|{7}(?: [^\n]*)?\n.*?)?^={7}\r?\n"
    r"(.*?)^>{7}(?: [^\n]*)?(?:\n|\Z)",
    re.MULTILINE | re.DOTALL,
)
_MIDDLE = re.compile(r"^={7}(?=\r?$)", re.MULTILINE)


def conflict_lines(text: str) -> tuple[int, ...]:
    """Return the lines with the marker of a side, counted from 1."""
    return _lines(_SIDE, text)


def separator_lines(text: str) -> tuple[int, ...]:
    """Return the lines that are ``=======``: in text without a syntax, a heading's underline."""
    return _lines(_MIDDLE, text)


def other_side(data: bytes) -> bytes:
    """Return a text with the second side of each conflict; Copier's second side is its newest."""
    return _second_side(data.decode("latin-1")).encode("latin-1")  # lines are the same in any


def both_sides(text: str) -> tuple[str, str]:
    """Return the texts with the first and with the second side of each conflict."""
    return first_side(text), _second_side(text)


def first_side(text: str) -> str:
    """Return a text with the first side of each conflict; git's is that of this branch."""
    return _HUNK.sub(r"\1", text)


def _second_side(text: str) -> str:
    return _HUNK.sub(r"\2", text)


def _lines(pattern: re.Pattern[str], text: str) -> tuple[int, ...]:
    return tuple(text.count("\n", 0, found.start()) + 1 for found in pattern.finditer(text))
