"""Read the reference sample, and report clearly why a file is not one.

The file is what ``numpy.savetxt(name, a, delimiter=",")`` writes: a row is a sample, in time order.
"""

from __future__ import annotations

import math
import re
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from eddi_scaffold.common.files import Source, next_to, read_source
from eddi_scaffold.common.problems import EddiError, Place, Problem, plural, problem
from eddi_scaffold.kinds.safeml.scope import ReferenceSample, SafeMLSettings

MAX_BYTES = 512 * 1024 * 1024
_BLANKS = " \t\v\f"  # Characters allowed around a number, as in `float` for ASCII
_LINE_END = re.compile(r"\r\n|\r|\n")  # not splitlines(), which sees ends that editors do not


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
    """Read a reference sample, or what is wrong first (L004), at the row and column of a cell."""
    try:
        text = source.text("L004")
    except EddiError as refused:
        return None, list(refused.problems)
    rows: list[list[float]] = []
    for number, line in enumerate(_LINE_END.split(text), 1):
        stripped = line.strip(_BLANKS)
        if not stripped or stripped[0] == "#":
            continue
        cells = stripped.split(",")
        row = _numbers(cells)
        if row is None:
            column = next(k for k, cell in enumerate(cells, 1) if _numbers([cell]) is None)
            place, cell = Place(source.name, number, column), cells[column - 1].strip()[:40]
            fault = problem("L004.cell", place, row=number, column=column, text=cell)
        elif rows and len(row) != (width := len(rows[0])):
            place = Place(source.name, number, min(len(row), width) + 1)
            count = plural(len(row), "cell")
            fault = problem("L004.cells", place, row=number, cells=count, width=width)
        else:
            rows.append(row)
            continue
        # the line of the file is kept out: the column counts cells, not characters
        return None, [replace(fault, excerpt="")]
    if len(rows) < 2:
        return None, [problem("L004.empty", Place(source.name))]
    return ReferenceSample(source, np.array(rows, dtype=np.float64)), []


def _numbers(cells: Sequence[str]) -> list[float] | None:
    """Return the finite numbers of a row, ``None`` when a cell is none."""
    try:
        row = [float(cell) for cell in cells]
    except ValueError:
        return None
    # float() reads also 1_000 and digits of other scripts
    is_plain = all(cell.isascii() and "_" not in cell for cell in cells)
    return row if is_plain and all(map(math.isfinite, row)) else None
