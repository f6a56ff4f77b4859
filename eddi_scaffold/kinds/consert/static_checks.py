"""Static checks of one ConSert, S001 to S007: what its author may not have meant.

They report what follows from the trees, regardless of the evidence: constants, redundancy,
implication and single points of failure. Findings that need more than :data:`graph.MOST_SETS` path
sets are left out, and S000 reports it.
"""

from __future__ import annotations

from collections.abc import Iterator
from functools import reduce
from itertools import permutations
from operator import and_, or_

from eddi_scaffold.common.graphs import reached, reversed_graph
from eddi_scaffold.common.problems import Problem, problem
from eddi_scaffold.kinds.consert import graph
from eddi_scaffold.kinds.consert.consert import ConSert, Guarantee
from eddi_scaffold.yaml_text.nodes import shown

_MOST_GUARANTEES = 64  # Guarantees of one service that are compared with each other


def static_checks(consert: ConSert) -> list[Problem]:
    """Return the findings about a checked ConSert that need no run."""
    checks = _StaticChecks(consert)
    return [
        *checks.constants(),
        *checks.redundant_leaves(),
        *checks.redundant_gates(),
        *checks.equal_guarantees(),
        *checks.services(),
    ]


class _StaticChecks:
    def __init__(self, consert: ConSert) -> None:
        self.consert = consert
        self.sets = graph.path_sets(consert)
        self.supporting = reached(consert.inputs, (node.id for node in consert.guarantees))

    def constants(self) -> Iterator[Problem]:
        values = graph.constants(self.consert)
        for guarantee in self.consert.guarantees:
            value, name = values[guarantee.id], shown(guarantee.id)
            # without any input C011 is reported
            is_written = not guarantee.default and self.consert.inputs[guarantee.id]
            if value is not None and is_written:
                fate = "always active" if value else "never active"
                yield problem("S001", guarantee.place, guarantee=name, fate=fate)
            if self.sets[guarantee.id] is None:
                yield problem(
                    "S000", guarantee.place, name=f"guarantee {name}", limit=graph.MOST_SETS
                )

    def redundant_leaves(self) -> Iterator[Problem]:
        sets_of_guarantees = {node.id: self.sets[node.id] for node in self.consert.guarantees}
        used = reduce(or_, (mask for sets in sets_of_guarantees.values() for mask in sets or ()), 0)
        unknown = [id_ for id_, sets in sets_of_guarantees.items() if sets is None]
        unclear = reached(self.consert.inputs, unknown)
        compared = self.supporting - unclear
        for index, leaf in enumerate(self.consert.leaf_nodes):
            if leaf.id in compared and not used >> index & 1:
                yield problem("S002.element", leaf.place, id=shown(leaf.id))

    def redundant_gates(self) -> Iterator[Problem]:
        inputs, work = self.consert.inputs, graph.Work()
        ors = {gate.id for gate in self.consert.gates if gate.function == "Or"}
        redundant = {
            id_: graph.redundant_inputs(sources, self.sets, self.sets[id_], id_ in ors, work)
            for id_, sources in inputs.items()
        }
        targets = reversed_graph(inputs)
        for gate in self.consert.gates:
            supported = [target for target in targets[gate.id] if target in self.supporting]
            is_redundant = all(gate.id in redundant[target] for target in supported)
            if supported and inputs[gate.id] and is_redundant:
                yield problem("S002.gate", gate.place, gate=shown(gate.id))

    def equal_guarantees(self) -> Iterator[Problem]:
        first: dict[graph.Sets, Guarantee] = {}
        for guarantee in self.consert.guarantees:
            sets = self.sets[guarantee.id]
            if not sets or 0 in sets:  # unknown or constant
                continue
            before = first.setdefault(sets, guarantee)
            if before is not guarantee:
                names = f"{shown(before.id)} and {shown(guarantee.id)}"
                yield problem("S003.same", guarantee.place, names=names)

    def services(self) -> Iterator[Problem]:
        guarantees = {guarantee.id: guarantee for guarantee in self.consert.guarantees}
        for service in self.consert.provided_services:
            members = [guarantees[id_] for id_ in service.members]
            others = [guarantee for guarantee in members if not guarantee.default]
            defaults = [shown(guarantee.id) for guarantee in members if guarantee.default]
            name = shown(service.id)
            if len(defaults) > 1:
                yield problem(
                    "S005.defaults", service.place, service=name, names=", ".join(defaults)
                )
            for strong, weak in permutations(others[:_MOST_GUARANTEES], 2):
                yield from self._implication(strong, weak)
            sets = [self.sets[guarantee.id] for guarantee in others]
            masks = [mask for masks in sets for mask in masks or ()]
            # the leaves without which none of these guarantees is active
            common = reduce(and_, masks) if masks and None not in sets else 0
            for id_ in graph.leaves_in(self.consert, common):
                yield problem("S007", service.place, service=name, id=shown(id_))

    def _implication(self, strong: Guarantee, weak: Guarantee) -> Iterator[Problem]:
        first, second = self.sets[strong.id], self.sets[weak.id]
        if not first or not second or first == second or 0 in second:
            return
        if graph.implies(first, second):
            ids = {"strong": shown(strong.id), "weak": shown(weak.id)}
            yield problem("S003.implies", strong.place, **ids)
            rankings = (weak.ranking, strong.ranking)
            if None not in rankings and (weak.ranking or 0) < (strong.ranking or 0):
                yield problem("S005.dominated", strong.place, **ids)
