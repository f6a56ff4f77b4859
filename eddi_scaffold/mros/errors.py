"""The one exception of the readers."""

from __future__ import annotations

from typing import Final, Literal

Code = Literal["M001", "M002", "M003"]
SYNTAX: Final = "M001"
EMPTY_FILE: Final = "M002"
FOREIGN_FORMAT: Final = "M003"


class MrosSyntaxError(ValueError):
    """A file cannot be read.

    Attributes:
        file: name of the file, as it was given.
        line: counted from 1.
        col: character in the line, counted from 1.
        message: what is wrong, and what was expected.
        source_line: text of the line.
        code: ``SYNTAX``, ``FOREIGN_FORMAT`` (another language of the family) or ``EMPTY_FILE``.
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
        code: Code = SYNTAX,
        format: str = "",  # noqa: A002 - the word of the field
    ) -> None:
        super().__init__(f"{file}:{line}:{col}: {message}")
        self.file = file
        self.line = line
        self.col = col
        self.message = message
        self.source_line = source_line
        self.code = code
        self.format = format
        self.dialect: str | None = None
