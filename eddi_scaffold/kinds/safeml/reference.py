"""Read the reference sample, and report clearly why a file is not one.

The file is what ``numpy.savetxt(name, a, delimiter=",")`` writes: a row is a sample, in time order.
"""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import replace
from itertools import islice

import numpy as np

from eddi_scaffold.common.files import Source, next_to, read_source
from eddi_scaffold.common.problems import EddiError, Place, Problem, plural, problem
from eddi_scaffold.kinds.safeml.scope import ReferenceSample, Rows, SafeMLSettings

MAX_BYTES = 512 * 1024 * 1024
MAX_PROBLEMS = 20  # that are listed of one file
_BLANKS = " \t\v\f"  # Characters allowed around a number, as in `float` for ASCII
_LINE_END = re.compile(r"\r\n|\r|\n")  # not splitlines(), which sees ends that editors do not
Lines = Sequence[tuple[int, str]]
"""Number (from 1) and text of each line that is neither empty nor a comment (``#``)."""


def read_named(file: str, settings: SafeMLSettings) -> tuple[ReferenceSample | None, list[Problem]]:
    """Read the reference that the settings in a file name, relative to it."""
    name = settings.reference_sample_file
    try:
        return read_reference(read_source(next_to(file, name), MAX_BYTES))
    except EddiError as failure:
        reasons = "; ".join(fault.message for fault in failure.problems)
        hints = [fault.hint for fault in failure.problems if fault.code == "F003"]
        hint = hints[0] if hints else "it is looked for next to this file"
        place = settings.place("reference_sample_file")
        return None, [problem("L004.file", place, hint=hint, name=name, reasons=reasons)]


def read_reference(source: Source) -> tuple[ReferenceSample | None, list[Problem]]:
    """Read a reference sample; a place of a problem (L004) is the row and the column of a cell."""
    try:
        text = source.text("L004")
    except EddiError as refused:
        return None, list(refused.problems)
    stripped = ((k, line.strip(_BLANKS)) for k, line in enumerate(_LINE_END.split(text), 1))
    lines = [(number, line) for number, line in stripped if line and line[0] != "#"]
    rows = [_numbers(line.split(",")) for _, line in lines]
    if None in rows or len({len(row or ()) for row in rows}) != 1:
        faults = _faults_of_cells(lines)
    else:
        faults = _faults_of_values(values := np.array(rows, dtype=np.float64), lines)
    # The line of the file is kept out: the column counts cells, not characters.
    problems = [
        replace(fault, place=replace(fault.place, file=source.name), excerpt="")
        if fault.place.line
        else replace(fault, place=Place(source.name))
        for fault in islice(faults, MAX_PROBLEMS)
    ]
    return (None if problems else ReferenceSample(source, values)), problems


def _numbers(cells: Sequence[str]) -> list[float] | None:
    """Return the numbers of a row, ``None`` when a cell is none."""
    try:
        row = [float(cell) for cell in cells]
    except ValueError:
        return None
    # float() reads also 1_000 and digits of other scripts
    is_plain = all(cell.isascii() and "_" not in cell for cell in cells)
    return row if is_plain else None


def _faults_of_values(values: Rows, lines: Lines) -> Iterator[Problem]:
    bad = np.argwhere(~np.isfinite(values))
    first = lines[0][0]
    if len(bad):
        row, column = lines[int(bad[0][0])][0], int(bad[0][1]) + 1
        number, place = plural(len(bad), "cell"), Place("", row, column)
        yield problem("L004.not_finite", place, number=number, row=row, column=column)
    if len(values) < 2:
        yield problem("L004.one_row", Place("", first))


def _faults_of_cells(lines: Lines) -> Iterator[Problem]:
    """Yield rows of another length than most, and in each column the first that is no number."""
    if not lines:
        yield problem("L004.empty")
        return
    widths = Counter(line.count(",") + 1 for _, line in lines)
    width, wrong = widths.most_common(1)[0][0], set[int]()
    for row, line in lines:
        cells = line.split(",")
        if len(cells) != width:
            place, count = Place("", row, min(len(cells), width) + 1), plural(len(cells), "cell")
            yield problem("L004.cells", place, row=row, cells=count, width=width)
            continue
        for column, cell in enumerate(cells, 1):
            if column not in wrong and _numbers([cell]) is None:
                wrong.add(column)
                place, shown = Place("", row, column), cell.strip()[:40]
                yield problem("L004.cell", place, row=row, column=column, text=shown)
