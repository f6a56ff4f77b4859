"""Recorded inputs: a CSV file with a column ``t`` (seconds) and one column per input.

An empty cell means that no new sample came: the last one holds until it is older than the input's
``max_age``. Which values count is decided by the monitor and ``EDDIInputBase``, as on the robot.
"""

from __future__ import annotations

import math
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from decimal import Decimal
from typing import TYPE_CHECKING, Any, NamedTuple

from eddi_scaffold.common.problems import (
    EddiError,
    Place,
    Problem,
    did_you_mean,
    has_errors,
    problem,
    with_excerpts,
)

if TYPE_CHECKING:
    from eddi_scaffold.common.files import Source
    from eddi_scaffold.kinds import InputType, JsonValue


TIME = "t"
MAX_PROBLEMS = 10
"""Errors after which no more rows are read: a wrong column would be reported for every one."""
MAX_TIME_S = 9e9  # 285 years: a monitor counts nanoseconds in 64 bits

_NUMBER = re.compile(r"[-+]?(\d+(\.\d*)?|\.\d+)([eE][-+]?\d+)?|[-+]?inf", re.ASCII)
_WHOLE = re.compile(r"[-+]?\d{1,400}", re.ASCII)
_CELL = re.compile(r'(?:\s*"((?:[^"]|"")*)"\s*|([^",]*))(,|$)')
_TRUTH = {"true": True, "1": True, "false": False, "0": False}
_EXPECTED: Mapping[str, str] = {
    "bool": "true, false, 1, 0, or nan for unknown",
    "float": "a number with a decimal point and no unit, or nan for unknown",
    "int": "a whole number, or nan for unknown",
    "str": "a text",
    "state": "a state, or numbers with blanks between them",
    "float[]": "numbers with blanks between them",
    "bool[]": "true, false, 1, 0 or nan with blanks between them",
}


class Row(NamedTuple):
    """One line of a CSV file: its time in seconds, and the new samples of inputs."""

    t: float
    samples: Mapping[str, JsonValue]


@dataclass(frozen=True)
class Sample:
    """One message of a recording."""

    t: int  # nanoseconds
    topic: str  # full name of a topic; of a CSV file, id of an input
    message: Any


@dataclass(frozen=True)
class Recording:
    """What was recorded; times are nanoseconds."""

    start: int  # where it begins
    end: int  # where it ends
    samples: tuple[Sample, ...]  # in the order of time
    rows: tuple[int, ...] = ()  # times at which something was written down, also if no sample came


def recording_of(rows: Sequence[Row]) -> Recording:
    """Return the rows of a CSV file as a recording."""
    # Of the decimal number in the file, not of its binary form.
    times = tuple(round(Decimal(repr(row.t)).scaleb(9)) for row in rows)
    samples = (
        Sample(t, name, value)
        for t, row in zip(times, rows, strict=True)
        for name, value in row.samples.items()
    )
    return Recording(times[0], times[-1], tuple(samples), times)


def read_rows(
    source: Source, types: Mapping[str, InputType]
) -> tuple[Sequence[Row] | None, list[Problem]]:
    """Read the rows of a recording.

    Args:
        source: the CSV file, UTF-8, comma-separated, cells quoted by ``"`` where needed.
        types: input id -> type of its values; other columns than these and ``t`` are errors.

    Returns:
        The rows in the order of time, ``None`` when a problem is an error; and all problems.
    """
    try:
        text = source.text("I001")
    except EddiError as refused:
        return None, list(refused.problems)
    reader = _Reader(source.name, types)
    lines = [line.removesuffix("\r") for line in text.split("\n")]
    rows = reader.read(lines)
    problems = with_excerpts(reader.problems, "\n".join(lines))
    return (None if has_errors(problems) else rows), problems


def header_of(source: Source) -> Sequence[str]:
    """Return the names of the columns; none of a damaged file: reading it reports what is wrong."""
    lines = filter(str.strip, source.text("I001").split("\n"))
    cells = _Reader(source.name, {}).cells(1, next(lines, "").removesuffix("\r"))
    return [cell.text for cell in cells or ()]


class _Cell(NamedTuple):
    text: str
    col: int
    quoted: bool = False


