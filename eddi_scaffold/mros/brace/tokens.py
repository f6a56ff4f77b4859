"""Tokens of the brace dialect, and the moves that its two readers share.

White space separates, line ends mean nothing. No word is reserved: whether one is a keyword follows
from its place. Tokens are found by one regular expression; what is not a token becomes an error
only when the reader gets there, so that the first error of a file is the one that is reported.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Sequence
from typing import NoReturn, TypeVar

from eddi_scaffold.common.problems import most_similar
from eddi_scaffold.mros.text import Text, alternatives, quoted

T = TypeVar("T")

_TOKEN = re.compile(
    r"""(?:\s+|//[^\n]*|/\*[\s\S]*?\*/)*
        (?:(?P<word>(?!/\*)[^\s"'{}()\[\],:]+)
          |(?P<string>"(?:[^"\\]|\\[\s\S])*"|'(?:[^'\\]|\\[\s\S])*')
          |(?P<punct>[{}()\[\],:])
          |(?P<bad>["']|/\*)
          |(?P<end>\Z))""",
    re.VERBOSE,
)
_ESCAPE = re.compile(r"\\([\s\S])")
_CLOSING = {"{": "}", "(": ")", "[": "]"}

Token = tuple[str, str, int]
"""(``word``, ``string``, ``punct``, ``bad`` or ``end``; its text; offset)."""


def tokens_of(text: str) -> list[Token]:
    """Return all tokens; the last one is ``end``, after ``bad`` nothing follows but it."""
    found: list[Token] = []
    match_at = _TOKEN.match
    position = 0
    while True:
        match = match_at(text, position)
        assert match is not None, "every character is matched by one alternative"
        kind = match.lastgroup
        assert kind is not None
        start = match.start(kind)
        found.append((kind, match[kind], start))
        position = match.end()
        if kind in {"end", "bad"}:
            if kind == "bad":
                found.append(("end", "", len(text)))
            return found


class TokenCursor:
    """A position in the tokens of one text."""

    def __init__(self, text: Text) -> None:
        self.text = text
        self._tokens = tokens_of(text.text)
        self._at = 0

    @property
    def offset(self) -> int:
        """Offset of the token that comes next."""
        return self._tokens[self._at][2]

    def place(self) -> tuple[int, int]:
        """Return line and column of the token that comes next."""
        return self.text.place(self.offset)

    def is_word(self, *words: str) -> bool:
        """Return whether one of these words comes next."""
        kind, value, _ = self._tokens[self._at]
        return kind == "word" and value in words

    def is_punct(self, mark: str) -> bool:
        """Return whether this punctuation comes next."""
        kind, value, _ = self._tokens[self._at]
        return kind == "punct" and value == mark

    def is_before(self, mark: str) -> bool:
        """Return whether this punctuation comes after the next token."""
        kind, value, _ = self._tokens[self._at + 1]
        return kind == "punct" and value == mark

    def at_end(self) -> bool:
        """Return whether nothing comes any more."""
        return self._tokens[self._at][0] == "end"

    def fail(self, *expected: str) -> NoReturn:
        """Raise the error that something else than what comes next was expected."""
        kind, value, offset = self._tokens[self._at]
        if kind == "bad":
            what = "comment" if value == "/*" else "quote"
            raise self.text.error(offset, f"this {what} is never closed")
        found = "end of file" if kind == "end" else quoted(value)
        words = [word.strip("'") for word in expected]
        near = most_similar(value, words) if kind == "word" and len(words) > 2 else None
        hint = f"; did you mean '{near}'?" if near else ""
        raise self.text.error(offset, f"expected {alternatives(expected)}, found {found}{hint}")

    def accept(self, *words: str) -> str | None:
        """Take one of these words, if it comes next."""
        kind, value, _ = self._tokens[self._at]
        if kind == "word" and value in words:
            self._at += 1
            return value
        return None

    def accept_punct(self, mark: str) -> bool:
        """Take this punctuation, if it comes next."""
        kind, value, _ = self._tokens[self._at]
        if kind == "punct" and value == mark:
            self._at += 1
            return True
        return False

    def expect(self, *words: str) -> str:
        """Take one of these words.

        Raises:
            MrosSyntaxError: something else comes next.
        """
        word = self.accept(*words)
        if word is None:
            self.fail(*(f"'{word}'" for word in words))
        return word

    def open(self, mark: str = "{") -> int:
        """Take an opening bracket and return its offset."""
        offset = self.offset
        if not self.accept_punct(mark):
            self.fail(f"'{mark}'")
        return offset

    def close(self, mark: str, opened: int, *others: str) -> None:
        """Take a closing bracket.

        Raises:
            MrosSyntaxError: something else comes next; it names the place of the opening one.
        """
        if self.accept_punct(mark):
            return
        line, col = self.text.place(opened)
        bracket = self.text.text[opened]
        closes = f"'{mark}' (it closes the '{bracket}' of line {line}, column {col})"
        self.fail(*others, closes)

    def name(self, what: str = "a name") -> str:
        """Take a word or a quoted text.

        Raises:
            MrosSyntaxError: something else comes next, or the quoted text goes over a line end.
        """
        kind, value, offset = self._tokens[self._at]
        if kind == "word":
            self._at += 1
            return value
        if kind != "string":
            self.fail(what)
        if "\n" in value:
            raise self.text.error(offset, f"{what} ends on its line: this quote is not closed")
        self._at += 1
        return unescaped(value)

    def block(self, read: Callable[[], T], opening: str = "{") -> list[T]:
        """Read ``{ element ,? ... }``: a comma may be missing, and one may follow the last."""
        elements: list[T] = []
        opened = self.open(opening)
        closing = _CLOSING[opening]
        while not self.accept_punct(closing):
            if self.at_end() or any(map(self.is_punct, "})]")):
                self.close(closing, opened)
            elements.append(read())
            self.accept_punct(",")
        return elements

    def skip_group(self) -> None:
        """Take a balanced group of brackets.

        Raises:
            MrosSyntaxError: it is not closed, or closed by another bracket.
        """
        stack = [(self._tokens[self._at][1], self.offset)]
        self._at += 1
        while stack:
            kind, value, _ = self._tokens[self._at]
            if kind == "punct" and value in _CLOSING:
                stack.append((value, self.offset))
            elif kind == "punct" and value in "})]":
                opening, opened = stack.pop()
                if _CLOSING[opening] != value:
                    self.close(_CLOSING[opening], opened)
            elif kind in {"end", "bad"}:
                if kind == "bad":
                    self.fail()
                opening, opened = stack[-1]
                self._never_closed(opening, opened)
            self._at += 1

    def skip_to(self, mark: str) -> None:
        """Take names and groups up to a bracket, which stays."""
        while not self.is_punct(mark):
            kind, value, _ = self._tokens[self._at]
            if kind == "punct" and value in _CLOSING:
                self.skip_group()
            elif kind in {"word", "string"} or (kind == "punct" and value in ",:"):
                self._at += 1
            else:
                self.fail("a value", f"'{mark}'")

    def _never_closed(self, opening: str, opened: int) -> NoReturn:
        if opening == "[":
            raise self.text.error(opened, "this '[' is never closed")
        self.close(_CLOSING[opening], opened)
        raise AssertionError("unreachable")

    def surplus(self) -> list[tuple[int, int]]:
        """Take closing braces after the end and return their places."""
        places = []
        while self.is_punct("}"):
            places.append(self.place())
            self._at += 1
        return places

    def expect_end(self, after: str) -> None:
        """Raise an error unless nothing comes any more."""
        if not self.at_end():
            self.fail(f"end of file (the {after} ends before)")


def unescaped(quoted_text: str) -> str:
    r"""Return the content of a quoted text: ``\x`` means x."""
    inner = quoted_text[1:-1]
    return _ESCAPE.sub(r"\1", inner) if "\\" in inner else inner


def either(words: Sequence[str]) -> list[str]:
    """Return words in quotes, for ``fail``."""
    return [f"'{word}'" for word in words]
