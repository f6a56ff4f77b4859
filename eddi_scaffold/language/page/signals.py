"""Example values for the variables of a text, so that its verdict can be seen over time."""

from __future__ import annotations

import math

from eddi_scaffold.language.analysis import Analysis
from eddi_scaffold.language.canonical import number_text
from eddi_scaffold.language.scope import Variable

MIN_ROWS, MAX_ROWS = 60, 600
_CELLS = 4000
"""Cells at most: the page takes the values back in a form of limited size."""


def example_signal(analysis: Analysis, rate: float | None) -> str:
    """Return a recording as CSV, some windows long: waves for numbers, slow changes for all else.

    In its last part one sample of each number is missing.
    """
    rows = _rows(analysis)
    lines = [",".join(["t", *(variable.name for variable in analysis.inputs)])]
    for row in range(rows):
        part = row / rows
        missing = row == rows * 4 // 5
        cells = [
            "nan" if missing and _kind(variable) == "number" else _cell(variable, part, k, analysis)
            for k, variable in enumerate(analysis.inputs)
        ]
        lines.append(",".join([number_text(round(row / (rate or 1.0), 9)), *cells]))
    return "\n".join(lines) + "\n"


def _rows(analysis: Analysis) -> int:
    assert analysis.form is not None
    longest: int = max((node.get("window", 0) for node in analysis.form["nodes"]), default=0)
    wanted: int = 6 * longest // max(1, analysis.form["period"])
    room = _CELLS // (len(analysis.inputs) + 1)
    return max(2, min(max(wanted, MIN_ROWS), MAX_ROWS, room))


def _kind(variable: Variable) -> str:
    return "number" if variable.type is None else variable.type.kind


def _cell(variable: Variable, part: float, number: int, analysis: Analysis) -> str:
    """Return the value at a part (0 to 1) of the recording."""
    if variable.type is not None and variable.type.enum:
        literals = analysis.enums[variable.type.enum]
        return literals[int(part * 3 * len(literals)) % len(literals)]
    if _kind(variable) == "bool":
        return "false" if (part * (3 + number)) % 1 < 0.15 else "true"
    low, high = variable.range or (0.0, 120.0)
    wave = 0.5 - 0.5 * math.cos(2 * math.pi * part * (2 + 0.5 * number))
    return number_text(round(low + (high - low) * min(1.0, 1.5 * wave), 3))