class _Reader:
    """Reads the lines of one file and collects what is wrong with them."""

    def __init__(self, file: str, types: Mapping[str, InputType]) -> None:
        self.problems: list[Problem] = []
        self._file, self._types = file, types
        self._errors = 0

    def read(self, lines: Sequence[str]) -> list[Row]:
        filled = [(number, line) for number, line in enumerate(lines, 1) if line.strip()]
        if not filled:
            self._report("I001.empty", 1, 1)
            return []
        header, *rest = filled
        columns = self._columns(*header)
        rows: list[Row] = []
        for number, line in rest if TIME in columns else ():
            if self._errors >= MAX_PROBLEMS:
                self._report("I001.more", number, 1)
                break
            row = self._row(number, line, columns, rows[-1].t if rows else -math.inf)
            if row is not None:
                rows.append(row)
        if not rest and not self._errors:
            self._report("I001.no_rows", header[0], 1)
        return rows

    def _report(
        self, case: str, line: int, col: int, /, *, hint: str | None = None, **fields: object
    ) -> None:
        self._errors += 1
        self.problems.append(problem(case, Place(self._file, line, col), hint=hint, **fields))

    def _columns(self, number: int, line: str) -> tuple[str, ...]:
        """Return the names of the columns; the first ``t`` is the time, also if an input is t."""
        cells = self.cells(number, line) or []
        names = tuple(cell.text for cell in cells)
        if TIME in names:
            time_cell = cells[names.index(TIME)]
        else:
            time_cell = _Cell("", 1)
            self._report("I001.no_time", number, 1)
        inputs = [cell for cell in cells if cell is not time_cell]
        seen: set[str] = set()
        for name, col in ((cell.text, cell.col) for cell in inputs):
            if name in seen or (name == TIME and TIME not in self._types):
                self._report("I001.duplicate_column", number, col, column=name)
            elif name not in self._types:
                known = f"columns are t and the inputs: {', '.join(self._types)}"
                hint = did_you_mean(name, self._types) or known
                self._report("I003.unknown_column", number, col, hint=hint, column=name)
            seen.add(name)
        self.problems += [
            problem("I004.no_column", Place(self._file, number, 1), name=name)
            for name in self._types
            if name not in seen
        ]
        return names

    def _row(self, number: int, line: str, columns: Sequence[str], last: float) -> Row | None:
        cells = self.cells(number, line)
        if cells is None:
            return None
        if len(cells) != len(columns):
            self._report("I001.cells", number, 1, actual=len(cells), expected=len(columns))
            return None
        time_at = columns.index(TIME)
        t = self._time(cells[time_at], number, last)
        samples = {
            name: self._value(cell, number, self._types[name])
            for index, (name, cell) in enumerate(zip(columns, cells, strict=True))
            if index != time_at and name in self._types and (cell.text or cell.quoted)
        }
        return None if t is None else Row(t, samples)

    def _time(self, cell: _Cell, number: int, last: float) -> float | None:
        t = float(cell.text) if _NUMBER.fullmatch(cell.text) else math.nan
        if not math.isfinite(t):
            self._report("I001.time", number, cell.col, cell=cell.text)
        elif abs(t) > MAX_TIME_S:
            self._report("I001.time_range", number, cell.col, cell=cell.text)
        elif t <= last:
            self._report("I001.time_order", number, cell.col, cell=cell.text, last=last)
        else:
            return t
        return None

    def _value(self, cell: _Cell, number: int, type_: InputType) -> JsonValue:
        value = _converted(cell.text, type_)
        if value is None:
            fields = {"cell": cell.text, "expected": _EXPECTED[type_]}
            self._report("I006.cell", number, cell.col, **fields)
        return value

    def cells(self, number: int, line: str) -> list[_Cell] | None:
        """Split a line at its commas; columns count from 1."""
        cells: list[_Cell] = []
        position = 0
        while match := _CELL.match(line, position):
            quoted, plain, end = match.groups()
            if quoted is None:
                text = plain.strip()
                blanks = len(plain) - len(plain.lstrip()) if text else 0
                cells.append(_Cell(text, position + blanks + 1))
            else:
                cells.append(_Cell(quoted.replace('""', '"'), match.start(1), quoted=True))
            if not end:
                return cells
            position = match.end()
        self._report("I001.quote", number, position + 1)
        return None


def _converted(text: str, type_: InputType) -> JsonValue:
    """Return the value of a cell, ``None`` when it cannot be read; NaN counts as unknown."""
    if type_ == "str":
        return text
    if type_.endswith("[]") or type_ == "state":
        return _several(text, type_)
    if text.lower() == "nan":
        return math.nan
    if type_ == "bool":
        return _TRUTH.get(text.lower())
    if type_ == "int":
        return int(text) if _WHOLE.fullmatch(text) else None
    return float(text) if _NUMBER.fullmatch(text) else None


def _several(text: str, type_: InputType) -> JsonValue:
    """Return the list of a cell; the name of a state is a text that is not a list of numbers."""
    if type_ == "bool[]" and text.lower() == "nan":
        return math.nan
    values = [_converted(part, "bool" if type_ == "bool[]" else "float") for part in text.split()]
    if type_ == "state" and (not values or None in values):
        return text
    return None if None in values else values
