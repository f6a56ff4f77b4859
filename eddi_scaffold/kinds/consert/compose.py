"""Composition: whether the demands of ConSerts are met by guarantees of others.

Source: SESAME D7.2 section 3.1 (``conserts compose``). Unlike there, the order of the files does
not matter, and units are converted exactly.
"""

from __future__ import annotations

from collections import Counter, defaultdict
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from itertools import product
from operator import itemgetter

from eddi_scaffold.common import units
from eddi_scaffold.common.problems import EddiError, Problem, problem
from eddi_scaffold.kinds.consert import consert as model
from eddi_scaffold.kinds.consert.graph import constants
from eddi_scaffold.kinds.consert.ranges import common, is_inside, span

Ref = tuple[str, str]  # Instance name and id


@dataclass(frozen=True)
class Composition:
    """What came of putting ConSerts together."""

    composable: bool  # every need is met, and no ConSerts wait for each other
    order: tuple[str, ...]  # names of the accepted instances, providers first
    # demand -> guarantees that fulfil it, none of which depends on the instance of the demand
    bindings: Mapping[Ref, tuple[Ref, ...]]
    # ids of what no ConSert fulfils, as `INSTANCE/ID` where several instances have that id
    unmatched_demands: tuple[str, ...]
    unmatched_services: tuple[str, ...]
    reasons: tuple[str, ...]  # one sentence for each obstacle
    problems: tuple[Problem, ...] = ()  # services that a file allocates wrongly (X009)

    def as_json(self) -> dict[str, object]:
        """Return the stable JSON form of ``compose --json``."""
        content = {k: list(v) if isinstance(v, tuple) else v for k, v in vars(self).items()}
        del content["problems"]
        content["bindings"] = [
            {
                "instance": instance,
                "demand": demand,
                "guarantees": [{"instance": i, "guarantee": g} for i, g in guarantees],
            }
            for (instance, demand), guarantees in self.bindings.items()
        ]
        return {**content, "warnings": [problem.message for problem in self.problems]}

    def as_text(self) -> list[str]:
        """Return the same as lines for people."""
        bound = [
            f"  {'/'.join(demand)} <- {' or '.join('/'.join(ref) for ref in guarantees)}"
            for demand, guarantees in self.bindings.items()
            if guarantees
        ]
        lines = ["composable" if self.composable else "not composable"]
        lines += [f"order: {', '.join(self.order)}"] if self.order else []
        lines += ["bindings:", *bound] if bound else []
        reasons = [f"  {text}" for text in self.reasons]
        return [*lines, "reasons:", *reasons] if reasons else lines


@dataclass
class _Need:
    """A demand or a required service."""

    instance: str
    id: str
    is_demand: bool
    reason: str = ""  # why it is not met
    # instance that can meet it -> guarantees of it that do
    met_by: dict[str, list[str]] = field(default_factory=dict)


def compose(instances: Sequence[tuple[str, model.ConSert]]) -> Composition:
    """Put ConSerts together, each under a name; a model may be there several times.

    Raises:
        EddiError: two instances have one name (C007).
    """
    names = [name for name, _ in instances]
    repeated = next((name for name in names if names.count(name) > 1), None)
    if repeated is not None:
        raise EddiError(problem("C007.instances", name=repeated))
    needs = [*_demands(instances), *_required_services(instances)]
    # What needs only what has been accepted is accepted, in rounds; instance -> its round.
    accepted: dict[str, int] = {}
    while True:
        unmet = {need.instance for need in needs if accepted.keys().isdisjoint(need.met_by)}
        ready = [name for name in names if name not in unmet and name not in accepted]
        if not ready:
            break
        accepted |= dict.fromkeys(ready, len(accepted))
    rounds = dict.fromkeys(names, len(names)) | accepted
    count = Counter((need.is_demand, need.id) for need in needs)
    unmatched: dict[bool, list[str]] = {True: [], False: []}
    reasons = [need.reason for need in needs if not need.met_by]
    waits: dict[str, dict[str, None]] = defaultdict(dict)
    for need in needs:
        if not need.met_by:
            is_unique = count[need.is_demand, need.id] == 1
            unmatched[need.is_demand].append(need.id if is_unique else f"{need.instance}/{need.id}")
        elif accepted.keys().isdisjoint(need.met_by):
            waits[need.instance] |= dict.fromkeys(need.met_by)
    for name, others in waits.items():
        reasons.append(f"{name} waits for {' or '.join(others)}, which cannot be accepted")
    return Composition(
        composable=len(accepted) == len(instances),
        order=tuple(accepted),
        # to guarantees of earlier rounds, so that no ConSert leans on itself
        bindings={
            (need.instance, need.id): tuple(
                (other, id_)
                for other, ids in need.met_by.items()
                if rounds[other] < rounds[need.instance]
                for id_ in ids
            )
            for need in needs
            if need.is_demand and need.met_by
        },
        unmatched_demands=tuple(unmatched[True]),
        unmatched_services=tuple(unmatched[False]),
        reasons=tuple(reasons),
        problems=tuple(_wrong_allocations(instances, needs)),
    )


