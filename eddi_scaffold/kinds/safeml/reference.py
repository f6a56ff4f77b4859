"""Read the reference sample, and report clearly why a file is not one.

The file is what ``numpy.savetxt(name, a, delimiter=",")`` writes: a row is a sample, in time order.
"""

from __future__ import annotations

import re
from collections import Counter
from dataclasses import replace
from typing import Any

import numpy as np

from eddi_scaffold.common.files import Source, next_to, read_source
from eddi_scaffold.common.problems import EddiError, Place, Problem, has_errors, problem
from eddi_scaffold.kinds.safeml.scope import ReferenceSample, Rows, SafeMLSettings

MAX_BYTES = 512 * 1024 * 1024
MAX_PROBLEMS = 20
"""Problems that are listed of one file; a wrong column would else be reported for every row."""

_BLANKS = " \t\v\f"
"""Characters allowed around a number, as in ``float`` for ASCII."""

_LINE_END = re.compile(r"\r\n|\r|\n")  # not splitlines(), which sees ends that editors do not
_NUMBER = re.compile(r"[-+]?(\d+(\.\d*)?|\.\d+)([eE][-+]?\d+)?", re.ASCII)
_NOT_FINITE = re.compile(r"[-+]?(nan|inf|infinity)", re.ASCII | re.IGNORECASE)
_FEWEST_COUNTED = 10
"""Rows from which on equal steps are no chance."""
_TIME = re.compile(r"\d\d?:\d\d|\d{4}-\d\d-\d\d")
_SEPARATORS = {";": "semicolons", "\t": "tabs", " ": "blanks"}


def read_named(file: str, settings: SafeMLSettings) -> tuple[ReferenceSample | None, list[Problem]]:
    """Read the reference that the settings in a file name, relative to it."""
    name = settings.reference_sample_file
    try:
        return read_reference(read_source(next_to(file, name), MAX_BYTES))
    except EddiError as failure:
        reasons = "; ".join(problem.message for problem in failure.problems)
        told = [problem.hint for problem in failure.problems if problem.code == "F003"]
        hint = next(iter(told), "it is looked for next to this file")
        return None, [
            problem(
                "L004.file",
                settings.place("reference_sample_file"),
                hint=hint,
                name=name,
                reasons=reasons,
            )
        ]


def read_reference(source: Source) -> tuple[ReferenceSample | None, list[Problem]]:
    """Read a reference sample.

    Returns:
        The reference, ``None`` when a problem is an error (L004), and all problems. Line and
        column of a place are the row and the column of the cell.
    """
    try:
        text = source.text("L004")
    except EddiError as refused:
        return None, list(refused.problems)
    lines = _filled_lines(text)
    if not lines:
        return None, [problem("L004.empty", Place(source.name))]
    reader = _Reader(source.name, lines)
    rows = reader.read()
    if has_errors(reader.problems):
        return None, reader.problems
    values = np.array(rows, dtype=np.float64)
    problems = _not_finite(values, [number for number, _ in lines], source.name)
    if not problems and _counts_rows(values):
        problems.append(_at(problem("L004.running_index", Place(source.name, lines[0][0], 1))))
    if len(values) < 2:
        place = Place(source.name, lines[0][0])
        problems.append(problem("L004.one_row", place))
    return (None if problems else ReferenceSample(source, values)), problems


def _counts_rows(values: Rows) -> bool:
    """Return whether the first of several columns is that of a table's rows, or of its times."""
    if len(values) < _FEWEST_COUNTED or values.shape[1] < 2:
        return False
    steps = np.diff(values[:, 0])
    return bool(steps[0] > 0.0 and np.allclose(steps, steps[0], rtol=1e-6, atol=0.0))


def _filled_lines(text: str) -> list[tuple[int, str]]:
    """Return number (from 1) and text of each line that is neither empty nor a comment (``#``)."""
    lines = ((k, line.strip(_BLANKS)) for k, line in enumerate(_LINE_END.split(text), 1))
    return [(number, line) for number, line in lines if line and not line.startswith("#")]


