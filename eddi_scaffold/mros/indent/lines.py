"""Lines and blocks of the indentation dialect.

A block is deeper indentation of lines that are not blank. A tab counts 8 columns, every other white
character 1. Lines that hold only a comment, and everything between ``[`` and ``]``, take no part in
the indentation; a quoted text may go over several lines.
"""

from __future__ import annotations

import re
from dataclasses import dataclass, field

from eddi_scaffold.mros.brace.tokens import unescaped
from eddi_scaffold.mros.text import Text, quoted

_TOKEN = re.compile(
    r"""(?P<space>[^\S\n]+)
       |(?P<newline>\n)
       |(?P<comment>\#[^\n]*|/\*[\s\S]*?\*/)
       |(?P<string>"(?:[^"\\]|\\[\s\S])*"|'(?:[^'\\]|\\[\s\S])*')
       |(?P<punct>[:\[\],])
       |(?P<word>(?!/\*)[^\s"'\[\],:\#]+)
       |(?P<bad>["']|/\*)""",
    re.VERBOSE,
)
_TAB = 8
_MARK = "---"

Token = tuple[str, str, int]
"""(``word``, ``string``, ``punct`` or ``bad``; its text; offset)."""


@dataclass
class Line:
    """One logical line and the block below it.

    Attributes:
        indent: columns before the first token.
        dash: it begins with ``-``, which is not among the tokens.
        offset: of the first character that is not white space.
        tokens: its content.
        below: the lines of its block.
    """

    indent: int
    dash: bool
    offset: int
    tokens: list[Token]
    below: list[Line] = field(default_factory=list)

    @property
    def is_mark(self) -> bool:
        """Whether it is the ``---`` with which YAML files begin; it has no meaning."""
        return [token[1] for token in self.tokens] == [_MARK] and not self.below


@dataclass
class _Block:
    """A block while it is built."""

    outer: int
    lines: list[Line]

    @property
    def first(self) -> Line:
        return self.lines[0]


def blocks_of(text: Text) -> list[Line]:
    """Return the lines of the outermost block, each with what is below it.

    Raises:
        MrosSyntaxError: a line has the indentation of no open block. An open quote, comment or
            ``[`` becomes a token ``bad`` instead: an error above it comes first.
    """
    root: list[Line] = []
    stack: list[_Block] = []
    for line in _lines(text):
        while stack and line.indent <= stack[-1].outer:
            stack.pop()
        if not stack:
            stack.append(_Block(-1, root))
            root.append(line)
            continue
        block = stack[-1]
        if line.indent > block.first.indent:
            inner = _Block(block.first.indent, block.lines[-1].below)
            inner.lines.append(line)
            stack.append(inner)
        elif line.indent == block.first.indent or line.dash or block.first.dash:
            block.lines.append(line)
        else:
            number, _ = text.place(block.first.offset)
            message = (
                f"this line has an indentation of {line.indent}, its block one of "
                f"{block.first.indent} (line {number}; a tab counts {_TAB})"
            )
            raise text.error(line.offset, message)
    return root


def _lines(text: Text) -> list[Line]:
    found: list[Line] = []
    tokens: list[Token] = []
    content = text.text
    indent = position = start = depth = 0
    opened = 0
    match_at = _TOKEN.match
    end = len(content)
    at_start = True

    def finish() -> None:
        nonlocal tokens
        if tokens:
            found.append(_line(indent, start, tokens))
        tokens = []

    while position < end:
        match = match_at(content, position)
        assert match is not None, "every character is matched by one alternative"
        kind, value = match.lastgroup, match[0]
        if kind == "newline":
            if depth == 0:
                finish()
                indent, at_start = 0, True
        elif kind == "space":
            if at_start:
                indent += sum(_TAB if char == "\t" else 1 for char in value if char != "\r")
        elif kind == "comment":
            pass
        else:
            if at_start:
                start, at_start = position, False
            assert kind is not None
            if kind == "punct" and value == "[":
                opened, depth = (position if depth == 0 else opened), depth + 1
            elif kind == "punct" and value == "]" and depth:
                depth -= 1
            tokens.append((kind, value, position))
            if kind == "bad":
                break
        position = match.end()
    if depth and tokens and tokens[-1][0] != "bad":
        tokens = [token for token in tokens if token[2] < opened]
        tokens.append(("bad", "[", opened))
    finish()
    return found