def _demands(instances: Sequence[tuple[str, model.ConSert]]) -> Iterator[_Need]:
    offers: list[tuple[str, model.Guarantee, Mapping[str, None]]] = []
    for name, consert in instances:
        provided, values = service_types(consert.provided_services), constants(consert)
        offers += [
            (name, guarantee, provided.get(guarantee.id, {}))
            for guarantee in consert.guarantees
            if values[guarantee.id] is not False  # what can never hold fulfils nothing
        ]
    for name, consert in instances:
        required = service_types(consert.required_services)
        for demand in consert.demands:
            types = required.get(demand.id, {})
            reason = "no other ConSert guarantees anything"
            reason += f" in a service of type {' or '.join(types)}" if types else ""
            nearest, met_by = (4, reason), defaultdict[str, list[str]](list)
            for other, guarantee, offered_types in offers:
                if other == name or (types and types.keys().isdisjoint(offered_types)):
                    continue
                mismatch = _mismatch(guarantee, demand, f"{other}/{guarantee.id}")
                nearest = min(nearest, mismatch, key=itemgetter(0))
                if mismatch[0] == 0:
                    met_by[other].append(guarantee.id)
            reason = f"demand {name}/{demand.id} is not fulfilled: {nearest[1]}"
            yield _Need(name, demand.id, True, reason, met_by)


def _required_services(instances: Sequence[tuple[str, model.ConSert]]) -> Iterator[_Need]:
    for name, consert in instances:
        for service in consert.required_services:
            type_ = service.functional_service_type
            providers = {
                other
                for other, provider in instances
                for provided in provider.provided_services
                if other != name and provided.functional_service_type == type_
            }
            reason = f"required service {name}/{service.id} is not provided: "
            reason += f"no other ConSert provides a service of type {type_}"
            met_by: dict[str, list[str]] = {other: [] for other in sorted(providers)}
            yield _Need(name, service.id, False, reason, met_by)


def _wrong_allocations(
    instances: Sequence[tuple[str, model.ConSert]], needs: Sequence[_Need]
) -> Iterator[Problem]:
    """Yield where a file allocates a service to one that does not fulfil all of its demands."""
    met_by = {(need.instance, need.id): need.met_by for need in needs if need.is_demand}
    required = [(name, each) for name, consert in instances for each in consert.required_services]
    provided = [(name, each) for name, consert in instances for each in consert.provided_services]
    for (name, service), (other, provider) in product(required, provided):
        if provider.place in service.allocated or service.place in provider.allocated:
            offered = {*provider.members}
            fulfilling = {id_: met_by[name, id_].get(other, ()) for id_ in service.members}
            unmet = [id_ for id_, ids in fulfilling.items() if offered.isdisjoint(ids)]
            if unmet:
                what = f"{name}/{service.id} is allocated to {other}/{provider.id}"
                yield problem("X009.unmet", service.place, subject=what, unmet=", ".join(unmet))


def service_types(services: Sequence[model.Service]) -> Mapping[str, Mapping[str, None]]:
    """Return demand or guarantee -> types of the services that group it."""
    types: dict[str, dict[str, None]] = defaultdict(dict)
    for service in services:
        for id_ in service.members:
            types[id_][service.functional_service_type] = None
    return types


