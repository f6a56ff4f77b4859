"""Whether one guarantee fulfils one demand, and if not, what is in the way."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from eddi_scaffold.common import units
from eddi_scaffold.kinds.consert.model import (
    BinaryDimension,
    CategoricalDimension,
    Demand,
    Dimension,
    Guarantee,
    NumericDimension,
)
from eddi_scaffold.kinds.consert.ranges import common, is_inside, range_text, span

if TYPE_CHECKING:
    from eddi_scaffold.kinds.consert.ranges import Interval

_KINDS = {
    BinaryDimension: "Binary",
    CategoricalDimension: "Categorical",
    NumericDimension: "Numeric",
}


_RELATIONS = {
    "Demand": "is not inside",
    "Guarantee": "is not inside",
    "Intersection": "has nothing in common with",
}


@dataclass(frozen=True)
class Mismatch:
    """Why a guarantee does not fulfil a demand.

    Attributes:
        distance: the more, the less the guarantee is what the author of the demand had in mind.
        text: the first dimension in the way.
    """

    distance: tuple[int, int]
    text: str


def mismatch(guarantee: Guarantee, demand: Demand, name: str) -> Mismatch | None:
    """Compare a guarantee with a demand.

    Every dimension of the demand needs one of the guarantee with the same kind and type, whose
    covered values fit in the direction of the demand's subset flag; a flag of the guarantee must be
    the same, and further dimensions of the guarantee do not matter.

    Args:
        guarantee: what another ConSert offers.
        demand: what is needed.
        name: how the guarantee is called in the text.

    Returns:
        ``None`` when the guarantee fulfils the demand.
    """
    missing = [
        min((_reason(d, g, name, demand.id) for g in guarantee.dimensions), key=lambda r: r[0])
        if guarantee.dimensions
        else (3, f"{name} has no dimension")
        for d in demand.dimensions
        if not any(fits(g, d) for g in guarantee.dimensions)
    ]
    if not missing:
        return None
    return Mismatch((len(missing), sum(rank for rank, _ in missing)), missing[0][1])


def fits(given: Dimension, wanted: Dimension) -> bool:
    """Return whether a dimension of a guarantee satisfies one of a demand."""
    if type(given) is not type(wanted) or given.type != wanted.type:
        return False
    if isinstance(given, BinaryDimension) or isinstance(wanted, BinaryDimension):
        return given == wanted
    if given.subset not in (None, wanted.subset):
        return False
    if isinstance(given, NumericDimension) and isinstance(wanted, NumericDimension):
        if units.factor(given.uom, wanted.uom) is None:
            return False
        demanded, offered = _spans(wanted), _spans(given)
        if wanted.subset == "Intersection":
            return common(demanded, offered)
        inside = is_inside(demanded, offered), is_inside(offered, demanded)
    else:
        demanded_set, offered_set = set(wanted.covered), set(given.covered)
        if wanted.subset == "Intersection":
            return not demanded_set.isdisjoint(offered_set)
        inside = demanded_set <= offered_set, offered_set <= demanded_set
    return {"Demand": inside[0], "Guarantee": inside[1]}.get(wanted.subset or "", all(inside))


def _spans(dimension: NumericDimension) -> list[Interval]:
    unit = units.find(dimension.uom) or units.RATIO
    return [span(one, unit.factor) for one in dimension.covered]


def _reason(wanted: Dimension, given: Dimension, name: str, demand: str) -> tuple[int, str]:
    """Explain why a dimension does not fit; the rank grows with the difference."""
    title = f"dimension {wanted.type}"
    if type(given) is not type(wanted) or given.type != wanted.type:
        kind = _KINDS[type(wanted)]
        return 3, f"{name} has no {kind} {title}"
    if isinstance(wanted, BinaryDimension) or isinstance(given, BinaryDimension):
        value = str(isinstance(wanted, BinaryDimension) and wanted.value).lower()
        return 3, f"{name} has no Binary {title} of the value {value}"
    if given.subset not in (None, wanted.subset):
        text = f"{title}: the subset is {given.subset} in {name} and {wanted.subset} in {demand}"
        return 2, text
    if _has_other_quantity(given, wanted):
        return (
            2,
            f"{title}: {_unit(given)} of {name} and {_unit(wanted)} of {demand} do not compare",
        )
    sides = [f"{_covered(wanted)} of {demand}", f"{_covered(given)} of {name}"]
    relation = _RELATIONS.get(wanted.subset or "", "does not equal")
    if wanted.subset == "Guarantee":
        sides.reverse()
    return 1, f"{title}: {sides[0]} {relation} {sides[1]}"


def _has_other_quantity(given: Dimension, wanted: Dimension) -> bool:
    return (
        isinstance(given, NumericDimension)
        and isinstance(wanted, NumericDimension)
        and units.factor(given.uom, wanted.uom) is None
    )


def _unit(dimension: Dimension) -> str:
    uom = dimension.uom if isinstance(dimension, NumericDimension) else None
    return f"the unit {uom}" if uom else "the ratio"


def _covered(dimension: CategoricalDimension | NumericDimension) -> str:
    if isinstance(dimension, CategoricalDimension):
        return f"{{{', '.join(dimension.covered)}}}"
    return " or ".join(range_text(one, dimension.uom) for one in dimension.covered)
