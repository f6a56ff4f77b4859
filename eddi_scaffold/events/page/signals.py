"""Example values for the variables of a text, so that its verdict can be seen over time."""

from __future__ import annotations

import math

from eddi_scaffold.events.analysis import Analysis
from eddi_scaffold.events.canonical import number_text
from eddi_scaffold.events.scope import Variable

ROWS = 60


def example_signal(analysis: Analysis, rate: float | None) -> str:
    """Return a recording as CSV: waves for numbers, slow changes for all else, one hole."""
    step = 1 / (rate or 1.0)
    lines = [",".join(["t", *(variable.name for variable in analysis.variables)])]
    for row in range(ROWS):
        cells = [
            "nan"
            if row == ROWS // 2 and variable.type and variable.type.kind == "number"
            else _cell(variable, row, number, analysis)
            for number, variable in enumerate(analysis.variables)
        ]
        lines.append(",".join([number_text(round(row * step, 9)), *cells]))
    return "\n".join(lines) + "\n"


def _cell(variable: Variable, row: int, number: int, analysis: Analysis) -> str:
    turn = row // (7 + 3 * number)
    if variable.type is not None and variable.type.enum:
        literals = analysis.enums[variable.type.enum]
        return literals[turn % len(literals)]
    if variable.type is not None and variable.type.kind == "bool":
        return "true" if turn % 3 else "false"
    low, high = variable.range or (0.0, 120.0)
    wave = 0.5 - 0.5 * math.cos(row / (5 + number))
    return number_text(round(low + (high - low) * wave, 3))
