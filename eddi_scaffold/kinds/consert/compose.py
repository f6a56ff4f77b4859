"""Composition: whether the demands of ConSerts are met by guarantees of others.

Source: SESAME D7.2 section 3.1 (``conserts compose``). Unlike there, the order of the files does
not matter, and units are converted exactly.
"""

from __future__ import annotations

from collections import Counter, defaultdict
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from operator import itemgetter

from eddi_scaffold.common import units
from eddi_scaffold.common.graphs import cycles
from eddi_scaffold.common.problems import EddiError, Problem, SimilarNames, problem
from eddi_scaffold.kinds.consert import consert as model
from eddi_scaffold.kinds.consert.graph import constants
from eddi_scaffold.kinds.consert.ranges import common, is_inside, span

Ref = tuple[str, str]  # Instance name and id


@dataclass(frozen=True)
class Composition:
    """What came of putting ConSerts together."""

    # every demand and required service is met, and no ConSerts wait for each other
    composable: bool
    # instance names, providers first; those that could not be accepted are missing
    order: tuple[str, ...]
    # (instance, demand) -> (instance, guarantee) pairs that fulfil it, none of which depends on the
    # instance itself
    bindings: Mapping[Ref, tuple[Ref, ...]]
    # ids of demands that no ConSert in the set fulfils, as `INSTANCE/ID` where several instances
    # have a demand of that id
    unmatched_demands: tuple[str, ...]
    # ids of required services that no ConSert in the set provides, likewise
    unmatched_services: tuple[str, ...]
    reasons: tuple[str, ...]  # one sentence for each obstacle
    # services that a file allocates to one that does not do (X009)
    problems: tuple[Problem, ...] = ()

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
        return (
            [*lines, "reasons:", *(f"  {text}" for text in self.reasons)] if self.reasons else lines
        )


@dataclass
class _Need:
    """A demand or a required service."""

    instance: str
    id: str
    is_demand: bool
    types: Sequence[str]  # of the service, and of the dimensions of a demand
    reason: str = ""  # why it is not met
    # instance that can meet it -> guarantees of it that do
    met_by: dict[str, list[str]] = field(default_factory=dict)

    @property
    def name(self) -> str:
        return f"{self.instance}/{self.id}"


def compose(instances: Sequence[tuple[str, model.ConSert]]) -> Composition:
    """Put ConSerts together, each under a name; a model may be there several times.

    Raises:
        EddiError: two instances have one name (C007).
    """
    names = [name for name, _ in instances]
    repeated = next((name for name in names if names.count(name) > 1), None)
    if repeated is not None:
        raise EddiError(problem("C007.instances", name=repeated))
    return _Composer(instances).composition()


