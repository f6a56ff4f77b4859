"""The file of test vectors, ``test/vectors.json`` of a package; ``eddi_runtime.testing`` runs it.

A value that JSON cannot say is ``{"is": "nan"}``, also ``inf``, ``-inf``, ``object``, ``absent``.
"""

from __future__ import annotations

import json
import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from functools import partial
from typing import TYPE_CHECKING, Any, NamedTuple

if TYPE_CHECKING:
    from eddi_scaffold.program.input_expressions import BoundInput

MOST_BYTES = 64 * 1024
MOST_INPUTS = 150  # the table of more would be too long
text = partial(json.dumps, ensure_ascii=False, allow_nan=False)
"""A value as JSON on one line."""


class Step(NamedTuple):
    """A step of a run: what changes in its inputs and in the results that must come out."""

    t_ns: int
    inputs: Mapping[str, Any]  # input id -> value
    results: Mapping[str, Any]  # name in the monitor's ``series`` -> value


class Run(NamedTuple):
    """Steps of a new monitor, of which all inputs are unknown at first."""

    name: str  # what is tested, and where it stands in the model
    steps: Sequence[Step]


def age_row(
    input_: BoundInput, given: object, fresh: Mapping[str, Any], late: Mapping[str, Any]
) -> list[object] | None:
    """Return the row of an input with an age limit: results at it, and at the next double.

    ``given``: the values of all inputs.
    """
    age = input_.max_age
    if not isinstance(age, int | float) or input_.expression is not None:
        return None
    return [input_.id, given, [age, fresh], [math.nextafter(age, math.inf), late]]


def vectors_file(
    about: Mapping[str, Any],
    inputs: Sequence[BoundInput],
    lists: Mapping[str, Sequence[object]],
    *,
    complete: bool,
    steps: int = 1,
) -> str:
    """Return the content of the file.

    Args:
        about: the file of the model, its digest, and rows of inputs that an expression computes.
        inputs: of the monitor.
        lists: ``runs``, ``ages``, and what the kind has of its own.
        complete: whether nothing that decides is left out.
        steps: how many a verdict needs.
    """
    topics = {name: topic for input_ in inputs for name, topic in input_.topics.items()}
    head = {"format": 1, **about, "complete": complete and about.get("complete", True)}
    computed = {key: head.pop(key) for key in ("expressions",) if key in head}
    head |= {"topics": topics, "steps": steps}
    lines = [f'"{key}": {text(value)}' for key, value in head.items()]
    table = [[*_input_row(input_)] for input_ in inputs]
    rows = {"inputs": table, **computed, "runs": (), "ages": (), **lists}
    for key, items in rows.items():
        lines.append(f'"{key}": [{",".join(f"{chr(10)}  {text(item)}" for item in items)}]')
    return "{" + ",\n".join(lines) + "}\n"


def _input_row(input_: BoundInput) -> Iterator[object]:
    """Yield what the table of inputs has of an input."""
    factor = None if input_.factor is None else [*input_.factor]
    yield from (input_.id, input_.attribute, [*input_.requires], input_.max_age, factor)
    yield from (input_.default, input_.every_message, input_.expression is not None)
    yield from ([*input_.accepts], [[*claim] for claim in input_.claims])


def run_row(run: Any, results: Callable[[Any], Mapping[str, Any]]) -> list[object]:
    """Return the row of a run of a condition: in each step what changes.

    ``[until, period]`` are steps in which nothing changes; a fourth element are ages.
    """
    rows: list[list[Any]] = []
    values: Mapping[str, Any] = {}
    told: Mapping[str, Any] = {}
    ages: Mapping[str, int] = dict.fromkeys(run.steps[0].ages, 0)
    t = run.steps[0].t
    for given, result in zip(run.steps, run.results, strict=True):
        expected, period = results(result), given.t - t
        pairs = (values, given.values), (told, expected), (ages, given.ages)
        changes = [
            {name: _said(raw) for name, raw in now.items() if before.get(name, before) is not raw}
            for before, now in pairs
        ]
        if any(changes) or period <= 0:
            rows.append([given.t, *(changes if changes[2] else changes[:2])])
        elif len(rows[-1]) == 2 and rows[-1][1] == period:
            rows[-1][0] = given.t
        else:
            rows.append([given.t, period])
        values, told, ages, t = given.values, expected, given.ages, given.t
    return [run.shows, rows]


def _said(raw: Any) -> Any:
    """Return a value as JSON says it."""
    if isinstance(raw, list):
        return [*map(_said, raw)]
    if isinstance(raw, float) and not math.isfinite(raw):
        return {"is": str(raw)}
    return {"is": "object"} if type(raw) is object else raw
