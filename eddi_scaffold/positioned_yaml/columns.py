"""Places inside of a YAML scalar: where a character of its value stands in the file."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import replace

from eddi_scaffold.problems import Place

_LONG_ESCAPES = {"x": 4, "u": 6, "U": 10}


def inside_scalar(text: str, start: Place) -> Callable[[int], Place]:
    """Return offset in a scalar's value -> place in the file.

    Args:
        text: of the file.
        start: where the scalar begins; quotes, escapes, folded and literal blocks are followed.
    """
    if start.line is None or start.col is None or not text:
        return lambda _: start
    lines = text.split("\n")
    if start.line > len(lines):
        return lambda _: start
    found = list(_characters(lines, start.line - 1, start.col - 1))

    def of(offset: int) -> Place:
        line, col = found[min(offset, len(found) - 1)] if found else (0, 0)
        return replace(start, line=line + 1, col=col + 1)

    return of


def _characters(lines: list[str], line: int, col: int) -> Iterator[tuple[int, int]]:
    """Yield the place of each character of the value, then that behind it."""
    first = lines[line][col : col + 1]
    if first in ("|", ">"):
        yield from _block(lines, line + 1)
        return
    quote = first if first in ("'", '"') else ""
    col += len(quote)
    while line < len(lines):
        text = lines[line].rstrip("\r")
        while col < len(text):
            char = text[col]
            yield line, col
            if char == quote:
                if quote == "'" and text[col + 1 : col + 2] == "'":
                    col += 2
                    continue
                return
            if quote == '"' and char == "\\":
                col += _LONG_ESCAPES.get(text[col + 1 : col + 2], 2)
                continue
            col += 1
        yield line, len(text)  # a line end is one blank of the value
        line += 1
        rest = lines[line] if line < len(lines) else ""
        col = len(rest) - len(rest.lstrip())


def _block(lines: list[str], line: int) -> Iterator[tuple[int, int]]:
    indent = next((len(t) - len(t.lstrip()) for t in lines[line:] if t.strip()), 0)
    for number in range(line, len(lines)):
        text = lines[number].rstrip("\r")
        if text.strip() and len(text) - len(text.lstrip()) < indent:
            return
        yield from ((number, col) for col in range(indent, len(text) + 1))
