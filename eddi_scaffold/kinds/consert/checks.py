"""Checks of one ConSert: what is wrong (C006 to C023), what nobody may have meant (S000 to S007).

The latter follow from the trees, whatever the evidence: constants, redundancy, implication and
single points of failure. Where these need more than :data:`graph.MOST_SETS` path sets they are left
out, and S000 reports it.
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterable, Iterator
from dataclasses import replace
from functools import reduce
from itertools import permutations
from operator import and_, or_
from typing import Any

from eddi_scaffold.common import units
from eddi_scaffold.common.graphs import cycles, reached
from eddi_scaffold.common.identifiers import attribute
from eddi_scaffold.common.problems import Place, Problem, SimilarNames, problem
from eddi_scaffold.kinds.consert import consert as model
from eddi_scaffold.kinds.consert import graph, names
from eddi_scaffold.kinds.consert.ranges import is_empty, overlap
from eddi_scaffold.yaml_text.nodes import shown

_LONGEST_CYCLE = 12
_NO_UNIT = 'write its unit, such as `uom: percent`; `uom: ""` is a ratio, 0.2 for 20 %'


def check_consert(consert: model.ConSert) -> tuple[model.ConSert | None, list[Problem]]:
    """Check what the elements of a ConSert mean together.

    Returns:
        The ConSert without repeated edges, ``None`` where something of it has no meaning; one of
        which only something is missing (C011, C014) can be shown. And all problems.
    """
    problems = [
        *_check_dimensions(consert),
        *_check_graph(consert),
        *_check_names(consert),
        *_check_services(consert),
    ]
    if any(
        problem.level == "error" and problem.code not in ("C011", "C014") for problem in problems
    ):
        return None, problems
    leaves = set(consert.leaves)
    edges: dict[tuple[str, str], model.Propagation] = {}
    for edge in consert.tree_propagations:
        if edge.target not in leaves:
            edges.setdefault((edge.source, edge.target), edge)
    return replace(consert, tree_propagations=tuple(edges.values())), problems


def _check_graph(consert: model.ConSert) -> Iterator[Problem]:
    """Check the ids of the nodes and the edges between them."""
    for group in (consert.nodes, consert.required_services, consert.provided_services):
        yield from _repeated_ids(group)
    if not consert.guarantees:
        yield problem("C014.no_guarantees", consert.place, consert=shown(consert.name))
    kinds = {node.id: node.kind for node in consert.nodes}
    edge_problems = list(_check_edges(consert, kinds))
    yield from edge_problems
    if len(kinds) < len(consert.nodes):  # what follows would be guesswork
        return
    edges = {(edge.source, edge.target): edge for edge in reversed(consert.tree_propagations)}
    for cycle in cycles(consert.inputs):
        path = [*cycle, cycle[0]]
        place = edges[path[0], path[1]].place
        if len(path) > _LONGEST_CYCLE:
            omitted = f"({len(path) - _LONGEST_CYCLE} more)"
            path = [*path[: _LONGEST_CYCLE - 1], omitted, path[-1]]
        yield problem("C010", place, names=" -> ".join(path))
    # an edge that leads nowhere leaves alone what it was meant to join: that is not reported again
    if all(problem.code != "C008" for problem in edge_problems):
        yield from _check_support(consert)


def _repeated_ids(nodes: Iterable[Any]) -> Iterator[Problem]:
    first: dict[str, Any] = {}
    for node in sorted(nodes, key=lambda node: (node.place.line or 0, node.place.col or 0)):
        before = first.setdefault(node.id, node)
        if before is not node:
            fields = {"id": shown(node.id), "kind": node.kind, "before": before.kind}
            place = before.place
            there = f"line {place.line}" if place.line else place.path or "the same model"
            there += f", column {place.col}" if place.line and place.col else ""
            yield problem("C007.duplicate", node.place, **fields, there=there)


def _check_edges(consert: model.ConSert, kinds: dict[str, str]) -> Iterator[Problem]:
    seen: set[tuple[str, str]] = set()
    similar, leaves = SimilarNames(kinds), set(consert.leaves)
    for edge in consert.tree_propagations:
        text = f"edge from {shown(edge.source)} to {shown(edge.target)}"
        if edge.source not in kinds:
            hint, source = similar.hint(edge.source), shown(edge.source)
            yield problem("C008.no_source", edge.place, hint=hint, text=text, source=source)
        if edge.target not in kinds:
            hint, target = similar.hint(edge.target), shown(edge.target)
            yield problem("C008.no_target", edge.place, hint=hint, text=text, target=target)
        elif edge.target in leaves:
            kind = kinds[edge.target]
            yield problem("C011.no_support_possible", edge.place, text=text, kind=kind)
        if (edge.source, edge.target) in seen:
            yield problem("C023.edge_twice", edge.place, text=text)
        seen.add((edge.source, edge.target))


def _check_support(consert: model.ConSert) -> Iterator[Problem]:
    """Check which nodes have inputs, and which are inputs of others."""
    inputs = consert.inputs
    for guarantee in consert.guarantees:
        name, has_support = f"guarantee {shown(guarantee.id)}", bool(inputs[guarantee.id])
        if guarantee.default and has_support:
            yield problem("C011.default_with_support", guarantee.place, name=name)
        elif not guarantee.default and not has_support:
            # an EDDI has no such flag
            mark = "" if guarantee.place.path else "`default: true` or "
            id_ = guarantee.id
            yield problem("C011.no_support", guarantee.place, name=name, mark=mark, guarantee=id_)
    supporting = reached(inputs, (guarantee.id for guarantee in consert.guarantees))
    for gate in consert.gates:
        if len(inputs[gate.id]) == 1:
            yield problem("C023.one_input", gate.place, gate=shown(gate.id))
        if not inputs[gate.id] and gate.id in supporting:
            constant = {"And": "TRUE", "Or": "FALSE"}[gate.function]
            case = "C011.gate_without_input"
            yield problem(case, gate.place, gate=shown(gate.id), constant=constant)
    for node in consert.nodes if consert.guarantees else ():
        if node.id not in supporting:
            yield problem("C014.supports_nothing", node.place, kind=node.kind, id=shown(node.id))


def _check_dimensions(consert: model.ConSert) -> Iterator[Problem]:
    """Check every dimension of evidence, demands and guarantees."""
    of_services = {id_ for service in consert.required_services for id_ in service.members}
    for node in consert.nodes:
        if isinstance(node, model.Gate):
            continue
        what = f"{node.kind} {shown(node.id)}"
        if not node.dimensions and node.kind == "demand" and node.id not in of_services:
            yield problem("C006.asks_nothing", node.place, subject=what)
        for dimension in node.dimensions:
            place = node.place if dimension.place.line is None else dimension.place
            if isinstance(dimension, model.BinaryDimension):
                continue
            if not dimension.covered:
                type_ = shown(dimension.type)
                yield problem("C006.covers_nothing", place, type=type_, subject=what)
            if isinstance(dimension, model.NumericDimension):
                yield from _check_numbers(dimension, what, place)


def _check_numbers(dimension: model.NumericDimension, what: str, place: Place) -> Iterator[Problem]:
    problems = []
    for covered in dimension.covered:
        here = place if covered.place.line is None else covered.place
        if math.isnan(covered.start.value) or math.isnan(covered.end.value):
            problems.append(problem("C006.bound", here, subject=what))
        elif is_empty(covered):
            name = covered.text()
            problems.append(problem("C006.empty_range", here, name=name, subject=what))
    yield from problems
    for first, second in overlap(dimension.covered) if not problems else ():
        here = place if second.place.line is None else second.place
        texts = {"first": first.text(), "second": second.text()}
        yield problem("C023.overlap", here, **texts, subject=what)
    unit = dimension.uom
    if unit is None:
        type_ = shown(dimension.type)
        yield problem("C016.no_unit", place, hint=_NO_UNIT, type=type_, subject=what)
    elif units.find(unit) is None:
        hint = "write percent" if unit == "%" else None
        fields = {"unit": shown(unit), "subject": what, "units": units.listed()}
        yield problem("C016.unknown_unit", place, hint=hint, **fields)


def _check_names(consert: model.ConSert) -> Iterator[Problem]:
    """Check that inputs can be attributes, and guarantees classes as in SESAME D7.2."""
    places = {node.id: node.place for node in consert.nodes}
    inputs = {node.id: node.place for node in consert.leaf_nodes}
    for id_, place in places.items():
        if not id_:
            yield problem("C018.empty", place)
        elif not re.search("[A-Za-z0-9]", id_):  # of which a name could be made
            yield problem("C018.no_identifier", place, id=shown(id_))
        elif id_ in inputs and attribute(id_) != id_:
            yield problem("C018.attribute", place, id=shown(id_), identifier=attribute(id_))
        elif names.is_reserved(name := names.class_name(id_)):
            class_name = names.published_class(id_)
            yield problem("C018.class", place, name=name, id=shown(id_), identifier=class_name)
    reported: set[str] = set()
    classes = ("class name", names.class_name, places)
    for kind, name_of, ids in (classes, ("attribute", attribute, inputs)):
        first: dict[str, str] = {}
        for id_, place in ids.items():
            before = first.setdefault(name_of(id_), id_)
            if name_of(id_) and before != id_ and id_ not in reported:  # once for each pair
                reported.add(id_)
                fields = {"before": shown(before), "id": shown(id_), "kind": kind}
                yield problem("C007.same_identifier", place, **fields, identifier=name_of(id_))


def _check_services(consert: model.ConSert) -> Iterator[Problem]:
    """Check that services name guarantees and demands, and demands have a service."""
    ids = {"demand": {node.id for node in consert.demands}}
    ids["guarantee"] = {node.id for node in consert.guarantees}
    similar = {kind: SimilarNames(sorted(known)) for kind, known in ids.items()}
    for service in consert.services:
        kind, name = service.member_kind, f"{service.kind} {shown(service.id)}"
        if not service.members:
            yield problem("C014.nothing_inside", service.place, name=name, element=kind)
        for member in dict.fromkeys(service.members):
            if member not in ids[kind]:
                fields = {"name": name, "kind": kind, "member": shown(member)}
                hint = similar[kind].hint(member)
                yield problem("C008.unknown_member", service.place, hint=hint, **fields)
    of_services = {id_ for service in consert.required_services for id_ in service.members}
    for demand in consert.demands:
        if demand.id not in of_services:
            yield problem("C014.no_service", demand.place, demand=shown(demand.id))


_MOST_GUARANTEES = 64  # Guarantees of one service that are compared with each other


def static_checks(consert: model.ConSert) -> list[Problem]:
    """Return the findings about a checked ConSert that need no run."""
    checks = _StaticChecks(consert)
    return [
        *checks.constants(),
        *checks.redundant_leaves(),
        *checks.services(),
    ]


class _StaticChecks:
    def __init__(self, consert: model.ConSert) -> None:
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

    def _implication(self, strong: model.Guarantee, weak: model.Guarantee) -> Iterator[Problem]:
        first, second = self.sets[strong.id], self.sets[weak.id]
        if not first or not second or first == second or 0 in second:
            return
        if graph.implies(first, second):
            ids = {"strong": shown(strong.id), "weak": shown(weak.id)}
            yield problem("S003.implies", strong.place, **ids)
            rankings = (weak.ranking, strong.ranking)
            if None not in rankings and (weak.ranking or 0) < (strong.ranking or 0):
                yield problem("S005.dominated", strong.place, **ids)