def _line(indent: int, start: int, tokens: list[Token]) -> Line:
    kind, value, offset = tokens[0]
    dash = kind == "word" and value.startswith("-") and not _is_number(value)
    if value == _MARK:
        return Line(indent, dash=False, offset=start, tokens=tokens)
    if dash:
        rest = [("word", value[1:], offset + 1)] if len(value) > 1 else []
        tokens = [*rest, *tokens[1:]]
    return Line(indent, dash, start, tokens)


def _is_number(word: str) -> bool:
    return re.fullmatch(r"-[\d.]+", word) is not None


class LineCursor:
    """A position in the tokens of one line."""

    def __init__(self, text: Text, line: Line) -> None:
        self.text = text
        self.line = line
        self._at = 0

    @property
    def offset(self) -> int:
        """Offset of what comes next; at the end of the line that of its last token."""
        tokens = self.line.tokens
        if self._at < len(tokens):
            return tokens[self._at][2]
        return tokens[-1][2] if tokens else self.line.offset

    def place(self) -> tuple[int, int]:
        """Return line and column of what comes next."""
        return self.text.place(self.offset)

    def at_end(self) -> bool:
        """Return whether the line has no more tokens."""
        return self._at >= len(self.line.tokens)

    def is_punct(self, mark: str) -> bool:
        """Return whether this punctuation comes next."""
        return not self.at_end() and self.line.tokens[self._at][:2] == ("punct", mark)

    def accept_punct(self, mark: str) -> bool:
        """Take this punctuation, if it comes next."""
        if self.is_punct(mark):
            self._at += 1
            return True
        return False

    def fail(self, expected: str) -> Exception:
        """Return the error that something else than what comes next was expected."""
        if self.at_end():
            return self.text.error(self.offset, f"expected {expected}, found end of line")
        kind, value, offset = self.line.tokens[self._at]
        if kind == "bad":
            what = {"/*": "comment", "[": "'['"}.get(value, "quote")
            return self.text.error(offset, f"this {what} is never closed")
        return self.text.error(offset, f"expected {expected}, found {quoted(value)}")

    def name(self, what: str) -> str:
        """Take a word or a quoted text.

        Raises:
            MrosSyntaxError: something else comes next, or the quoted text goes over a line end.
        """
        if self.at_end() or self.line.tokens[self._at][0] not in {"word", "string"}:
            raise self.fail(what)
        kind, value, offset = self.line.tokens[self._at]
        if kind == "string" and "\n" in value:
            raise self.text.error(offset, f"{what} ends on its line: this quote is not closed")
        self._at += 1
        return unescaped(value) if kind == "string" else value

    def key(self, what: str) -> str:
        """Take ``name:``.

        Raises:
            MrosSyntaxError: there is no name, or no colon behind it.
        """
        before = self._at
        name = self.name(what)
        if not self.accept_punct(":"):
            offset = self.line.tokens[before][2]
            raise self.text.error(offset, f"expected {what} followed by :, found {quoted(name)}")
        return name

    def end(self) -> None:
        """Raise an error unless the line ends here."""
        if not self.at_end():
            raise self.fail("end of line")

    def skip(self) -> None:
        """Take whatever is left, unless it is open.

        Raises:
            MrosSyntaxError: a quote, comment or bracket is never closed.
        """
        for position in range(self._at, len(self.line.tokens)):
            if self.line.tokens[position][0] == "bad":
                self._at = position
                raise self.fail("")
        self._at = len(self.line.tokens)

    def names(self) -> tuple[str, ...]:
        """Take ``[ a, b ]`` or one name.

        Raises:
            MrosSyntaxError: neither comes next.
        """
        if not self.accept_punct("["):
            return (self.name("a name or ["),)
        found: list[str] = []
        while not self.accept_punct("]"):
            found.append(self.name("a name or ]"))
            self.accept_punct(",")
        return tuple(found)


def skip_block(text: Text, line: Line) -> None:
    """Read over what is below a line, however deep; what is never closed in it is an error."""
    waiting = line.below[::-1]
    while waiting:
        inner = waiting.pop()
        LineCursor(text, inner).skip()
        waiting += inner.below[::-1]
