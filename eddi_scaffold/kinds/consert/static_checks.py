"""Static checks of one ConSert, S001 to S007: what its author may not have meant.

They report what follows from the trees, regardless of the evidence: constants, redundancy,
implication and single points of failure. Findings that need more than :data:`graph.CAP` path sets
are left out, and S000 reports it.
"""

from __future__ import annotations

from itertools import permutations
from typing import TYPE_CHECKING

from eddi_scaffold.common.graphs import reached, reversed_graph
from eddi_scaffold.common.problems import Problem, problem
from eddi_scaffold.kinds.consert.graph import (
    CAP,
    Sets,
    Work,
    constants,
    implies,
    inputs_of,
    leaves_of,
    path_sets,
    redundant_inputs,
)
from eddi_scaffold.yaml_text.nodes import shown

if TYPE_CHECKING:
    from collections.abc import Iterator

    from eddi_scaffold.kinds.consert.model import ConSert, Guarantee, ProvidedService


_MOST_GUARANTEES = 64
"""Guarantees of one service that are compared with each other."""


def static_checks(consert: ConSert) -> list[Problem]:
    """Return the findings about a checked ConSert that need no run."""
    sets = path_sets(consert)
    guarantees = {guarantee.id: guarantee for guarantee in consert.guarantees}
    return [
        *_constant(consert),
        *_not_checked(consert, sets),
        *_redundant_leaves(consert, sets),
        *_redundant_gates(consert, sets),
        *_equal(consert, sets),
        *(
            problem
            for service in consert.provided_services
            for problem in _service(consert, service, guarantees, sets)
        ),
    ]


def _constant(consert: ConSert) -> Iterator[Problem]:
    inputs, values = inputs_of(consert), constants(consert)
    for guarantee in consert.guarantees:
        value = values[guarantee.id]
        # without any input C011 is reported
        if value is not None and not guarantee.default and inputs[guarantee.id]:
            fate = "always active" if value else "never active"
            yield problem("S001", guarantee.place, guarantee=shown(guarantee.id), fate=fate)


def _not_checked(consert: ConSert, sets: dict[str, Sets | None]) -> Iterator[Problem]:
    for guarantee in consert.guarantees:
        if sets[guarantee.id] is None:
            name = f"guarantee {shown(guarantee.id)}"
            yield problem("S000", guarantee.place, name=name, limit=CAP)


def _redundant_leaves(consert: ConSert, sets: dict[str, Sets | None]) -> Iterator[Problem]:
    inputs = inputs_of(consert)
    used, silent = 0, []
    for guarantee in consert.guarantees:
        found = sets[guarantee.id]
        if found is None:
            silent.append(guarantee.id)
        for mask in found or ():
            used |= mask
    reachable = reached(inputs, (g.id for g in consert.guarantees))
    unknown = reached(inputs, silent)
    places = {n.id: n.place for group in (consert.evidence, consert.demands) for n in group}
    for index, id_ in enumerate(leaves_of(consert)):
        if id_ in reachable and id_ not in unknown and not used >> index & 1:
            yield problem("S002.element", places[id_], id=shown(id_))


def _redundant_gates(consert: ConSert, sets: dict[str, Sets | None]) -> Iterator[Problem]:
    inputs, work = inputs_of(consert), Work()
    ors = {gate.id for gate in consert.gates if gate.function == "Or"}
    nodes = [node.id for group in (consert.gates, consert.guarantees) for node in group]
    idle = {id_: redundant_inputs(id_, inputs, sets, is_or=id_ in ors, work=work) for id_ in nodes}
    reachable = reached(inputs, (g.id for g in consert.guarantees))
    targets = reversed_graph(inputs)
    for gate in consert.gates:
        fed = [target for target in targets[gate.id] if target in reachable]
        if fed and inputs[gate.id] and all(gate.id in idle[target] for target in fed):
            yield problem("S002.gate", gate.place, gate=shown(gate.id))


def _equal(consert: ConSert, sets: dict[str, Sets | None]) -> Iterator[Problem]:
    first: dict[Sets, Guarantee] = {}
    for guarantee in consert.guarantees:
        found = sets[guarantee.id]
        if not found or 0 in found:  # unknown or constant
            continue
        before = first.setdefault(found, guarantee)
        if before is not guarantee:
            names = f"{shown(before.id)} and {shown(guarantee.id)}"
            yield problem("S003.same", guarantee.place, names=names)


def _service(
    consert: ConSert,
    service: ProvidedService,
    guarantees: dict[str, Guarantee],
    sets: dict[str, Sets | None],
) -> Iterator[Problem]:
    members = [guarantees[id_] for id_ in service.guarantees]
    defaults = [g.id for g in members if g.default]
    if len(defaults) > 1:
        names = ", ".join(map(shown, defaults))
        yield problem("S005.defaults", service.place, service=shown(service.id), names=names)
    others = [g for g in members if not g.default]
    yield from _implications(others[:_MOST_GUARANTEES], sets)
    yield from _single_points(consert, service, others, sets)


def _implications(members: list[Guarantee], sets: dict[str, Sets | None]) -> Iterator[Problem]:
    for strong, weak in permutations(members, 2):
        first, second = sets[strong.id], sets[weak.id]
        if not first or not second or first == second or 0 in second:
            continue
        if implies(first, second):
            ids = {"strong": shown(strong.id), "weak": shown(weak.id)}
            yield problem("S003.implies", strong.place, **ids)
            if None not in (strong.ranking, weak.ranking) and (weak.ranking or 0) < (
                strong.ranking or 0
            ):
                yield problem("S005.dominated", strong.place, **ids)


def _single_points(
    consert: ConSert,
    service: ProvidedService,
    members: list[Guarantee],
    sets: dict[str, Sets | None],
) -> Iterator[Problem]:
    found = [sets[guarantee.id] for guarantee in members]
    if not found or None in found:
        return
    common = ~0
    masks = [mask for one in found for mask in one or ()]
    for mask in masks:
        common &= mask
    if not masks:
        return
    for index, id_ in enumerate(leaves_of(consert)):
        if common >> index & 1:
            message = f"provided service {shown(service.id)} needs {shown(id_)} in every case"
            end = "without it no guarantee of the service is active"
            yield problem("S007", service.place, message=message, end=end)
