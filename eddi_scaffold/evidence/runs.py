"""Runs of conditions as rows of the file of test vectors."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from typing import Any

from eddi_scaffold.conditions.samples import OBJECT, Run


def rows_of(run: Run, results: Callable[[Any], Mapping[str, Any]]) -> list[list[Any]]:
    """Return a row for each step: its time, what changes in values, results and ages."""
    rows: list[list[Any]] = []
    raws: dict[str, Any] = {}
    ages: dict[str, int] = {}
    result: Any = OBJECT
    for given, value in zip(run.steps, run.results, strict=True):
        row = [
            given.t,
            {
                name: json_of(raw)
                for name, raw in given.raws.items()
                if name not in raws or raws[name] is not raw
            },
        ]
        row.append({} if value is result else results(value))
        late = {name: age for name, age in given.ages.items() if ages.get(name, 0) != age}
        rows.append([*row, late] if late else row)
        raws, ages, result = {**given.raws}, {**given.ages}, value
    return rows


def json_of(raw: Any) -> Any:
    """Return a value as JSON says it."""
    if raw is OBJECT:
        return {"is": "object"}
    if isinstance(raw, list):
        return [json_of(each) for each in raw]
    return {"is": str(raw)} if isinstance(raw, float) and not math.isfinite(raw) else raw
