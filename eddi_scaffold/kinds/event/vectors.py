"""Test vectors of events: runs of samples, with the verdicts by definition."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from functools import partial
from typing import TYPE_CHECKING, Any

from eddi_scaffold.conditions.samples import Drawing, in_turn
from eddi_scaffold.evidence.vectors import MOST_BYTES, MOST_INPUTS, run_row, text, vectors_file

if TYPE_CHECKING:
    from eddi_scaffold.program.input_expressions import BoundInput
    from eddi_scaffold.program.instructions import Program, Result


def event_vectors(
    program: Program,
    accepts: Sequence[Sequence[str]],
    units: Mapping[str, str],
    inputs: Sequence[BoundInput],
    about: Mapping[str, str],
) -> str:
    """Return the content of ``vectors.json``.

    Args:
        program: the events.
        accepts: the words by which each of them accepts silence.
        units: input -> its unit.
        inputs: of the monitor.
        about: the file of the model and its digest.
    """
    if len(inputs) > MOST_INPUTS:
        return ""
    factors = {input_.id: input_.factor for input_ in inputs if input_.factor is not None}
    drawings = [Drawing(program, number, factors) for number in range(len(program.results))]
    lists: dict[str, list[Any]] = {
        "tables": [*_tables(program, drawings, accepts, units, inputs).items()],
        "runs": [],
    }
    size = len(vectors_file(about, inputs, lists, complete=False)) + 1000
    for number, run in in_turn(drawings):
        row = run_row(run, partial(_results, program.results[number]))
        size += len(text(row).encode()) + 10
        if size > MOST_BYTES:
            break
        lists["runs"].append(row)
    complete = size <= MOST_BYTES and all(drawing.complete for drawing in drawings)
    missed = [drawing.missed for drawing in drawings if drawing.missed]
    missed = missed if size + len(text(missed)) < MOST_BYTES else []
    return vectors_file(about, inputs, {**lists, "missed": missed}, complete=complete)


def _results(result: Result, verdict: bool | None) -> dict[str, bool | None]:
    is_active = verdict is True or (result.hazard and verdict is None)
    return {result.id: verdict, f"{result.id} is active": is_active}


def _tables(
    program: Program,
    drawings: Sequence[Drawing],
    accepts: Sequence[Sequence[str]],
    units: Mapping[str, str],
    inputs: Sequence[BoundInput],
) -> dict[str, list[Any]]:
    """Return what the monitor has to say of itself."""
    names = [input_.id for input_ in inputs]
    events = [
        [result.id, result.hazard, sorted(map(names.index, drawing.pools)), [*words]]
        for result, drawing, words in zip(program.results, drawings, accepts, strict=True)
    ]
    types: list[Any] = [""] * len(names)
    limits: list[Any] = [None] * len(names)
    reductions: list[int] = []
    for read in program.reads:
        for part in (read,) if read.reduction is None else read.reduction.inputs:
            type_ = "list" if getattr(part, "is_list", False) else part.type
            types[names.index(part.name)] = [*read.literals] if type_ == "enum" else type_
        if read.reduction is not None:
            reductions.append(names.index(read.reduction.inputs[0].name))
        elif read.type == "number" and not read.text:
            ends = read.range or (-math.inf, math.inf)
            shown = (
                "-Infinity" if end == -math.inf else "Infinity" if end == math.inf else end
                for end in ends
            )
            limits[names.index(read.name)] = [*shown, read.infinite]
        elif read.text:
            types[names.index(read.name)] = "text"
    shown_units = [units.get(name, "") for name in names] if units else []
    return {
        "events": events,
        "types": types,
        "limits": limits,
        "units": shown_units,
        "reductions": reductions,
    }
