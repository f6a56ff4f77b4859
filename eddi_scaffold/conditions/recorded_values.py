"""Events on recorded values, as a monitor sees them: a sample holds until its TIMEOUT."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Mapping
from typing import Any, Literal

from eddi_scaffold.conditions.analysis import Analysis
from eddi_scaffold.conditions.syntax import is_list_path
from eddi_scaffold.program.instructions import BOOL
from eddi_scaffold.program.running import build_engine

Verdict = bool | float | None
"""A truth value or a number; None is UNKNOWN."""
Column = Literal["float", "bool", "str", "float[]", "bool[]"]
_COLUMNS: Mapping[str, Column] = {
    "number": "float",
    "bool": "bool",
    "enum": "str",
    "text": "str",
    "number[]": "float[]",
    "bool[]": "bool[]",
    "text[]": "str",
}


def columns(analysis: Analysis) -> dict[str, Column]:
    """Return variable -> type of its column in a recording."""
    return {
        variable.name: _COLUMNS[variable.type.kind + ("[]" if is_list_path(variable.name) else "")]
        for variable in analysis.inputs
        if variable.type is not None
    }


def play(
    analysis: Analysis, rows: Iterable[tuple[float, Mapping[str, Any]]]
) -> Iterator[tuple[float, dict[str, Verdict]]]:
    """Yield (time in seconds, event -> verdict) for each row of a recording.

    Args:
        analysis: of a text without errors.
        rows: time in seconds, and the new samples by variable; those that are not there hold.
    """
    assert analysis.form is not None
    engine = build_engine(analysis.form)
    names = [input_.name for input_ in engine.sampling.inputs]
    values: dict[str, Any] = dict.fromkeys(names)
    stamps: dict[str, int | None] = dict.fromkeys(names)
    for t, samples in rows:
        now = round(t * 1e9)
        for name in names:
            if name in samples:
                values[name], stamps[name] = samples[name], now
        found = engine.step(now, [values[name] for name in names], [stamps[name] for name in names])
        yield (
            t,
            {
                result.id: verdict(value, engine.program.operations[result.operation].type)
                for result, value in zip(engine.program.results, found, strict=True)
            },
        )


def verdict(value: float, kind: str) -> Verdict:
    """Return a value of the engine as Python and JSON know it."""
    if kind == BOOL:
        return None if value == 1 else value == 2
    return None if math.isnan(value) else value
