"""Test vectors of events: runs of samples, with the verdicts by definition."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from functools import partial
from typing import TYPE_CHECKING

from eddi_scaffold.conditions.samples import Drawing, in_turn
from eddi_scaffold.evidence import vectors

if TYPE_CHECKING:
    from eddi_scaffold.program.input_expressions import BoundInput
    from eddi_scaffold.program.instructions import Program, Result


def event_vectors(program: Program, inputs: Sequence[BoundInput], about: Mapping[str, str]) -> str:
    """Return the content of ``vectors.json`` for the inputs of a monitor.

    ``about``: the file of the model and its digest.
    """
    if len(inputs) > vectors.MOST_INPUTS:
        return ""
    factors = {input_.id: input_.factor for input_ in inputs if input_.factor is not None}
    return vectors.fitting_file(about, inputs, _runs(program, factors), complete=True)


def _runs(program: Program, factors: Mapping[str, tuple[int, int]]) -> Iterator[vectors.Run]:
    drawings = [Drawing(program, number, factors) for number in range(len(program.results))]
    for number, run in in_turn(drawings):
        yield vectors.run_row(run, partial(_results, program.results[number]))
    if any(drawing.missed for drawing in drawings):
        raise vectors.TooMuchError


def _results(result: Result, verdict: bool | None) -> dict[str, bool | None]:
    is_active = verdict is True or (result.hazard and verdict is None)
    return {result.id: verdict, f"{result.id} is active": is_active}
