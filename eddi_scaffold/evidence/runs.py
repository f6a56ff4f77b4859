"""Runs of conditions as rows of the file of test vectors."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping
from typing import Any

from eddi_scaffold.conditions.samples import OBJECT, Run


def rows_of(run: Run, results: Callable[[Any], Mapping[str, Any]]) -> list[list[Any]]:
    """Return rows of steps: the time, and what changes in values, results and ages.

    ``[until, period]`` are steps in which nothing changes.
    """
    rows: list[list[Any]] = []
    raws: Mapping[str, Any] = {}
    told: Mapping[str, Any] = {}
    ages: Mapping[str, int] = dict.fromkeys(run.steps[0].ages, 0)
    t = run.steps[0].t
    for given, value in zip(run.steps, run.results, strict=True):
        changed = {name: json_of(raw) for name, raw in _changes(raws, given.raws)}
        expected = results(value)
        row = [given.t, changed, dict(_changes(told, expected))]
        late = dict(_changes(ages, given.ages))
        period = given.t - t
        if changed or row[2] or late or period <= 0:
            rows.append([*row, late] if late else row)
        elif len(rows[-1]) == 2 and rows[-1][1] == period:
            rows[-1][0] = given.t
        else:
            rows.append([given.t, period])
        raws, told, ages, t = given.raws, expected, given.ages, given.t
    return rows


def _changes(before: Mapping[str, Any], now: Mapping[str, Any]) -> Iterator[tuple[str, Any]]:
    yield from (pair for pair in now.items() if before.get(pair[0], before) is not pair[1])


def json_of(raw: Any) -> Any:
    """Return a value as JSON says it."""
    if raw is OBJECT:
        return {"is": "object"}
    if isinstance(raw, dict):
        return {name: json_of(each) for name, each in raw.items()}
    if isinstance(raw, list):
        return [json_of(each) for each in raw]
    return {"is": str(raw)} if isinstance(raw, float) and not math.isfinite(raw) else raw
