"""The file of test vectors, ``test/vectors.json`` of a package; ``eddi_runtime.testing`` runs it.

A value that JSON cannot say is ``{"is": "nan"}``, also ``inf``, ``-inf``, ``object``, ``absent``.
"""

from __future__ import annotations

import json
import math
import operator
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from functools import partial
from typing import TYPE_CHECKING, Any, NamedTuple

if TYPE_CHECKING:
    from eddi_scaffold.program.input_expressions import BoundInput

MOST_BYTES = 64 * 1024
MOST_INPUTS = 150  # the table of more would be too long
text = partial(json.dumps, ensure_ascii=False, allow_nan=False)
"""A value as JSON on one line."""


class TooMuchError(Exception):
    """More work than vectors are worth."""


class Step(NamedTuple):
    """A step of a run: what changes in its inputs and in the results that must come out."""

    t_ns: int
    inputs: Mapping[str, Any]  # input id -> value
    results: Mapping[str, Any]  # name in the monitor's ``series`` -> value


class Run(NamedTuple):
    """Steps of a new monitor, of which all inputs are unknown at first."""

    name: str  # what is tested, and where it stands in the model
    steps: Sequence[Step]  # or rows of such


def age_row(
    input_: BoundInput, given: object, fresh: Mapping[str, Any], late: Mapping[str, Any]
) -> list[object] | None:
    """Return the row of an input with an age limit: results at it, and at the next double.

    ``given``: the values of all inputs.
    """
    age = input_.max_age
    is_watched = input_.requires and input_.expression is None
    if not is_watched or not isinstance(age, int | float):
        return None
    return [input_.id, given, [age, fresh], [math.nextafter(age, math.inf), late]]


def age_rows(
    inputs: Sequence[BoundInput],
    given: Mapping[str, Any],
    results: Callable[[Mapping[str, Any]], Mapping[str, Any] | None],
) -> Iterator[list[object]]:
    """Yield the row of each input with an age limit; others of the same message age as well.

    ``results``: those of a step with such values, ``None`` where they depend on rounding.
    """
    ages = {of.id: of.max_age if isinstance(of.max_age, float) else math.inf for of in inputs}
    for input_ in inputs:
        also = [of.id for of in inputs if {*of.requires} & {*input_.requires}]
        ends = [
            results({**given, **{id_: None for id_ in also if is_late(ages[id_], ages[input_.id])}})
            for is_late in (operator.lt, operator.le)
        ]
        fresh, late = ends
        row = age_row(input_, given, fresh, late) if fresh and late else None
        yield from [row] if row else []


def changed(before: Mapping[str, Any], after: Mapping[str, Any]) -> dict[str, Any]:
    """Return what is new, or of another type."""
    pairs = after.items()
    return {k: v for k, v in pairs if k not in before or text(before[k]) != text(v)}


def fitting_file(
    about: Mapping[str, str],
    inputs: Sequence[BoundInput],
    rows: Iterable[Run | list[object]],
    *,
    complete: bool,
) -> str:
    """Return the file of runs and rows of ages, without those that are too much; may be empty."""
    lists: dict[str, list[object]] = {"ages": [], "runs": []}
    size = len(vectors_file(about, inputs, {}, complete=True))
    try:
        for row in rows:
            length = len(text(row).encode()) + 5
            complete = complete and size + length < MOST_BYTES
            if size + length < MOST_BYTES:
                size += length
                lists["runs" if isinstance(row, Run) else "ages"].append(row)
    except TooMuchError:
        complete = False
    return vectors_file(about, inputs, lists, complete=complete) if lists["runs"] else ""


def vectors_file(
    about: Mapping[str, Any],
    inputs: Sequence[BoundInput],
    lists: Mapping[str, Sequence[object]],
    *,
    complete: bool,
    steps: int = 1,
) -> str:
    """Return the content of the file.

    ``about``: the file of the model, its digest, and rows of inputs that an expression computes;
    ``lists``: ``runs``, ``ages``, and what the kind has of its own; ``steps`` for a verdict.
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


def run_row(run: Any, results: Callable[[Any], Mapping[str, Any]]) -> Run:
    """Return the run of a condition: in each step what changes.

    ``[until, period]`` are steps in which nothing changes; a fourth element are ages.
    """
    rows: list[Any] = []
    t = run.steps[0].t
    before: list[Mapping[str, Any]] = [{}, {}, dict.fromkeys(run.steps[0].ages, 0)]
    for given, result in zip(run.steps, run.results, strict=True):
        now, period = [as_json(given.values), results(result), given.ages], given.t - t
        changes = [*map(changed, before, now)]
        if any(changes) or period <= 0:
            rows.append([given.t, *(changes if changes[2] else changes[:2])])
        elif len(rows[-1]) == 2 and rows[-1][1] == period:
            rows[-1][0] = given.t
        else:
            rows.append([given.t, period])
        before, t = now, given.t
    return Run(run.shows, rows)


def as_json(raw: Any) -> Any:
    """Return a value as JSON says it."""
    if isinstance(raw, list):
        return [*map(as_json, raw)]
    if isinstance(raw, dict):
        return {key: as_json(value) for key, value in raw.items()}
    if isinstance(raw, float) and not math.isfinite(raw):
        return {"is": str(raw)}
    return {"is": "object"} if type(raw) is object else raw
