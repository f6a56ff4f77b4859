"""A text, its places and tokens, and the errors that point into it."""

from __future__ import annotations

import re
from bisect import bisect_right
from collections.abc import Sequence
from dataclasses import replace
from typing import NoReturn

from eddi_scaffold.common.problems import EddiError, Place, Problem, problem
from eddi_scaffold.mros.model import Dialect, Field

STRING = r"""(?P<string>"(?:[^"\\]|\\[\s\S])*"|'(?:[^'\\]|\\[\s\S])*')"""
SPEC_PARTS = ("message", "request", "response", "goal", "result", "feedback")
_ESCAPE = re.compile(r"\\([\s\S])")


class MrosSyntaxError(EddiError):
    """A file cannot be read.

    Attributes:
        why: ``empty``, the foreign format (``xmi``, ``rossdl``), or empty for a syntax error.
        dialect: ``brace`` or ``indent`` where that was known already.
    """

    def __init__(self, problem: Problem, why: str, dialect: Dialect | None) -> None:
        super().__init__(problem)
        self.why, self.dialect = why, dialect


class Text:
    """The text of one file, without byte order mark, with line ends as they are."""

    dialect: Dialect | None = None

    def __init__(self, text: str, file: str) -> None:
        self.text = text.removeprefix("\ufeff")
        self.file = file
        self._starts = [0, *(line_end.end() for line_end in re.finditer("\n", self.text))]

    def place(self, offset: int) -> Place:
        """Return the place of a character."""
        line = bisect_right(self._starts, offset)
        return Place(self.file, line, offset - self._starts[line - 1] + 1)

    def error(self, offset: int, reason: str, why: str = "") -> MrosSyntaxError:
        """Return the error at a character; ``why`` is that of :class:`MrosSyntaxError`."""
        place = self.place(offset)
        case = {"": "M001.syntax", "empty": "M001.empty"}.get(why, "M001.foreign")
        excerpt = self.text.split("\n")[(place.line or 1) - 1].rstrip("\r")
        fault = replace(problem(case, place, reason=reason), excerpt=excerpt)
        return MrosSyntaxError(fault, why, self.dialect)


def decoded(source: str | bytes, file: str) -> Text:
    """Decode a file, which must be UTF-8."""
    if isinstance(source, str):
        return Text(source, file)
    try:
        return Text(source.decode("utf-8"), file)
    except UnicodeDecodeError as broken:
        before = Text(source[: broken.start].decode("utf-8"), file)
        message = f"the file is not UTF-8 text: byte {broken.start} cannot be decoded"
        raise before.error(len(before.text), message) from None


Token = tuple[str, str, int]
"""Kind (``word``, ``string``, ``punct``, ``end``, or ``bad``: never closed), text, offset."""


def never_closed(mark: str, offset: int) -> Token:
    """Return the token of a quote, comment or bracket that is open to the end of the file."""
    what = {"/*": "comment", "[": "'['"}.get(mark, "quote")
    return "bad", f"this {what} is never closed", offset


class Cursor:
    """A position among tokens, whose last one is an ``end`` and says of what.

    What does not fit raises :class:`MrosSyntaxError`.
    """

    def __init__(self, text: Text, tokens: Sequence[Token]) -> None:
        self.text = text
        self._tokens = tokens
        self._index = 0

    @property
    def token(self) -> Token:
        """The token that comes next."""
        return self._tokens[self._index]

    def place(self) -> Place:
        """Return the place of what comes next."""
        return self.text.place(self.token[2])

    def at_end(self) -> bool:
        """Return whether nothing comes any more."""
        return self.token[0] == "end"

    def is_next(self, *texts: str) -> bool:
        """Return whether one of these words or marks comes next; texts in quotes are neither."""
        return self._tokens[self._index][1] in texts

    def accept(self, *texts: str) -> str | None:
        """Take one of these words or marks, if it comes next."""
        value = self._tokens[self._index][1]
        if value not in texts:
            return None
        self._index += 1
        return value

    def expect(self, *texts: str) -> str:
        """Take one of these words or marks, which must come next."""
        return self.accept(*texts) or self.fail(*map(repr, texts))

    def fail(self, *expected: str) -> NoReturn:
        """Raise the error that something else than what comes next was expected."""
        kind, value, offset = self.token
        if kind == "bad":
            raise self.text.error(offset, value)
        actual = value if kind == "end" else quoted(value)
        raise self.text.error(offset, f"expected {alternatives(expected)}, found {actual}")

    def name(self, what: str) -> str:
        r"""Take a word or a quoted text on one line, in which ``\x`` means x."""
        kind, value, offset = self._tokens[self._index]
        if kind not in {"word", "string"}:
            self.fail(what)
        if kind == "string":
            if "\n" in value:
                raise self.text.error(offset, f"{what} ends on its line: this quote is not closed")
            value = _ESCAPE.sub(r"\1", value[1:-1]) if "\\" in value else value[1:-1]
        self._index += 1
        return value

    def field(self) -> Field:
        """Read ``type name``, ``type NAME=value``, or ``name: type`` of May 2023."""
        first = self.name("the type of a field")
        if self.accept(":"):
            if not self.accept("["):  # which marks fields that are no arrays as well
                return Field(self._array_of(self.name("the type of the field")), first)
            of = self.name("the type of the field")
            self.expect("]")
            return Field(f"[{of}]", first)
        of = self._array_of(first)
        name, equals, value = self.name("the name of the field").partition("=")
        if equals and not value:
            value = self.name(f"the value of {name}")
        return Field(of, name, value if equals else None)

    def _array_of(self, of: str) -> str:
        if not self.accept("["):
            return of
        if not self.is_next("]"):
            self.name("a length")
        self.expect("]")
        return f"{of}[]"


def alternatives(words: Sequence[str]) -> str:
    """Return ``a, b or c``."""
    return " or ".join(filter(None, (", ".join(words[:-1]), words[-1])))


def quoted(text: str) -> str:
    """Return a piece of the file in quotes, shortened where it is long."""
    shown = " ".join(text.split())
    return f"'{shown}'" if len(shown) <= 40 else f"'{shown[:37]}...'"
