"""Recorded inputs: a CSV file with a column ``t`` (seconds) and one column per input.

An empty cell means that no new sample came: the last one holds until it is older than the input's
``max_age``. Which values count is decided by the monitor and ``EDDIInputBase``, as on the robot.
"""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from decimal import Decimal
from typing import TYPE_CHECKING, Any

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
"""Errors that are listed of one file; a wrong column would else be reported for every row."""
MAX_TIME = 9e9
"""Seconds, 285 years: a monitor counts nanoseconds in 64 bits."""

_NUMBER = re.compile(r"[-+]?(\d+(\.\d*)?|\.\d+)([eE][-+]?\d+)?|[-+]?inf", re.ASCII)
_WHOLE = re.compile(r"[-+]?\d{1,400}", re.ASCII)
_TRUTH = {"true": True, "1": True, "false": False, "0": False}
Others = Callable[[], Mapping[str, str]]
_TIMES = ("time", "times", "timestamp", "stamp", "sec", "secs", "seconds", "t_s", "t [s]")
"""Names of the column t in the recordings of others."""
_OTHER_MARKS = {";": "semicolons", "\t": "tabs"}
_POINT = "numbers have a decimal point, commas separate cells"
_EXPECTED: Mapping[str, str] = {
    "bool": "true, false, 1, 0, or nan for unknown",
    "float": "a number, or nan for unknown",
    "int": "a whole number, or nan for unknown",
    "str": "a text",
    "state": "a state, or numbers with blanks between them",
    "float[]": "numbers with blanks between them",
    "bool[]": "true, false, 1, 0 or nan with blanks between them",
}


@dataclass(frozen=True)
class Row:
    """One line of a recording.

    Attributes:
        t: time in seconds.
        samples: input id -> new sample; inputs without one are left out.
        line: line in the file, counted from 1.
    """

    t: float
    samples: Mapping[str, JsonValue]
    line: int

    @property
    def t_ns(self) -> int:
        """The time in nanoseconds: of the decimal number in the file, not of its binary form."""
        return round(Decimal(repr(self.t)).scaleb(9))


@dataclass(frozen=True)
class Recording:
    """A recording that was read without errors.

    Attributes:
        inputs: ids of the inputs it has a column for, in the order of the columns.
        rows: in the order of time.
    """

    inputs: tuple[str, ...]
    rows: tuple[Row, ...]


@dataclass(frozen=True)
class Sample:
    """One message of a recording.

    Attributes:
        t: nanoseconds.
        topic: full name of a topic; of a CSV file, id of an input.
    """

    t: int
    topic: str
    message: Any


@dataclass(frozen=True)
class Tape:
    """What was recorded; times are nanoseconds.

    Attributes:
        start: where it begins.
        end: where it ends.
        samples: in the order of time.
        rows: times at which something was written down, also if no sample came.
    """

    start: int
    end: int
    samples: tuple[Sample, ...]
    rows: tuple[int, ...] = ()


def tape_of(recording: Recording) -> Tape:
    """Return the rows of a CSV file."""
    rows = tuple(row.t_ns for row in recording.rows)
    samples = tuple(
        Sample(row.t_ns, name, value)
        for row in recording.rows
        for name, value in row.samples.items()
    )
    return Tape(rows[0], rows[-1], samples, rows)


def read_tape(
    source: Source, types: Mapping[str, InputType], others: Others = dict
) -> tuple[Tape, list[Problem]]:
    """Read the values of inputs.

    Args:
        source: as for ``read_recording``.
        types: as for ``read_recording``.
        others: as for ``read_recording``.

    Returns:
        The recording, and warnings.

    Raises:
        EddiError: a problem is an error (I001, I003).
    """
    recording, problems = read_recording(source, types, others)
    if recording is None:
        raise EddiError(*problems)
    return tape_of(recording), problems


@dataclass(frozen=True)
class _Cell:
    text: str
    col: int
    quoted: bool = False


