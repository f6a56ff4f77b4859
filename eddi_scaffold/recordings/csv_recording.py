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
    error,
    has_errors,
    warning,
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
        EddiError: a problem is an error (I001 to I003, I005 to I009, I015).
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
        The recording, ``None`` when a problem is an error, and all problems (I001 to I009, I015).
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
            self._error("I001", "the file is empty: a header line with a column t is missing", 1, 1)
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
            message = "there are no rows below the header: nothing can be played"
            self._error("I015", message, header[0], 1)
        if self._errors > MAX_PROBLEMS:
            message = f"... and {self._errors - MAX_PROBLEMS} more problems from here on"
            self.problems.append(error("I009", message, Place(self._file, self._cut)))
        time_at = columns.index(TIME) if TIME in columns else -1
        inputs = tuple(name for k, name in enumerate(columns) if k != time_at)
        return Recording(inputs, tuple(rows))

    def _error(self, code: str, message: str, line: int, col: int, hint: str | None = None) -> None:
        self._errors += 1
        if self._errors <= MAX_PROBLEMS:
            self.problems.append(error(code, message, Place(self._file, line, col), hint))
        else:
            self._cut = self._cut or line

    def _columns(self, number: int, line: str) -> tuple[str, ...]:
        """Return the names of the columns; the first ``t`` is the time, also if an input is t."""
        cells = self._cells(number, line)
        names = tuple(cell.text for cell in cells)
        other = next((mark for mark in _OTHER_MARKS if mark in line), None)
        if len(names) == 1 and other is not None:
            message = f"cells are separated by {_OTHER_MARKS[other]}, commas are expected"
            self._error("I001", message, number, line.index(other) + 1, _POINT)
            return ()
        times = (
            one for one in cells if one.text.casefold() in _TIMES and one.text not in self._types
        )
        meant = None if TIME in names else next(times, None)
        if TIME not in names:
            at = meant.col if meant is not None else 1
            hint = f"write t in place of {meant.text}" if meant is not None else None
            self._error("I001", "the header has no column t (time in seconds)", number, at, hint)
        time_at = names.index(TIME) if TIME in names else -1
        seen: set[str] = set()
        others: Mapping[str, str] | None = None
        for k, cell in enumerate(cells):
            if k == time_at or cell is meant:
                continue
            if cell.text in seen or (cell.text == TIME and TIME not in self._types):
                self._error("I002", f"the column {cell.text!r} is repeated", number, cell.col)
            elif cell.text not in self._types:
                others = self._others() if others is None else others
                hint = others.get(cell.text) or did_you_mean(cell.text, self._types)
                hint = hint or f"columns are t and the inputs: {', '.join(self._types)}"
                self._error("I003", f"no input has the id {cell.text!r}", number, cell.col, hint)
            seen.add(cell.text)
        for name in self._types:
            if name not in seen:
                message = f"there is no column for the input {name!r}: it never gets a sample"
                self.problems.append(warning("I004", message, Place(self._file, number, 1)))
        return names

    def _row(self, number: int, line: str, columns: Sequence[str], last: float) -> Row | None:
        before = self._errors
        cells = self._cells(number, line)
        if len(cells) != len(columns):
            if self._errors == before:
                message = f"{len(cells)} cells, but the header has {len(columns)} columns"
                hint = _POINT if len(cells) > len(columns) else None
                self._error("I005", message, number, 1, hint)
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
            message = f"the time {cell.text!r} is not a number of seconds"
            self._error("I007", message, number, cell.col, _hint(cell))
            return None
        if abs(t) > MAX_TIME:
            message = f"the time {cell.text} is out of range: at most 9e9 seconds"
            hint = "t is in seconds, not in milliseconds or nanoseconds"
            self._error("I007", message, number, cell.col, hint)
            return None
        if t <= last:
            message = f"the time {cell.text} is not after the previous one, {last:g}"
            self._error("I008", message, number, cell.col)
            return None
        return t

    def _value(self, cell: _Cell, number: int, wanted: InputType) -> JsonValue:
        value = _converted(cell.text, wanted)
        if value is None:
            message = f"cannot read {cell.text!r}: expected {_EXPECTED[wanted]}"
            self._error("I006", message, number, cell.col, _hint(cell))
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
                hint = 'a quote inside is written twice (""), a cell ends on its line'
                message = "this quoted cell is not closed properly"
                self._error("I009", message, number, position + 1, hint)
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
