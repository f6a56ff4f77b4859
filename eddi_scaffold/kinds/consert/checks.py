"""Checks of one ConSert: what is wrong (C006 to C018), what nobody may have meant (S000 to S007).

The latter follow from the trees, whatever the evidence: constants, redundancy, implication and
single points of failure. Where these need more than :data:`graph.MOST_SETS` path sets they are left
out, and S000 reports it.
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterable, Iterator, Mapping
from functools import reduce
from itertools import permutations
from operator import and_, or_
from typing import Any

from eddi_scaffold.common import units
from eddi_scaffold.common.graphs import cycles, reached
from eddi_scaffold.common.identifiers import attribute
from eddi_scaffold.common.problems import Place, Problem, SimilarNames, problem
from eddi_scaffold.kinds.consert import consert as model
from eddi_scaffold.kinds.consert import graph, published_class
from eddi_scaffold.kinds.consert.ranges import is_empty
from eddi_scaffold.yaml_text.nodes import shown

_MOST_GUARANTEES = 64  # of one service that are compared with each other


def check_consert(consert: model.ConSert) -> Iterator[Problem]:
    """Yield what is wrong with what the elements of a ConSert mean together."""
    of_services = {id_ for service in consert.required_services for id_ in service.members}
    for node in (*consert.leaf_nodes, *consert.guarantees):
        what = f"{node.kind} {shown(node.id)}"
        if not node.dimensions and node.kind == "demand" and node.id not in of_services:
            yield problem("C006.asks_nothing", node.place, subject=what)
        for dimension in node.dimensions:
            place = node.place if dimension.place.line is None else dimension.place
            if not isinstance(dimension, model.BinaryDimension) and not dimension.covered:
                type_ = shown(dimension.type)
                yield problem("C006.covers_nothing", place, type=type_, subject=what)
            if isinstance(dimension, model.NumericDimension):
                yield from _check_numbers(dimension, what, place)
    yield from _check_graph(consert)
    yield from _check_names(consert)
    yield from _check_services(consert, of_services)


def _check_numbers(dimension: model.NumericDimension, what: str, place: Place) -> Iterator[Problem]:
    for covered in dimension.covered:
        here = place if covered.place.line is None else covered.place
        if math.isnan(covered.start.value) or math.isnan(covered.end.value):
            yield problem("C006.bound", here, subject=what)
        elif is_empty(covered):
            yield problem("C006.empty_range", here, name=covered.text(), subject=what)
    unit = dimension.uom
    if unit is None:
        yield problem("C016.no_unit", place, type=shown(dimension.type), subject=what)
    elif units.find(unit) is None:
        hint = "write percent" if unit == "%" else None
        fields = {"unit": shown(unit), "subject": what, "units": units.listed()}
        yield problem("C016.unknown_unit", place, hint=hint, **fields)


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
        yield problem("C010", edges[path[0], path[1]].place, names=" -> ".join(path))
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
            yield problem("C007.duplicate", node.place, **fields, there=there)


def _check_edges(consert: model.ConSert, kinds: Mapping[str, str]) -> Iterator[Problem]:
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


def _check_support(consert: model.ConSert) -> Iterator[Problem]:
    """Check which nodes have inputs, and which are inputs of others."""
    inputs = consert.inputs
    for guarantee in consert.guarantees:
        name, has_support = f"guarantee {shown(guarantee.id)}", bool(inputs[guarantee.id])
        if guarantee.default and has_support:
            yield problem("C011.default_with_support", guarantee.place, name=name)
        elif not guarantee.default and not has_support:
            yield problem("C011.no_support", guarantee.place, name=name, guarantee=guarantee.id)
    supporting = reached(inputs, (guarantee.id for guarantee in consert.guarantees))
    for gate in consert.gates:
        if not inputs[gate.id] and gate.id in supporting:
            constant = {"And": "TRUE", "Or": "FALSE"}[gate.function]
            case = "C011.gate_without_input"
            yield problem(case, gate.place, gate=shown(gate.id), constant=constant)
    for node in consert.nodes if consert.guarantees else ():
        if node.id not in supporting:
            yield problem("C014.supports_nothing", node.place, kind=node.kind, id=shown(node.id))


def _check_names(consert: model.ConSert) -> Iterator[Problem]:
    """Check that inputs can be attributes, and guarantees classes as in SESAME D7.2."""
    for node in consert.nodes:
        if not node.id:
            yield problem("C018.empty", node.place)
        elif not re.search("[A-Za-z0-9]", node.id):  # of which a name could be made
            yield problem("C018.no_identifier", node.place, id=shown(node.id))
        elif node.kind in ("evidence", "demand") and attribute(node.id) != node.id:
            fields = {"id": shown(node.id), "identifier": attribute(node.id)}
            yield problem("C018.attribute", node.place, **fields)
    classes = ("class name", published_class, consert.guarantees)
    for kind, name_of, nodes in (classes, ("attribute", attribute, consert.leaf_nodes)):
        first: dict[str, str] = {}
        for node in nodes:
            before = first.setdefault(name_of(node.id), node.id)
            if before != node.id:
                fields = {"before": shown(before), "id": shown(node.id), "kind": kind}
                name = name_of(node.id)
                yield problem("C007.same_identifier", node.place, **fields, identifier=name)


def _check_services(consert: model.ConSert, of_services: set[str]) -> Iterator[Problem]:
    """Check that services name guarantees and demands, and demands have a service."""
    ids = {"demand": {node.id for node in consert.demands}}
    ids["guarantee"] = {node.id for node in consert.guarantees}
    similar = {kind: SimilarNames(sorted(known)) for kind, known in ids.items()}
    for service in consert.services:
        kind, name = service.member_kind, f"{service.kind} {shown(service.id)}"
        if not service.members:
            yield problem("C014.nothing_inside", service.place, name=name, element=kind)
        for member in service.members:
            if member not in ids[kind]:
                fields = {"name": name, "kind": kind, "member": shown(member)}
                hint = similar[kind].hint(member)
                yield problem("C008.unknown_member", service.place, hint=hint, **fields)
    for demand in consert.demands:
        if demand.id not in of_services:
            yield problem("C014.no_service", demand.place, demand=shown(demand.id))


def static_checks(consert: model.ConSert) -> Iterator[Problem]:
    """Yield the findings about a checked ConSert that need no run."""
    sets, values = graph.path_sets(consert), graph.constants(consert)
    for guarantee in consert.guarantees:
        value, name = values[guarantee.id], shown(guarantee.id)
        # without any input C011 is reported
        if value is not None and not guarantee.default and consert.inputs[guarantee.id]:
            fate = "always active" if value else "never active"
            yield problem("S001", guarantee.place, guarantee=name, fate=fate)
        if sets[guarantee.id] is None:
            yield problem("S000", guarantee.place, name=f"guarantee {name}", limit=graph.MOST_SETS)
    ids = [guarantee.id for guarantee in consert.guarantees]
    used = reduce(or_, (mask for id_ in ids for mask in sets[id_] or ()), 0)
    unclear = reached(consert.inputs, (id_ for id_ in ids if sets[id_] is None))
    compared = reached(consert.inputs, ids) - unclear
    for index, leaf in enumerate(consert.leaf_nodes):
        if leaf.id in compared and not used >> index & 1:
            yield problem("S002.element", leaf.place, id=shown(leaf.id))
    guarantees = {guarantee.id: guarantee for guarantee in consert.guarantees}
    for service in consert.provided_services:
        members = [guarantees[id_] for id_ in service.members]
        defaults = [shown(guarantee.id) for guarantee in members if guarantee.default]
        others = [guarantee for guarantee in members if not guarantee.default]
        if len(defaults) > 1:
            names = ", ".join(defaults)
            yield problem("S005.defaults", service.place, service=shown(service.id), names=names)
        for strong, weak in permutations(others[:_MOST_GUARANTEES], 2):
            first, second = sets[strong.id], sets[weak.id]
            is_better = (weak.ranking or 0) < (strong.ranking or 0)
            has_rankings = None not in (weak.ranking, strong.ranking)
            if has_rankings and is_better and first and second and graph.implies(first, second):
                fields = {"strong": shown(strong.id), "weak": shown(weak.id)}
                yield problem("S005.dominated", strong.place, **fields)
        known = [sets[guarantee.id] for guarantee in others]
        masks = [mask for each in known for mask in each or ()]
        # the leaves without which none of these guarantees is active
        common = reduce(and_, masks) if masks and None not in known else 0
        for id_ in graph.leaves_in(consert, common):
            yield problem("S007", service.place, service=shown(service.id), id=shown(id_))
