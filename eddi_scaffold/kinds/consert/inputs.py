"""Inputs of a ConSert monitor: its demands and its evidence."""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING

from eddi_scaffold.common import units
from eddi_scaffold.common.claims import Use
from eddi_scaffold.kinds import InputType, ModelInput
from eddi_scaffold.kinds.consert.model import (
    BinaryDimension,
    CategoricalDimension,
    ConSert,
    Dimension,
    Evidence,
)
from eddi_scaffold.kinds.consert.ranges import range_text

if TYPE_CHECKING:
    from collections.abc import Sequence


def inputs(consert: ConSert) -> Sequence[ModelInput]:
    """Return demands, then evidence, each in file order (the order of SESAME D7.2 Fig 44).

    A demand is a Boolean at run time, whatever its dimensions: that it fits has been decided
    when the ConSerts were composed.
    """
    demands = (
        ModelInput(
            demand.id,
            "bool",
            description=demand.description,
            covered="; ".join(covered_text(dimension) for dimension in demand.dimensions),
            is_good=_is_true,
            is_demand=True,
            uses=(Use(_is_true),),
        )
        for demand in consert.demands
    )
    return (*demands, *(_evidence(evidence) for evidence in consert.evidence))


def covered_text(dimension: Dimension) -> str:
    """Describe in one line what counts as good: ``Distance in [0, 5) m``."""
    if isinstance(dimension, BinaryDimension):
        return dimension.type if dimension.value else f"{dimension.type} is false"
    if isinstance(dimension, CategoricalDimension):
        return f"{dimension.type} in {{{', '.join(dimension.covered)}}}"
    ranges = " or ".join(range_text(one, dimension.uom) for one in dimension.covered)
    return f"{dimension.type} in {ranges}"


def _evidence(evidence: Evidence) -> ModelInput:
    dimension = evidence.dimension
    covered, good = covered_text(dimension), partial(_is_covered, dimension)
    if isinstance(dimension, BinaryDimension | CategoricalDimension):
        type_: InputType = "bool" if isinstance(dimension, BinaryDimension) else "str"
        return ModelInput(
            evidence.id,
            type_,
            description=evidence.description,
            covered=covered,
            is_good=good,
            uses=(Use(good),),
        )
    return ModelInput(
        evidence.id,
        "float",
        unit=dimension.uom or "",
        units=units.convertible(dimension.uom),
        description=evidence.description,
        covered=covered,
        is_good=good,
        starts=tuple(one.start.value for one in dimension.covered),
        uses=(Use(good),),
    )


def _is_true(value: object) -> bool:
    return value is True


def _is_covered(dimension: Dimension, value: object) -> bool:
    if isinstance(dimension, BinaryDimension):
        return value is dimension.value
    if isinstance(dimension, CategoricalDimension):
        return value in dimension.covered
    if isinstance(value, bool) or not isinstance(value, int | float):
        return False
    return any(
        one.start.value < value < one.end.value
        or (one.inclusive and value == one.end.value)
        or (one.start_inclusive and value == one.start.value)
        for one in dimension.covered
    )