def read_recording(
    source: Source, types: Mapping[str, InputType], others: Others = dict
) -> tuple[Recording | None, list[Problem]]:
    """Read a recording.

    Args:
        source: the CSV file, UTF-8, comma-separated, cells quoted by ``"`` where needed.
        types: input id -> type of its values; other columns than these and ``t`` are errors.
        others: returns what to do with inputs that others than these monitors have, by id; it is
            called where a column is not known.

    Returns:
        The recording, ``None`` when a problem is an error, and all problems (I001).
    """
    try:
        text = source.text("I001")
    except EddiError as refused:
        return None, list(refused.problems)
    reader = _Reader(source.name, types, others)
    lines = [line.removesuffix("\r") for line in text.split("\n")]
    recording = reader.read(lines)
    problems = with_excerpts(reader.problems, "\n".join(lines))
    return (None if has_errors(problems) else recording), problems


class _Reader:
    """Reads the lines of one file and collects what is wrong with them."""

    def __init__(self, file: str, types: Mapping[str, InputType], others: Others) -> None:
        self.problems: list[Problem] = []
        self._file = file
        self._types = types
        self._others = others
        self._errors = 0
        self._cut: int | None = None

    def read(self, lines: Sequence[str]) -> Recording:
        filled = [(number, line) for number, line in enumerate(lines, 1) if line.strip()]
        if not filled:
            self._report("I001.empty", 1, 1)
            return Recording((), ())
        header, *rest = filled
        columns = self._columns(*header)
        rows: list[Row] = []
        last = -math.inf
        for number, line in rest if TIME in columns else ():
            row = self._row(number, line, columns, last)
            if row is not None:
                rows.append(row)
                last = row.t
        if not rest and not self._errors:
            self._report("I001.no_rows", header[0], 1)
        if self._errors > MAX_PROBLEMS:
            self.problems.append(
                problem(
                    "I001.more", Place(self._file, self._cut), number=self._errors - MAX_PROBLEMS
                )
            )
        time_at = columns.index(TIME) if TIME in columns else -1
        inputs = tuple(name for k, name in enumerate(columns) if k != time_at)
        return Recording(inputs, tuple(rows))

    def _report(
        self, case: str, line: int, col: int, /, *, hint: str | None = None, **fields: object
    ) -> None:
        self._errors += 1
        if self._errors <= MAX_PROBLEMS:
            place = Place(self._file, line, col)
            self.problems.append(problem(case, place, hint=hint, **fields))
        else:
            self._cut = self._cut or line

    def _columns(self, number: int, line: str) -> tuple[str, ...]:
        """Return the names of the columns; the first ``t`` is the time, also if an input is t."""
        cells = self._cells(number, line)
        names = tuple(cell.text for cell in cells)
        other = next((mark for mark in _OTHER_MARKS if mark in line), None)
        if len(names) == 1 and other is not None:
            self._report(
                "I001.separator",
                number,
                line.index(other) + 1,
                hint=_POINT,
                actual=_OTHER_MARKS[other],
            )
            return ()
        times = (
            one for one in cells if one.text.casefold() in _TIMES and one.text not in self._types
        )
        meant = None if TIME in names else next(times, None)
        if TIME not in names:
            at = meant.col if meant is not None else 1
            hint = f"write t in place of {meant.text}" if meant is not None else None
            self._report("I001.no_time", number, at, hint=hint)
        time_at = names.index(TIME) if TIME in names else -1
        seen: set[str] = set()
        others: Mapping[str, str] | None = None
        for k, cell in enumerate(cells):
            if k == time_at or cell is meant:
                continue
            if cell.text in seen or (cell.text == TIME and TIME not in self._types):
                self._report("I001.duplicate_column", number, cell.col, column=cell.text)
            elif cell.text not in self._types:
                others = self._others() if others is None else others
                hint = others.get(cell.text) or did_you_mean(cell.text, self._types)
                hint = hint or f"columns are t and the inputs: {', '.join(self._types)}"
                self._report("I003.unknown_column", number, cell.col, hint=hint, column=cell.text)
            seen.add(cell.text)
        for name in self._types:
            if name not in seen:
                self.problems.append(
                    problem("I004.no_column", Place(self._file, number, 1), name=name)
                )
        return names

    def _row(self, number: int, line: str, columns: Sequence[str], last: float) -> Row | None:
        before = self._errors
        cells = self._cells(number, line)
        if len(cells) != len(columns):
            if self._errors == before:
                hint = _POINT if len(cells) > len(columns) else None
                self._report(
                    "I001.cells", number, 1, hint=hint, actual=len(cells), expected=len(columns)
                )
            return None
        time_at = columns.index(TIME)
        t = self._time(cells[time_at], number, last)
        samples = {
            name: self._value(cell, number, self._types[name])
            for k, (name, cell) in enumerate(zip(columns, cells, strict=True))
            if k != time_at and name in self._types and (cell.text or cell.quoted)
        }
        return Row(t, samples, number) if t is not None else None

    def _time(self, cell: _Cell, number: int, last: float) -> float | None:
        t = float(cell.text) if _NUMBER.fullmatch(cell.text) else math.nan
        if not math.isfinite(t):
            self._report("I001.time", number, cell.col, hint=_hint(cell), cell=cell.text)
            return None
        if abs(t) > MAX_TIME:
            self._report("I001.time_range", number, cell.col, cell=cell.text)
            return None
        if t <= last:
            self._report("I001.time_order", number, cell.col, cell=cell.text, last=last)
            return None
        return t

    def _value(self, cell: _Cell, number: int, wanted: InputType) -> JsonValue:
        value = _converted(cell.text, wanted)
        if value is None:
            self._report(
                "I006.cell",
                number,
                cell.col,
                hint=_hint(cell),
                cell=cell.text,
                expected=_EXPECTED[wanted],
            )
        return value

    def _cells(self, number: int, line: str) -> list[_Cell]:
        """Split a line at its commas; columns count from 1."""
        if '"' not in line:
            cells, start = [], 0
            for part in line.split(","):
                cells.append(_plain(part, start))
                start += len(part) + 1
            return cells
        return self._quoted_cells(number, line)

    def _quoted_cells(self, number: int, line: str) -> list[_Cell]:
        cells, position = [], 0
        pattern = re.compile(r'(?:\s*"((?:[^"]|"")*)"\s*|([^",]*))(,|$)')
        while True:
            match = pattern.match(line, position)
            if match is None:
                self._report("I001.quote", number, position + 1)
                return []
            quoted, plain, end = match.groups()
            if quoted is None:
                cells.append(_plain(plain, position))
            else:
                cells.append(_Cell(quoted.replace('""', '"'), match.start(1), quoted=True))
            if not end:
                return cells
            position = match.end()


