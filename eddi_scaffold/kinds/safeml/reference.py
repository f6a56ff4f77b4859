"""Read the reference sample, and report clearly why a file is not one.

The file is what ``numpy.savetxt(name, a, delimiter=",")`` writes: a row is a sample, in time order.
"""

from __future__ import annotations

import re
from dataclasses import replace

import numpy as np

from eddi_scaffold.kinds.safeml.design import Rows
from eddi_scaffold.kinds.safeml.model import ReferenceSample, SafeMLSettings
from eddi_scaffold.problems import EddiError, Place, Problem, error, has_errors
from eddi_scaffold.source import Source, beside, read_source

MAX_BYTES = 512 * 1024 * 1024
MAX_PROBLEMS = 20
"""Problems that are listed of one file; a wrong column would else be reported for every row."""

_BLANKS = " \t\v\f"
"""Characters allowed around a number, as in ``float`` for ASCII."""

_LINE_END = re.compile(r"\r\n|\r|\n")  # not splitlines(), which sees ends that editors do not
_NUMBER = re.compile(r"[-+]?(\d+(\.\d*)?|\.\d+)([eE][-+]?\d+)?", re.ASCII)
_NOT_FINITE = re.compile(r"[-+]?(nan|inf|infinity)", re.ASCII | re.IGNORECASE)
_SEPARATORS = {";": "semicolons", "\t": "tabs", " ": "blanks"}
_WRITTEN = 'numpy.savetxt(name, array, delimiter=",") writes such a file'


def read_named(file: str, settings: SafeMLSettings) -> tuple[ReferenceSample | None, list[Problem]]:
    """Read the reference that the settings in a file name, relative to it."""
    name = settings.reference_sample_file
    try:
        return read_reference(read_source(beside(file, name), MAX_BYTES))
    except EddiError as failure:
        reasons = "; ".join(problem.message for problem in failure.problems)
        text = f"reference_sample_file {name!r}: {reasons}"
        hint = "it is looked for next to this file"
        return None, [error("L004", text, settings.place("reference_sample_file"), hint)]


def read_reference(source: Source) -> tuple[ReferenceSample | None, list[Problem]]:
    """Read a reference sample.

    Returns:
        The reference, ``None`` when a problem is an error (L004, L005), and all problems. Line and
        column of a place are the row and the column of the cell.
    """
    try:
        text = source.text("L004")
    except EddiError as refused:
        return None, list(refused.problems)
    lines = _filled_lines(text)
    if not lines:
        return None, [error("L004", "the reference is empty", Place(source.name), _WRITTEN)]
    reader = _Reader(source.name, lines)
    rows = reader.read()
    if has_errors(reader.problems):
        return None, reader.problems
    values = np.array(rows, dtype=np.float64)
    problems = _not_finite(values, [number for number, _ in lines], source.name)
    if len(values) < 2:
        place = Place(source.name, lines[0][0])
        problems.append(error("L004", "the reference has one row only: no distribution", place))
    return (None if problems else ReferenceSample(source, values)), problems


def _filled_lines(text: str) -> list[tuple[int, str]]:
    """Return number (from 1) and text of each line that is neither empty nor a comment (``#``)."""
    lines = ((k, line.strip(_BLANKS)) for k, line in enumerate(_LINE_END.split(text), 1))
    return [(number, line) for number, line in lines if line and not line.startswith("#")]


class _Reader:
    def __init__(self, file: str, lines: list[tuple[int, str]]) -> None:
        self.problems: list[Problem] = []
        self._file = file
        self._lines = lines

    def read(self) -> list[list[float]]:
        """Return the cells, and note what is wrong with them."""
        if self._wrong_separator():
            return []
        width = self._lines[0][1].count(",") + 1
        rows: list[list[float]] = []
        for index, (number, line) in enumerate(self._lines):
            cells = line.split(",")
            if len(cells) != width:
                first = self._lines[0][0]
                text = f"row {number} has {_cells(len(cells))}, row {first} has {width}"
                self._error(text, number, min(len(cells), width) + 1)
            row = _fast(cells)
            if row is None:
                self._explain(index, number, cells)
            rows.append(row or [])
            if len(self.problems) >= MAX_PROBLEMS:
                self._error("too many problems, the rest was not read", number, 1)
                break
        return rows

    def _error(self, text: str, row: int, column: int, hint: str | None = None) -> None:
        self.problems.append(_at(error("L004", text, Place(self._file, row, column), hint)))

    def _wrong_separator(self) -> bool:
        number, line = self._lines[min(1, len(self._lines) - 1)]  # the first may be a header
        for separator, name in _SEPARATORS.items():
            cells = [cell.replace(",", ".") for cell in line.split(separator) if cell.strip()]
            if (
                len(cells) > 1
                and all(_is_number(cell) for cell in cells)
                and (separator == ";" or "," not in line)
            ):
                text = f"the cells are separated by {name}, commas are expected"
                self._error(text, number, 1, _WRITTEN)
                return True
        return False

    def _explain(self, index: int, number: int, cells: list[str]) -> None:
        wrong = [k for k, cell in enumerate(cells, 1) if not _is_number(cell)]
        names = [cells[k - 1].strip() for k in wrong]
        if index == 0 and all(names) and len(wrong) == len(cells):
            text = f"row {number} is a header, not numbers: it begins with {names[0][:40]!r}"
            self._error(text, number, 1, "delete it, or write # before it")
            return
        for column, name in zip(wrong, names, strict=True):
            what = f"is not a number: {name[:40]!r}" if name else "is empty"
            self._error(f"row {number}, column {column} {what}", number, column)


def _fast(cells: list[str]) -> list[float] | None:
    """Return the numbers of a row, ``None`` when a cell is none."""
    try:
        row = [float(cell) for cell in cells]
    except ValueError:
        return None
    # float() reads also 1_000 and digits of other scripts
    plain = all(cell.isascii() and "_" not in cell for cell in cells)
    return row if plain else None


def _cells(count: int) -> str:
    return f"{count} cell{'s' if count > 1 else ''}"


def _is_number(cell: str) -> bool:
    text = cell.strip(_BLANKS)
    return bool(_NUMBER.fullmatch(text) or _NOT_FINITE.fullmatch(text))


def _not_finite(values: Rows, numbers: list[int], file: str) -> list[Problem]:
    bad = np.argwhere(~np.isfinite(values))
    if not len(bad):
        return []
    row, column = numbers[int(bad[0][0])], int(bad[0][1]) + 1
    text = f"{_cells(len(bad))} without a finite number, first row {row}, column {column}"
    hint = "a reference holds correct behaviour only: leave such samples out"
    return [_at(error("L005", text, Place(file, row, column), hint))]


def _at(problem: Problem) -> Problem:
    """Keep the line of the file out: its column counts cells, not characters."""
    return replace(problem, excerpt="")
