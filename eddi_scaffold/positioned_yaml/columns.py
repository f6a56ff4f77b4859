"""Places inside a YAML scalar: the position in the file of each character of its value."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from itertools import takewhile

from eddi_scaffold.problems import Place

_LONG_ESCAPES = {"x": 4, "u": 6, "U": 10}
_LINE_END = re.compile("\r\n|[\n\r\x85\u2028\u2029]")
_BLOCK = re.compile(r"(?P<style>[|>])[-+]?(?P<indent>[1-9])?")

_Spot = tuple[int, int]
"""Line and column, both from 0."""


def inside_scalar(text: str, start: Place) -> Callable[[int], Place]:
    """Return offset in a scalar's value -> place in the file.

    Args:
        text: of the file.
        start: where the scalar begins; quotes, escapes, folded and literal blocks are followed
            (YAML 1.2, chapters 7 and 8).
    """
    if start.line is None or start.col is None or not text:
        return lambda _: start
    lines = yaml_lines(text)
    if start.line > len(lines):
        return lambda _: start
    found = list(_characters(lines, start.line - 1, start.col - 1))

    def of(offset: int) -> Place:
        line, col = found[min(offset, len(found) - 1)] if found else (0, 0)
        return replace(start, line=line + 1, col=col + 1)

    return of


def yaml_lines(text: str) -> list[str]:
    """Return the lines of a text as libyaml counts them, without their ends."""
    return _LINE_END.split(text)


def _characters(lines: Sequence[str], line: int, col: int) -> Iterator[_Spot]:
    """Yield the place of each character of the value, then that behind it."""
    block = _BLOCK.match(lines[line], col)
    if block is not None:
        parent = _indent_of_parent(lines[line], col)
        return _block(lines, line + 1, parent, block["indent"], folded=block["style"] == ">")
    first = lines[line][col : col + 1]
    return _flow(lines, line, col, first if first in ("'", '"') else "")


def _flow(lines: Sequence[str], line: int, col: int, quote: str) -> Iterator[_Spot]:
    """Yield the characters of a plain or quoted scalar."""
    col += len(quote)
    while line < len(lines):
        text = lines[line]
        blanks = len(text[col:]) - len(text[col:].lstrip(" \t"))
        if col + blanks == len(text):  # blanks at the end of a line are not part of the value
            empty = _blank_lines(lines, line + 1)
            yield line, col  # a blank, or the first of several line ends
            yield from ((line + 1 + one, 0) for one in range(empty - 1))
            line += 1 + empty
            col = _indent(lines[line]) if line < len(lines) else 0
            continue
        yield from ((line, one) for one in range(col, col + blanks))
        col += blanks
        if quote == '"' and text[col:] == "\\":  # an escaped line end is not part of it either
            empty = _blank_lines(lines, line + 1)
            yield from ((line + 1 + one, 0) for one in range(empty))
            line += 1 + empty
            col = _indent(lines[line]) if line < len(lines) else 0
            continue
        yield line, col
        if quote == '"' and text[col] == "\\":
            col += _LONG_ESCAPES.get(text[col + 1], 2)
        elif quote == "'" and text[col : col + 2] == "''":
            col += 2
        elif text[col] == quote:
            return
        else:
            col += 1


def _block(
    lines: Sequence[str], line: int, parent: int, indicator: str | None, *, folded: bool
) -> Iterator[_Spot]:
    """Yield the characters of a literal or folded block scalar, with every line end at its end."""
    if indicator is not None:
        indent = parent + int(indicator)
    else:
        leading = list(takewhile(lambda one: not one.strip(" "), lines[line:]))
        first = lines[line + len(leading) : line + len(leading) + 1]
        indent = max([parent + 1, *map(len, leading), *map(_spaces, first)])
    while line < len(lines) and _is_empty(lines[line], indent):
        yield line, len(lines[line])
        line += 1
    while line < len(lines) and _spaces(lines[line]) >= indent:
        text = lines[line]
        yield from ((line, one) for one in range(indent, len(text)))
        empty = sum(1 for _ in takewhile(lambda one: _is_empty(one, indent), lines[line + 1 :]))
        behind = lines[line + 1 + empty] if line + 1 + empty < len(lines) else ""
        goes_on = _spaces(behind) >= indent and len(behind) > indent
        folds = folded and goes_on and text[indent] not in " \t" and behind[indent] not in " \t"
        if not (folds and empty):
            yield line, len(text)
        yield from ((line + 1 + one, len(lines[line + 1 + one])) for one in range(empty))
        line += 1 + empty


def _indent_of_parent(text: str, col: int) -> int:
    """Return the column of the node that holds a block scalar, which begins at a column."""
    at = _indent(text)
    while text[at : at + 1] == "-" and at + 1 + _indent(text[at + 1 :]) < col:
        at += 1 + _indent(text[at + 1 :])
    return at if at < col else -1


def _blank_lines(lines: Sequence[str], line: int) -> int:
    return sum(1 for _ in takewhile(lambda one: not one.strip(" \t"), lines[line:]))


def _is_empty(text: str, indent: int) -> bool:
    return len(text) <= indent and not text.strip(" ")


def _indent(text: str) -> int:
    return len(text) - len(text.lstrip(" \t"))


def _spaces(text: str) -> int:
    return len(text) - len(text.lstrip(" "))
