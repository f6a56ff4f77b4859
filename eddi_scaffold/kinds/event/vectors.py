"""Test vectors of events: runs of samples, with the verdicts by definition."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import partial
from typing import TYPE_CHECKING, Any

from eddi_scaffold.conditions.samples import Drawing, in_turn
from eddi_scaffold.evidence.vectors import MOST_BYTES, MOST_INPUTS, run_row, text, vectors_file

if TYPE_CHECKING:
    from eddi_scaffold.program.input_expressions import BoundInput
    from eddi_scaffold.program.instructions import Program, Result


def event_vectors(program: Program, inputs: Sequence[BoundInput], about: Mapping[str, str]) -> str:
    """Return the content of ``vectors.json`` for the inputs of a monitor.

    ``about``: the file of the model and its digest.
    """
    if len(inputs) > MOST_INPUTS:
        return ""
    factors = {input_.id: input_.factor for input_ in inputs if input_.factor is not None}
    drawings = [Drawing(program, number, factors) for number in range(len(program.results))]
    lists: dict[str, list[Any]] = {"runs": []}
    size = len(vectors_file(about, inputs, lists, complete=False)) + 1000
    for number, run in in_turn(drawings):
        row = run_row(run, partial(_results, program.results[number]))
        size += len(text(row).encode()) + 10
        if size > MOST_BYTES:
            break
        lists["runs"].append(row)
    missed = [drawing.missed for drawing in drawings if drawing.missed]
    lists["missed"] = missed if size + len(text(missed).encode()) < MOST_BYTES else []
    complete = size <= MOST_BYTES and not missed
    return vectors_file(about, inputs, lists, complete=complete)


def _results(result: Result, verdict: bool | None) -> dict[str, bool | None]:
    is_active = verdict is True or (result.hazard and verdict is None)
    return {result.id: verdict, f"{result.id} is active": is_active}