def _plain(part: str, start: int) -> _Cell:
    """Return a cell without quotes, the blanks around it cut; ``start`` counts from 0."""
    text = part.strip()
    return _Cell(text, start + (len(part) - len(part.lstrip()) if text else 0) + 1)


def _hint(cell: _Cell) -> str | None:
    if cell.text.endswith("%"):
        return "write the number alone: 80 where the unit is percent, 0.8 where it is fraction"
    return _POINT if "," in cell.text else None


def _converted(text: str, wanted: InputType) -> JsonValue:
    """Return the value of a cell, ``None`` when it cannot be read; NaN counts as unknown."""
    if wanted == "str":
        return text
    if wanted.endswith("[]") or wanted == "state":
        return _several(text, wanted)
    if text.lower() == "nan":
        return math.nan
    if wanted == "bool":
        return _TRUTH.get(text.lower())
    if wanted == "int":
        return int(text) if _WHOLE.fullmatch(text) else None
    return float(text) if _NUMBER.fullmatch(text) else None


def _several(text: str, wanted: InputType) -> JsonValue:
    """Return the list of a cell; the name of a state is a text that is not a list of numbers."""
    if wanted == "bool[]" and text.lower() == "nan":
        return math.nan
    one: InputType = "bool" if wanted == "bool[]" else "float"
    values = [_converted(part, one) for part in text.split()]
    if wanted == "state" and (not values or None in values):
        return text
    return None if None in values else values
