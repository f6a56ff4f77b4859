"""A text and its places: decoding, lines, and the errors that point into it."""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Iterable
from functools import cached_property
from typing import Final, Literal

Case = Literal["M001.syntax", "M001.empty", "M001.foreign"]
SYNTAX: Final = "M001.syntax"
EMPTY_FILE: Final = "M001.empty"
FOREIGN_FORMAT: Final = "M001.foreign"


class MrosSyntaxError(ValueError):
    """A file cannot be read.

    Attributes:
        file: name of the file, as it was given.
        line: counted from 1.
        col: character in the line, counted from 1.
        message: what is wrong, and what was expected.
        source_line: text of the line.
        case: ``SYNTAX``, ``FOREIGN_FORMAT`` (another language of the family) or ``EMPTY_FILE``.
        format: of a foreign format, ``xmi`` or ``rossdl``; else ``""``.
        dialect: ``brace`` or ``indent`` where that was known already.
    """

    def __init__(
        self,
        file: str,
        line: int,
        col: int,
        message: str,
        source_line: str = "",
        case: Case = SYNTAX,
        format: str = "",  # noqa: A002 - the word of the field
    ) -> None:
        super().__init__(f"{file}:{line}:{col}: {message}")
        self.file = file
        self.line = line
        self.col = col
        self.message = message
        self.source_line = source_line
        self.case = case
        self.format = format
        self.dialect: str | None = None


class Text:
    """The text of one file.

    Attributes:
        file: name for messages.
        text: without byte order mark, with line ends as they are.
    """

    def __init__(self, text: str, file: str) -> None:
        self.file = file
        self.text = text.removeprefix("\ufeff")

    @cached_property
    def _starts(self) -> list[int]:
        starts = [0]
        find = self.text.find
        position = find("\n")
        while position >= 0:
            starts.append(position + 1)
            position = find("\n", position + 1)
        return starts

    def place(self, offset: int) -> tuple[int, int]:
        """Return line and column of a character, both counted from 1."""
        line = bisect_right(self._starts, offset)
        return line, offset - self._starts[line - 1] + 1

    def line(self, number: int) -> str:
        """Return the text of a line."""
        start = self._starts[number - 1]
        end = self._starts[number] if number < len(self._starts) else len(self.text)
        return self.text[start:end].rstrip("\r\n")

    def error(
        self,
        offset: int,
        message: str,
        case: Case = SYNTAX,
        format: str = "",  # noqa: A002 - the word of the field
    ) -> MrosSyntaxError:
        """Return the error at a character."""
        line, col = self.place(offset)
        return MrosSyntaxError(self.file, line, col, message, self.line(line), case, format)


def decoded(data: bytes, file: str) -> Text:
    """Decode a file.

    Raises:
        MrosSyntaxError: it is not UTF-8.
    """
    try:
        return Text(data.decode("utf-8"), file)
    except UnicodeDecodeError as problem:
        before = Text(data[: problem.start].decode("utf-8"), file)
        message = f"the file is not UTF-8 text: byte {problem.start} cannot be decoded"
        raise before.error(len(before.text), message) from None


def alternatives(words: Iterable[str]) -> str:
    """Return ``a, b or c``."""
    *most, last = words
    return f"{', '.join(most)} or {last}" if most else last


def quoted(text: str) -> str:
    """Return a piece of the file in quotes, shortened where it is long."""
    shown = " ".join(text.split())
    return f"'{shown}'" if len(shown) <= 40 else f"'{shown[:37]}...'"