def why_not_fulfilled(
    provider: model.ConSert, guarantee_id: str, user: model.ConSert, demand_id: str
) -> str | None:
    """Return why a guarantee does not fulfil a demand that it is wired to, ``None`` if it does.

    Evidence asks for nothing that a guarantee could fulfil; it is not judged.
    """
    demand = {demand.id: demand for demand in user.demands}.get(demand_id)
    guarantee = {each.id: each for each in provider.guarantees}.get(guarantee_id)
    if demand is None or guarantee is None:
        return None
    name = f"{provider.name}/{guarantee_id}"
    required = service_types(user.required_services).get(demand_id, {}).keys()
    provided = service_types(provider.provided_services).get(guarantee_id, {}).keys()
    if required and required.isdisjoint(provided):
        types = " or ".join(sorted(required))
        return f"{name} is not in a service of type {types}, which {demand_id} requires"
    if constants(provider)[guarantee_id] is False:
        return f"{name} can never be active"
    return _mismatch(guarantee, demand, name)[1] or None


def _mismatch(guarantee: model.Guarantee, demand: model.Demand, name: str) -> tuple[int, str]:
    """Return how far a guarantee is from fulfilling a demand, 0 if it does, and what is in the way.

    Every dimension of the demand needs one of the guarantee with the same kind and type, whose
    covered values fit in the direction of the demand's subset flag; a flag of the guarantee must be
    the same, and further dimensions of the guarantee do not matter.
    """
    mismatch = 0, ""
    for dimension in demand.dimensions:
        kind = type(dimension).__name__.removesuffix("Dimension")
        nearest = 3, f"{name} has no {kind} dimension {dimension.type}"
        for offered in guarantee.dimensions:
            if type(offered) is type(dimension) and offered.type == dimension.type:
                difference = _difference(offered, dimension, name, demand.id)
                nearest = min(nearest, difference, key=itemgetter(0))
        mismatch = max(mismatch, nearest, key=itemgetter(0))
    return mismatch


def _difference(
    offered: model.Dimension, demanded: model.Dimension, name: str, demand: str
) -> tuple[int, str]:
    """Explain why a dimension does not fit one of its kind; the rank grows with the difference."""
    title = f"dimension {demanded.type}"
    if isinstance(demanded, model.BinaryDimension) or isinstance(offered, model.BinaryDimension):
        differs = 2, f"{title}: the value of {name} and that of {demand} differ"
        return (0, "") if offered == demanded else differs
    if offered.subset not in (None, demanded.subset):
        subsets = f"{offered.subset} in {name} and {demanded.subset} in {demand}"
        return 2, f"{title}: the subset is {subsets}"
    if isinstance(demanded, model.NumericDimension) and isinstance(offered, model.NumericDimension):
        their_units = [offered.uom, demanded.uom]
        if units.factor(*their_units) is None:
            texts = [f"the unit {unit}" if unit else "the ratio" for unit in their_units]
            return 2, f"{title}: {texts[0]} of {name} and {texts[1]} of {demand} do not compare"
        needed, covered = (  # exact, in the basic unit
            [span(part, (units.find(d.uom) or units.RATIO).factor) for part in d.covered]
            for d in (demanded, offered)
        )
        has_common = common(needed, covered)
        is_enough, is_allowed = is_inside(needed, covered), is_inside(covered, needed)
    else:
        values, offered_values = set(demanded.covered), set(offered.covered)
        has_common = not values.isdisjoint(offered_values)
        is_enough, is_allowed = values <= offered_values, offered_values <= values
    fits, relation = {
        "Intersection": (has_common, "has nothing in common with"),
        "Demand": (is_enough, "is not inside"),
        "Guarantee": (is_allowed, "is not inside"),
    }.get(demanded.subset or "", (is_enough and is_allowed, "does not equal"))
    if fits:
        return 0, ""
    sides = [f"{demanded.covered_text} of {demand}", f"{offered.covered_text} of {name}"]
    if demanded.subset == "Guarantee":
        sides.reverse()
    return 1, f"{title}: {sides[0]} {relation} {sides[1]}"