class _Composer:
    def __init__(self, instances: Sequence[tuple[str, model.ConSert]]) -> None:
        self.instances = instances
        self.provided = {
            (service.functional_service_type, name)
            for name, consert in instances
            for service in consert.provided_services
        }
        self.offers: list[tuple[str, model.Guarantee, Mapping[str, None]]] = []
        for name, consert in instances:
            types, values = service_types(consert.provided_services), constants(consert)
            for guarantee in consert.guarantees:
                if values[guarantee.id] is not False:  # what can never hold fulfils nothing
                    self.offers.append((name, guarantee, types.get(guarantee.id, {})))
        self.needs: list[_Need] = []
        for name, consert in instances:
            types = service_types(consert.required_services)
            for demand in consert.demands:
                self.needs.append(self._demand(name, demand, types.get(demand.id, {})))
        for name, consert in instances:
            for service in consert.required_services:
                type_ = service.functional_service_type
                others = sorted(name for of, name in self.provided if of == type_)
                met_by: dict[str, list[str]] = {other: [] for other in others if other != name}
                reason = f"required service {name}/{service.id} is not provided: "
                reason += f"no other ConSert provides a service of type {type_}"
                self.needs.append(_Need(name, service.id, False, [type_], reason, met_by))
        # What needs only what has been accepted is accepted, in rounds; instance -> its round.
        self.rounds: dict[str, int] = {}
        while True:
            unmet = (n.instance for n in self.needs if self.rounds.keys().isdisjoint(n.met_by))
            waiting = {*unmet, *self.rounds}
            ready = [name for name, _ in instances if name not in waiting]
            if not ready:
                return
            self.rounds |= dict.fromkeys(ready, len(self.rounds))

    def composition(self) -> Composition:
        rounds = dict.fromkeys(dict(self.instances), len(self.instances)) | self.rounds
        count = Counter((need.is_demand, need.id) for need in self.needs)
        unmatched = {
            is_demand: tuple(
                need.id if count[is_demand, need.id] == 1 else need.name
                for need in self.needs
                if need.is_demand == is_demand and not need.met_by
            )
            for is_demand in (True, False)
        }
        return Composition(
            composable=len(self.rounds) == len(self.instances),
            order=tuple(self.rounds),
            # to guarantees of earlier rounds, so that no ConSert leans on itself
            bindings={
                (need.instance, need.id): tuple(
                    (other, id_)
                    for other, ids in need.met_by.items()
                    if rounds[other] < rounds[need.instance]
                    for id_ in ids
                )
                for need in self.needs
                if need.is_demand and need.met_by
            },
            unmatched_demands=unmatched[True],
            unmatched_services=unmatched[False],
            reasons=tuple(self._reasons()),
            problems=tuple(self._wrong_allocations()),
        )

    def _demand(self, instance: str, demand: model.Demand, types: Mapping[str, None]) -> _Need:
        dimension_types = (dimension.type for dimension in demand.dimensions)
        need = _Need(instance, demand.id, is_demand=True, types=[*types, *dimension_types])
        mismatches = []
        for other, guarantee, offered_types in self.offers:
            if other == instance or (types and types.keys().isdisjoint(offered_types)):
                continue
            difference = _mismatch(guarantee, demand, f"{other}/{guarantee.id}")
            if difference is None:
                need.met_by.setdefault(other, []).append(guarantee.id)
            else:
                mismatches.append(difference)
        reason = "no other ConSert guarantees anything"
        if mismatches:
            reason = min(mismatches, key=itemgetter(0))[1]
        elif types:
            reason += f" in a service of type {' or '.join(types)}"
        need.reason = f"demand {need.name} is not fulfilled: {reason}"
        return need

    def _reasons(self) -> Iterator[str]:
        """Yield why needs are not met; a type that nobody has may be a slip."""
        known = {type_ for type_, _ in self.provided}
        for _, guarantee, _ in self.offers:
            known |= {dimension.type for dimension in guarantee.dimensions}
        similar = SimilarNames(known)
        for need in self.needs:
            if not need.met_by:
                hints = [similar.hint(type_) for type_ in need.types if type_ not in known]
                yield "; ".join(filter(None, (need.reason, *hints)))
        waits: dict[str, tuple[str, ...]] = {name: () for name, _ in self.instances}
        for need in self.needs:  # they wait for others that cannot be accepted, or for each other
            if need.instance not in self.rounds and self.rounds.keys().isdisjoint(need.met_by):
                waits[need.instance] = (*waits[need.instance], *need.met_by)
        for name, others in waits.items():
            if others:
                names = " or ".join(dict.fromkeys(others))
                yield f"{name} waits for {names}, which cannot be accepted"
        for cycle in cycles(waits):
            chain = " -> ".join([*cycle, cycle[0]])
            yield f"these ConSerts wait for each other (provider -> user): {chain}"

    def _wrong_allocations(self) -> Iterator[Problem]:
        """Yield where a file allocates a service to one that does not fulfil all of its demands."""
        met_by = {(need.instance, need.id): need.met_by for need in self.needs if need.is_demand}
        provided = [
            (name, s) for name, consert in self.instances for s in consert.provided_services
        ]
        at = {service.place: (name, service) for name, service in provided}
        by_required = {place: pair for pair in provided for place in pair[1].allocated}
        for name, consert in self.instances:
            for service in consert.required_services:
                pairs = [at[place] for place in service.allocated if place in at]
                pairs += [by_required[service.place]] if service.place in by_required else []
                for other, provider in dict(pairs).items():
                    offered = set(provider.members)
                    members = service.members
                    unmet = [
                        m for m in members if offered.isdisjoint(met_by[name, m].get(other, ()))
                    ]
                    if unmet:
                        what = f"{name}/{service.id} is allocated to {other}/{provider.id}"
                        text = ", ".join(unmet)
                        yield problem("X009.unmet", service.place, subject=what, unmet=text)


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
    difference = _mismatch(guarantee, demand, name)
    return None if difference is None else difference[1]


def _mismatch(
    guarantee: model.Guarantee, demand: model.Demand, name: str
) -> tuple[tuple[int, int], str] | None:
    """Return how far a guarantee is from fulfilling a demand, and its first dimension in the way.

    Every dimension of the demand needs one of the guarantee with the same kind and type, whose
    covered values fit in the direction of the demand's subset flag; a flag of the guarantee must be
    the same, and further dimensions of the guarantee do not matter.
    """
    missing: list[tuple[int, str]] = []
    for dimension in demand.dimensions:
        reasons = [(3, f"{name} has no dimension")] if not guarantee.dimensions else []
        for offered in guarantee.dimensions:
            reason = _difference(offered, dimension, name, demand.id)
            if reason is None:
                break
            reasons.append(reason)
        else:
            missing.append(min(reasons, key=itemgetter(0)))
    if not missing:
        return None
    return (len(missing), sum(rank for rank, _ in missing)), missing[0][1]


def _difference(
    offered: model.Dimension, demanded: model.Dimension, name: str, demand: str
) -> tuple[int, str] | None:
    """Explain why a dimension does not fit; the rank grows with the difference."""
    title = f"dimension {demanded.type}"
    kind = type(demanded).__name__.removesuffix("Dimension")
    if type(offered) is not type(demanded) or offered.type != demanded.type:
        return 3, f"{name} has no {kind} {title}"
    if isinstance(demanded, model.BinaryDimension) or isinstance(offered, model.BinaryDimension):
        value = str(not isinstance(demanded, model.BinaryDimension) or demanded.value).lower()
        no_value = 3, f"{name} has no Binary {title} of the value {value}"
        return None if offered == demanded else no_value
    if offered.subset not in (None, demanded.subset):
        subsets = f"{offered.subset} in {name} and {demanded.subset} in {demand}"
        return 2, f"{title}: the subset is {subsets}"
    their_units = [
        d.uom if isinstance(d, model.NumericDimension) else None for d in (offered, demanded)
    ]
    if units.factor(*their_units) is None:
        texts = [f"the unit {unit}" if unit else "the ratio" for unit in their_units]
        return 2, f"{title}: {texts[0]} of {name} and {texts[1]} of {demand} do not compare"
    if isinstance(demanded, model.NumericDimension) and isinstance(offered, model.NumericDimension):
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
        return None
    sides = [f"{demanded.covered_text} of {demand}", f"{offered.covered_text} of {name}"]
    if demanded.subset == "Guarantee":
        sides.reverse()
    return 1, f"{title}: {sides[0]} {relation} {sides[1]}"
