"""Checks of dimensions: C006, C015 to C017, C023 (categories) and C025."""

from __future__ import annotations

from collections import Counter
from dataclasses import replace
from typing import TYPE_CHECKING

from eddi_scaffold import units
from eddi_scaffold.kinds.consert.model import (
    CategoricalDimension,
    Dimension,
    NumericDimension,
    Range,
)
from eddi_scaffold.kinds.consert.ranges import is_empty, is_nan, overlap, range_text
from eddi_scaffold.positioned_yaml.nodes import shown
from eddi_scaffold.problems import Place, Problem, did_you_mean, error, warning

if TYPE_CHECKING:
    from collections.abc import Iterator

    from eddi_scaffold.kinds.consert.model import ConSert

_NO_UNIT = 'write its unit, such as `uom: percent`; `uom: ""` is a ratio, 0.2 for 20 %'


def check_dimensions(consert: ConSert) -> list[Problem]:
    """Check every dimension of evidence, demands and guarantees."""
    found: list[Problem] = []
    of_services = {id_ for service in consert.required_services for id_ in service.demands}
    for evidence in consert.evidence:
        found += _dimension(evidence.dimension, f"evidence {shown(evidence.id)}", evidence.place)
    for kind, group in (("demand", consert.demands), ("guarantee", consert.guarantees)):
        for node in group:
            what = f"{kind} {shown(node.id)}"
            if not node.dimensions and kind == "demand" and node.id not in of_services:
                message = f"{what} has neither a dimension nor a service: it asks for nothing"
                found.append(error("C006", message, node.place))
            for dimension in node.dimensions:
                found += _dimension(dimension, what, node.place)
    return found


def without_repetitions(dimension: Dimension) -> Dimension:
    """Return a dimension with each category once, in the order of the file."""
    if isinstance(dimension, CategoricalDimension):
        return replace(dimension, covered=tuple(dict.fromkeys(dimension.covered)))
    return dimension


def _dimension(dimension: Dimension, what: str, owner: Place) -> Iterator[Problem]:
    place = owner if dimension.place.line is None else dimension.place
    if isinstance(dimension, CategoricalDimension):
        yield from _categorical(dimension, what, place)
    elif isinstance(dimension, NumericDimension):
        yield from _numeric(dimension, what, place)


def _nothing_covered(dimension: Dimension, what: str, place: Place) -> Problem:
    message = f"dimension {shown(dimension.type)} of {what} covers nothing"
    return error("C006", message, place)


def _categorical(dimension: CategoricalDimension, what: str, place: Place) -> Iterator[Problem]:
    if not dimension.covered:
        yield _nothing_covered(dimension, what, place)
    for category, count in Counter(dimension.covered).items():
        if count > 1:
            message = f"category {shown(category)} occurs {count} times in {what}: read once"
            yield warning("C023", message, place)


def _numeric(dimension: NumericDimension, what: str, place: Place) -> Iterator[Problem]:
    if not dimension.covered:
        yield _nothing_covered(dimension, what, place)
    sound = True
    for one in dimension.covered:
        problem = _range(one, what, place if one.place.line is None else one.place)
        if problem is not None:
            sound = False
            yield problem
    if sound:
        yield from _overlaps(dimension, what, place)
    yield from _unit(dimension, what, place)


def _range(one: Range, what: str, place: Place) -> Problem | None:
    if is_nan(one.start) or is_nan(one.end):
        return error("C015", f"a range of {what} has a bound that is not a number", place)
    if is_empty(one):
        message = f"the range {range_text(one)} of {what} is empty: nothing lies in it"
        return error("C015", message, place)
    return None


def _overlaps(dimension: NumericDimension, what: str, place: Place) -> Iterator[Problem]:
    for first, second in overlap(dimension.covered):
        message = f"the ranges {range_text(first)} and {range_text(second)} of {what} overlap"
        yield warning("C025", message, place if second.place.line is None else second.place)


def _unit(dimension: NumericDimension, what: str, place: Place) -> Iterator[Problem]:
    if dimension.uom is None:
        message = f"dimension {shown(dimension.type)} of {what} has no unit"
        yield warning("C017", message, place, _NO_UNIT)
    elif units.find(dimension.uom) is None:
        message = f"unknown unit {shown(dimension.uom)} in {what}; known units: {units.listed()}"
        near = did_you_mean(dimension.uom, [s for s in units.spellings() if s])
        hint = "write percent" if dimension.uom == "%" else near
        yield error("C016", message, place, hint)