class _Reader:
    def __init__(self, file: str, lines: list[tuple[int, str]]) -> None:
        self.problems: list[Problem] = []
        self._file = file
        self._lines = lines
        self._has_header = False
        self._wrong: dict[int, tuple[int, str, int]] = {}
        """Column -> its first row that is no number, the text there, and how many there are."""

    def read(self) -> list[list[float]]:
        """Return the cells, and note what is wrong with them."""
        if self._wrong_separator():
            return []
        widths = Counter(line.count(",") + 1 for _, line in self._lines)
        width = widths.most_common(1)[0][0]
        usual = next(number for number, line in self._lines if line.count(",") + 1 == width)
        rows: list[list[float]] = []
        for index, (number, line) in enumerate(self._lines):
            cells = line.split(",")
            if len(cells) != width:
                column = min(len(cells), width) + 1
                self._report(
                    "L004.cells",
                    number,
                    column,
                    row=number,
                    cells=_cells(len(cells)),
                    other=usual,
                    width=width,
                )
                continue
            row = _fast(cells)
            if row is None:
                self._explain(index, number, cells)
            rows.append(row or [])
            if len(self.problems) >= MAX_PROBLEMS:
                self._report("L004.rest", number, 1)
                break
        for column, (number, name, count) in self._wrong.items():
            self._column(column, number, name, count)
        return rows

    def _column(self, column: int, number: int, name: str, count: int) -> None:
        """Tell once what is wrong with the cells of a column."""
        if count == len(self._lines) - self._has_header:
            what = "times" if _TIME.search(name) else "texts"
            self._report("L004.column", number, column, column=column, content=what, text=name[:40])
            return
        what = f"is not a number: {name[:40]!r}" if name else "is empty"
        more = f", and {count - 1} more of this column" if count > 1 else ""
        self._report("L004.cell", number, column, row=number, column=column, reason=what, more=more)

    def _report(self, case: str, row: int, column: int, /, **fields: Any) -> None:
        self.problems.append(_at(problem(case, Place(self._file, row, column), **fields)))

    def _wrong_separator(self) -> bool:
        number, line = self._lines[min(1, len(self._lines) - 1)]  # the first may be a header
        for separator, name in _SEPARATORS.items():
            cells = [cell.replace(",", ".") for cell in line.split(separator) if cell.strip()]
            if (
                len(cells) > 1
                and all(_is_number(cell) for cell in cells)
                and (separator == ";" or "," not in line)
            ):
                self._report("L004.separator", number, 1, separator=name)
                return True
        return False

    def _explain(self, index: int, number: int, cells: list[str]) -> None:
        wrong = [k for k, cell in enumerate(cells, 1) if not _is_number(cell)]
        names = [cells[k - 1].strip() for k in wrong]
        if index == 0 and any(names) and len(wrong) == len(cells) and not self._repeats(cells):
            self._has_header = True
            first = next(filter(None, names))
            self._report("L004.header", number, 1, row=number, text=first[:40])
            return
        for column, name in zip(wrong, names, strict=True):
            first_row, first_name, count = self._wrong.get(column, (number, name, 0))
            self._wrong[column] = (first_row, first_name, count + 1)

    def _repeats(self, cells: list[str]) -> bool:
        """Return whether the second row has no number, either: then the first is no header."""
        second = self._lines[1][1].split(",") if len(self._lines) > 1 else cells
        return len(self._lines) > 1 and not any(map(_is_number, second))


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
    return [
        _at(
            problem(
                "L004.not_finite",
                Place(file, row, column),
                number=_cells(len(bad)),
                row=row,
                column=column,
            )
        )
    ]


def _at(problem: Problem) -> Problem:
    """Keep the line of the file out: its column counts cells, not characters."""
    return replace(problem, excerpt="")
