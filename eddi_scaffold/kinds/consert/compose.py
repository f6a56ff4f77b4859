"""Composition: whether the demands of ConSerts are met by guarantees of others.

Source: SESAME D7.2 section 3.1 (``conserts compose``). Unlike there, the order of the files does
not matter, and units are converted exactly.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from eddi_scaffold.common import units
from eddi_scaffold.common.graphs import cycles
from eddi_scaffold.common.problems import Problem, SimilarNames, problem
from eddi_scaffold.kinds.consert.graph import constants
from eddi_scaffold.kinds.consert.model import (
    BinaryDimension,
    CategoricalDimension,
    Dimension,
    NumericDimension,
)
from eddi_scaffold.kinds.consert.ranges import common, is_inside, range_text, span

if TYPE_CHECKING:
    from collections.abc import Collection, Iterator, Mapping, Sequence

    from eddi_scaffold.kinds.consert.model import ConSert, Demand, Guarantee
    from eddi_scaffold.kinds.consert.ranges import Interval

Ref = tuple[str, str]
"""Instance name and id."""
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
class Composition:
    """What came of putting ConSerts together.

    Attributes:
        composable: every demand and required service is met, and no ConSerts wait for each other.
        order: instance names, providers first; those that could not be accepted are missing.
        bindings: (instance, demand) -> (instance, guarantee) pairs that fulfil it, none of which
            depends on the instance itself.
        unmatched_demands: ids of demands that no ConSert in the set fulfils, as ``INSTANCE/ID``
            where several instances have a demand of that id.
        unmatched_services: ids of required services that no ConSert in the set provides, likewise.
        reasons: one sentence for each obstacle.
        problems: instance names that are used twice (C007), services that a file allocates to one
            that does not do (X009).
    """

    composable: bool
    order: tuple[str, ...]
    bindings: Mapping[Ref, tuple[Ref, ...]]
    unmatched_demands: tuple[str, ...]
    unmatched_services: tuple[str, ...]
    reasons: tuple[str, ...]
    problems: tuple[Problem, ...] = ()

    def as_json(self) -> dict[str, object]:
        """Return the stable JSON form of ``compose --json``."""
        return {
            "composable": self.composable,
            "order": list(self.order),
            "bindings": [
                {
                    "instance": instance,
                    "demand": demand,
                    "guarantees": [{"instance": i, "guarantee": g} for i, g in guarantees],
                }
                for (instance, demand), guarantees in self.bindings.items()
            ],
            "unmatched_demands": list(self.unmatched_demands),
            "unmatched_services": list(self.unmatched_services),
            "reasons": list(self.reasons),
            "warnings": [
                problem.message for problem in self.problems if problem.level == "warning"
            ],
        }

    def as_text(self) -> list[str]:
        """Return the same as lines for people."""
        bound = [
            f"  {'/'.join(demand)} <- {' or '.join('/'.join(ref) for ref in guarantees)}"
            for demand, guarantees in self.bindings.items()
            if guarantees
        ]
        return [
            "composable" if self.composable else "not composable",
            *([f"order: {', '.join(self.order)}"] if self.order else []),
            *(["bindings:", *bound] if bound else []),
            *(["reasons:", *(f"  {reason}" for reason in self.reasons)] if self.reasons else []),
        ]


@dataclass(frozen=True)
class _Offer:
    """A guarantee that another ConSert could lean on."""

    instance: str
    guarantee: Guarantee
    services: frozenset[str]


@dataclass
class _Need:
    """A demand or a required service, with the instances that can meet it."""

    instance: str
    id: str
    met_by: dict[str, list[str]] = field(default_factory=dict)
    reason: str = ""
    is_demand: bool = True
    types: tuple[str, ...] = ()


def compose(instances: Sequence[tuple[str, ConSert]]) -> Composition:
    """Put ConSerts together.

    Args:
        instances: name and checked model of each; a model may be there several times.
    """
    names = [name for name, _ in instances]
    repeated = [name for name in dict.fromkeys(names) if names.count(name) > 1]
    problems = tuple(
        problem("C007.same_instances", number=names.count(name), name=name) for name in repeated
    )
    if problems:
        return Composition(
            composable=False,
            order=(),
            bindings={},
            unmatched_demands=(),
            unmatched_services=(),
            reasons=tuple(problem.message for problem in problems),
            problems=problems,
        )
    offers = [offer for name, consert in instances for offer in _offers(name, consert)]
    needs = [need for name, consert in instances for need in _needs(name, consert, offers)]
    provided = {
        (service.functional_service_type, name)
        for name, consert in instances
        for service in consert.provided_services
    }
    needs += [need for name, consert in instances for need in _services(name, consert, provided)]
    rounds = _accept(names, needs)
    unmet = [need for need in needs if not need.met_by]
    return Composition(
        composable=len(rounds) == len(instances),
        order=tuple(rounds),
        bindings=_bindings(needs, rounds),
        unmatched_demands=_ids(needs, unmet, is_demand=True),
        unmatched_services=_ids(needs, unmet, is_demand=False),
        reasons=(*_with_near_names(unmet, offers, provided), *_waiting(instances, needs, rounds)),
        problems=tuple(_allocations(instances, needs)),
    )


def _allocations(
    instances: Sequence[tuple[str, ConSert]], needs: Sequence[_Need]
) -> Iterator[Problem]:
    """Yield where a file allocates a service to one that does not fulfil all of its demands."""
    met_by = {(need.instance, need.id): need.met_by for need in needs if need.is_demand}
    services = [
        (name, provided_service)
        for name, consert in instances
        for provided_service in consert.provided_services
    ]
    at = {service.place: (name, service) for name, service in services}
    by_required = {
        place: (name, service) for name, service in services for place in service.allocated
    }
    for name, consert in instances:
        for service in consert.required_services:
            pairs = [at[place] for place in service.allocated if place in at]
            pairs += [by_required[service.place]] if service.place in by_required else []
            for other, provided in dict(pairs).items():
                guarantees = set(provided.guarantees)
                unmet = [
                    d
                    for d in service.demands
                    if guarantees.isdisjoint(met_by[name, d].get(other, ()))
                ]
                if unmet:
                    what = f"{name}/{service.id} is allocated to {other}/{provided.id}"
                    yield problem("X009.unmet", service.place, subject=what, unmet=", ".join(unmet))


def _with_near_names(
    unmet: Sequence[_Need], offers: Sequence[_Offer], provided: Collection[tuple[str, str]]
) -> Iterator[str]:
    """Yield why needs are not met; a type that nobody has may be a slip."""
    known = {type_ for type_, _ in provided}
    known |= {dimension.type for offer in offers for dimension in offer.guarantee.dimensions}
    near = SimilarNames(known)
    for need in unmet:
        hints = [near.hint(type_) for type_ in need.types if type_ not in known]
        yield "; ".join(filter(None, (need.reason, *hints)))


def _offers(instance: str, consert: ConSert) -> list[_Offer]:
    types: dict[str, set[str]] = {}
    for service in consert.provided_services:
        for id_ in service.guarantees:
            types.setdefault(id_, set()).add(service.functional_service_type)
    values = constants(consert)
    return [
        _Offer(instance, guarantee, frozenset(types.get(guarantee.id, ())))
        for guarantee in consert.guarantees
        if values[guarantee.id] is not False  # what can never hold fulfils nothing
    ]


def _needs(instance: str, consert: ConSert, offers: Sequence[_Offer]) -> Iterator[_Need]:
    for demand in consert.demands:
        types = [
            service.functional_service_type
            for service in consert.required_services
            if demand.id in service.demands
        ]
        need = _Need(instance, demand.id)
        need.types = (*types, *(dimension.type for dimension in demand.dimensions))
        others = [offer for offer in offers if offer.instance != instance]
        candidates = [
            offer for offer in others if not types or not offer.services.isdisjoint(types)
        ]
        misses = _judge(need, demand, candidates)
        need.reason = f"demand {_name(need)} is not fulfilled: " + _nearest(misses, types)
        yield need


def _judge(need: _Need, demand: Demand, candidates: Sequence[_Offer]) -> list[Mismatch]:
    misses: list[Mismatch] = []
    for offer in candidates:
        difference = mismatch(offer.guarantee, demand, f"{offer.instance}/{offer.guarantee.id}")
        if difference is None:
            need.met_by.setdefault(offer.instance, []).append(offer.guarantee.id)
        else:
            misses.append(difference)
    return misses


def _nearest(misses: Sequence[Mismatch], types: Sequence[str]) -> str:
    if misses:
        return min(misses, key=lambda miss: miss.distance).text
    if types:
        return f"no other ConSert guarantees anything in a service of type {' or '.join(types)}"
    return "no other ConSert guarantees anything"


def _services(instance: str, consert: ConSert, provided: set[tuple[str, str]]) -> Iterator[_Need]:
    for service in consert.required_services:
        type_ = service.functional_service_type
        need = _Need(instance, service.id, is_demand=False)
        need.types = (type_,)
        need.met_by = {
            other: []
            for service_type, other in sorted(provided)
            if service_type == type_ and other != instance
        }
        text = f"required service {_name(need)} is not provided: no other ConSert provides "
        need.reason = f"{text}a service of type {type_}"
        yield need


def _accept(names: Sequence[str], needs: Sequence[_Need]) -> dict[str, int]:
    """Accept in rounds what needs only what has been accepted; instance -> its round."""
    open_needs: dict[str, list[_Need]] = {name: [] for name in names}
    for need in needs:
        open_needs[need.instance].append(need)
    rounds: dict[str, int] = {}
    number = 0
    while True:
        ready = [
            name
            for name, own in open_needs.items()
            if name not in rounds and all(_is_met(need, rounds) for need in own)
        ]
        if not ready:
            return rounds
        rounds |= dict.fromkeys(ready, number)
        number += 1


def _is_met(need: _Need, accepted: Mapping[str, int]) -> bool:
    return any(name in accepted for name in need.met_by)


def _bindings(needs: Sequence[_Need], rounds: Mapping[str, int]) -> dict[Ref, tuple[Ref, ...]]:
    """Bind demands to guarantees of earlier rounds, so that no ConSert leans on itself."""
    return {
        (need.instance, need.id): tuple(
            (other, id_)
            for other, ids in need.met_by.items()
            if other in rounds and rounds[other] < rounds.get(need.instance, len(rounds))
            for id_ in ids
        )
        for need in needs
        if need.is_demand and need.met_by
    }


def _ids(needs: Sequence[_Need], unmet: Sequence[_Need], *, is_demand: bool) -> tuple[str, ...]:
    ids = [need.id for need in needs if need.is_demand == is_demand]
    return tuple(
        need.id if ids.count(need.id) == 1 else _name(need)
        for need in unmet
        if need.is_demand == is_demand
    )


def _name(need: _Need) -> str:
    return f"{need.instance}/{need.id}"


def _waiting(
    instances: Sequence[tuple[str, ConSert]],
    needs: Sequence[_Need],
    rounds: Mapping[str, int],
) -> Iterator[str]:
    """Report ConSerts that wait for others that cannot be accepted, or for each other."""
    waits: dict[str, tuple[str, ...]] = {name: () for name, _ in instances}
    for need in needs:
        if need.instance not in rounds and not _is_met(need, rounds):
            waits[need.instance] = (*waits[need.instance], *need.met_by)
    for name, others in waits.items():
        if others:
            names = " or ".join(dict.fromkeys(others))
            yield f"{name} waits for {names}, which cannot be accepted"
    for cycle in cycles(waits):
        chain = " -> ".join([*cycle, cycle[0]])
        yield f"these ConSerts wait for each other (provider -> user): {chain}"


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


def fits(offered: Dimension, demanded: Dimension) -> bool:
    """Return whether a dimension of a guarantee satisfies one of a demand."""
    if type(offered) is not type(demanded) or offered.type != demanded.type:
        return False
    if isinstance(offered, BinaryDimension) or isinstance(demanded, BinaryDimension):
        return offered == demanded
    if offered.subset not in (None, demanded.subset):
        return False
    if isinstance(offered, NumericDimension) and isinstance(demanded, NumericDimension):
        if units.factor(offered.uom, demanded.uom) is None:
            return False
        needed, covered = _spans(demanded), _spans(offered)
        if demanded.subset == "Intersection":
            return common(needed, covered)
        inside = is_inside(needed, covered), is_inside(covered, needed)
    else:
        demanded_set, offered_set = set(demanded.covered), set(offered.covered)
        if demanded.subset == "Intersection":
            return not demanded_set.isdisjoint(offered_set)
        inside = demanded_set <= offered_set, offered_set <= demanded_set
    return {"Demand": inside[0], "Guarantee": inside[1]}.get(demanded.subset or "", all(inside))


def _spans(dimension: NumericDimension) -> list[Interval]:
    unit = units.find(dimension.uom) or units.RATIO
    return [span(range_, unit.factor) for range_ in dimension.covered]


def _reason(demanded: Dimension, offered: Dimension, name: str, demand: str) -> tuple[int, str]:
    """Explain why a dimension does not fit; the rank grows with the difference."""
    title = f"dimension {demanded.type}"
    if type(offered) is not type(demanded) or offered.type != demanded.type:
        kind = _KINDS[type(demanded)]
        return 3, f"{name} has no {kind} {title}"
    if isinstance(demanded, BinaryDimension) or isinstance(offered, BinaryDimension):
        value = str(isinstance(demanded, BinaryDimension) and demanded.value).lower()
        return 3, f"{name} has no Binary {title} of the value {value}"
    if offered.subset not in (None, demanded.subset):
        text = (
            f"{title}: the subset is {offered.subset} in {name} and {demanded.subset} in {demand}"
        )
        return 2, text
    if _has_other_quantity(offered, demanded):
        return (
            2,
            f"{title}: {_unit(offered)} of {name} and {_unit(demanded)} of {demand} do not compare",
        )
    sides = [f"{_covered(demanded)} of {demand}", f"{_covered(offered)} of {name}"]
    relation = _RELATIONS.get(demanded.subset or "", "does not equal")
    if demanded.subset == "Guarantee":
        sides.reverse()
    return 1, f"{title}: {sides[0]} {relation} {sides[1]}"


def _has_other_quantity(offered: Dimension, demanded: Dimension) -> bool:
    return (
        isinstance(offered, NumericDimension)
        and isinstance(demanded, NumericDimension)
        and units.factor(offered.uom, demanded.uom) is None
    )


def _unit(dimension: Dimension) -> str:
    uom = dimension.uom if isinstance(dimension, NumericDimension) else None
    return f"the unit {uom}" if uom else "the ratio"


def _covered(dimension: CategoricalDimension | NumericDimension) -> str:
    if isinstance(dimension, CategoricalDimension):
        return f"{{{', '.join(dimension.covered)}}}"
    return " or ".join(range_text(range_, dimension.uom) for range_ in dimension.covered)
