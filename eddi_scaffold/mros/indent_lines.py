"""Lines and blocks of the indentation dialect.

A block is deeper indentation of lines that are not blank. A tab counts 8 columns, every other white
character 1. Lines that hold only a comment, and everything between ``[`` and ``]``, take no part in
the indentation; a quoted text may go over several lines.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass, field

from eddi_scaffold.mros.text import STRING, Cursor, Text, Token, never_closed, quoted

_TOKEN = re.compile(
    rf"""(?P<space>[^\S\n]+)
       |(?P<newline>\n)
       |(?P<comment>\#[^\n]*|/\*[\s\S]*?\*/)
       |{STRING}
       |(?P<punct>[:\[\],])
       |(?P<word>(?!/\*)[^\s"'\[\],:\#]+)
       |(?P<bad>["']|/\*)""",
    re.VERBOSE,
)
_TAB = 8
_NO_DASH = re.compile(r"-[\d.]+|---")


@dataclass
class Line:
    """One logical line and the block below it."""

    indent: int  # columns before the first token
    dash: bool  # it begins with `-`, which is not among the tokens
    offset: int  # of the first character that is not white space
    tokens: list[Token]  # its content, with an `end` at the last token
    below: list[Line] = field(default_factory=list)  # the lines of its block


def blocks_of(text: Text) -> list[Line]:
    """Return the lines of the outermost block, each with what is below it, without ``---``.

    Raises:
        MrosSyntaxError: a line has the indentation of no open block. What is never closed becomes a
            token ``bad`` instead: an error above it comes first.
    """
    root: list[Line] = []
    stack: list[tuple[int, list[Line]]] = []  # indentation around a block, and its lines
    for line in _lines(text):
        while stack and line.indent <= stack[-1][0]:
            stack.pop()
        if not stack:
            stack.append((-1, root))
            root.append(line)
            continue
        block = stack[-1][1]
        first = block[0]
        if line.indent > first.indent:
            stack.append((first.indent, block[-1].below))
            block[-1].below.append(line)
        elif line.indent == first.indent or line.dash or first.dash:
            block.append(line)
        else:
            message = (
                f"this line has an indentation of {line.indent}, its block one of "
                f"{first.indent} (line {text.place(first.offset).line}; a tab counts {_TAB})"
            )
            raise text.error(line.offset, message)
    return [
        line for line in root if line.below or [token[1] for token in line.tokens[:-1]] != ["---"]
    ]


def _lines(text: Text) -> Iterator[Line]:
    tokens: list[Token] = []
    indent = opened = depth = 0
    for match in _TOKEN.finditer(text.text):
        kind, value, position = str(match.lastgroup), match[0], match.start()
        if kind == "newline":
            if depth == 0:
                if tokens:
                    yield _line(indent, tokens)
                tokens, indent = [], 0
        elif kind == "space":
            if not tokens:
                indent += sum(_TAB if char == "\t" else 1 for char in value if char != "\r")
        elif kind != "comment":
            if value == "[":
                opened = opened if depth else position
                depth += 1
            elif value == "]" and depth:
                depth -= 1
            if kind == "bad":
                tokens.append(never_closed(value, position))
                break
            tokens.append((kind, value, position))
    if depth and tokens[-1][0] != "bad":
        tokens = [*(token for token in tokens if token[2] < opened), never_closed("[", opened)]
    if tokens:
        yield _line(indent, tokens)


def _line(indent: int, tokens: list[Token]) -> Line:
    kind, value, offset = tokens[0]
    dash = kind == "word" and value.startswith("-") and not _NO_DASH.fullmatch(value)
    if dash:
        tokens[:1] = [(kind, value[1:], offset + 1)] if len(value) > 1 else []
    last = tokens[-1][2] if tokens else offset
    return Line(indent, dash, offset, [*tokens, ("end", "end of line", last)])


class LineCursor(Cursor):
    """A position in the tokens of one line."""

    def __init__(self, text: Text, line: Line) -> None:
        super().__init__(text, line.tokens)

    def key(self, what: str) -> str:
        """Take ``name:``."""
        offset = self.token[2]
        name = self.name(what)
        if not self.accept(":"):
            raise self.text.error(offset, f"expected {what} followed by :, found {quoted(name)}")
        return name

    def names(self) -> tuple[str, ...]:
        """Take ``[ a, b ]`` or one name."""
        if not self.accept("["):
            return (self.name("a name or ["),)
        names: list[str] = []
        while not self.accept("]"):
            names.append(self.name("a name or ]"))
            self.accept(",")
        return tuple(names)

    def end(self) -> None:
        """Raise an error unless the line ends here."""
        if not self.at_end():
            self.fail("end of line")

    def skip(self) -> None:
        """Take the rest of the line, unless something in it is never closed."""
        while not self.at_end():
            if self.token[0] == "bad":
                self.fail("")
            self._index += 1


def skip_block(text: Text, line: Line) -> None:
    """Read over what is below a line, however deep; what is never closed in it is an error."""
    waiting = line.below[::-1]
    while waiting:
        inner = waiting.pop()
        LineCursor(text, inner).skip()
        waiting += inner.below[::-1]
