"""Parts of a YAML text that are replaced, and the places of the characters in its scalars."""

from __future__ import annotations

import re
from bisect import bisect_right
from collections.abc import Callable, Sequence
from dataclasses import replace

from eddi_scaffold.common.problems import Place
from eddi_scaffold.yaml_text.nodes import LINE_END, Node, scalars_of

_COMMENT = re.compile(r"(?:^|(?<=\s))#(?=([^\n]*))")


def comments(text: str, node: Node, start: int, end: int) -> dict[int, str]:
    """Return the comments between two offsets by their lines (counted from 1)."""
    scalars = [*scalars_of(node)]
    comments: dict[int, str] = {}
    for match in _COMMENT.finditer(text, start, end):
        if not any(scalar.start <= match.start() < scalar.end for scalar in scalars):
            comments.setdefault(text.count("\n", 0, match.start()) + 1, f"#{match[1]}".rstrip())
    return comments


class TextEditor:
    """Changes of a text, each of them lines in place of what is between two offsets."""

    def __init__(self, text: str) -> None:
        self.text = text
        self.newline = "\r\n" if "\r\n" in text else "\n"
        self._edits: list[tuple[int, int, int, str]] = []

    def line_start(self, offset: int) -> int:
        """Return where the line of an offset begins."""
        return self.text.rfind("\n", 0, offset) + 1

    def line_end(self, offset: int) -> int:
        """Return the offset behind the line of an offset."""
        return self.text.find("\n", offset) + 1 or len(self.text)

    def column(self, offset: int) -> int:
        """Return how many characters of its line are in front of an offset."""
        return offset - self.line_start(offset)

    def replace(self, start: int, end: int, lines: Sequence[str], column: int = 0) -> None:
        """Replace what is between two offsets by lines."""
        new = "".join(f"{' ' * column}{line}{self.newline}" for line in lines)
        if self.text[start:end] != new:
            self._edits.append((start, len(self._edits), end, new))

    def result(self) -> str:
        """Return the text with all changes; those at one offset in the order they came."""
        text, done = "", 0
        for start, _, end, new in sorted(self._edits):
            text += self.text[done:start]
            text += self.newline + new if new and text and not text.endswith("\n") else new
            done = max(done, end)
        return text + self.text[done:]


_HEAD_OF_BLOCK = re.compile(f"[|>][^\n\r\x85\u2028\u2029]*(?:{LINE_END.pattern}|$)")


def inside_scalar(text: str, start: Place, value: str) -> Callable[[int], Place]:
    """Return offset in a scalar's value -> place in the file, exact for all that is not blank.

    In every style a value has the same characters as its text, except for blanks and line ends;
    with escapes in it, every place is that of its start.
    """
    line_starts = [0, *(match.end() for match in LINE_END.finditer(text))]
    if start.line is None or start.col is None or start.line > len(line_starts) or not text:
        return lambda _: start
    begin = line_starts[start.line - 1] + start.col - 1
    head = _HEAD_OF_BLOCK.match(text, begin)
    begin = begin + text.startswith(("'", '"'), begin) if head is None else head.end()
    written = (k for k in range(begin, len(text)) if not text[k].isspace())
    offsets: list[int] = []
    for char in value:
        offsets.append(begin if char.isspace() else next(written, len(text)))
        if not char.isspace():
            if not text.startswith(char, offsets[-1]):
                return lambda _: start
            begin = offsets[-1] + 1
    offsets.append(begin)

    def of(offset: int) -> Place:
        place = offsets[min(offset, len(value))]
        line = bisect_right(line_starts, place)
        return replace(start, line=line, col=place - line_starts[line - 1] + 1)

    return of
