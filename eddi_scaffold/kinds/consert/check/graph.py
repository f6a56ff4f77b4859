"""Checks of ids and edges: C007 to C014, C023 (edges), C024 and C026."""

from __future__ import annotations

from typing import TYPE_CHECKING, Literal

from eddi_scaffold.graphs import cycles, reached
from eddi_scaffold.kinds.consert.graph import inputs_of
from eddi_scaffold.positioned_yaml.nodes import shown
from eddi_scaffold.problems import NearNames, Place, Problem, error, info, warning

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping

    from eddi_scaffold.graphs import Graph
    from eddi_scaffold.kinds.consert.model import ConSert, Gate, Guarantee, Propagation

NodeKind = Literal["evidence", "demand", "gate", "guarantee"]
LEAF_KINDS: tuple[NodeKind, ...] = ("evidence", "demand")
_LONGEST_CHAIN = 12
_LOOSE_ENDS = frozenset({"C008", "C009"})
"""An edge that leads nowhere leaves alone what it was meant to join: that is not reported again."""


def check_graph(consert: ConSert) -> list[Problem]:
    """Check the ids of the nodes and the edges between them."""
    kinds = kinds_of(consert)
    problems = [*_repeated_ids(consert), *_edges(consert, kinds)]
    if len(kinds) < len(list(_nodes(consert))):  # what follows would be guesswork
        return problems
    inputs = {
        id_: () if kinds[id_] in LEAF_KINDS else sources
        for id_, sources in inputs_of(consert).items()
    }
    reachable = reached(inputs, (g.id for g in consert.guarantees))
    fed = {edge.target for edge in consert.tree_propagations}
    problems += _cycles(consert, inputs)
    loose = any(problem.code in _LOOSE_ENDS for problem in problems)
    if loose:
        fed |= {node.id for node in consert.gates}
        fed |= {guarantee.id for guarantee in consert.guarantees if not guarantee.default}
    for guarantee in consert.guarantees:
        problems += _support(guarantee, fed)
    if not loose:
        problems += _unreached(consert, reachable)
    for gate in consert.gates:
        problems += _gate(gate, inputs, reachable, fed)
    return [*problems, *_no_guarantees(consert)]


def kinds_of(consert: ConSert) -> dict[str, NodeKind]:
    """Return what each id names; of a repeated id the first."""
    kinds: dict[str, NodeKind] = {}
    for kind, id_, _ in _nodes(consert):
        kinds.setdefault(id_, kind)
    return kinds


def _nodes(consert: ConSert) -> Iterator[tuple[NodeKind, str, Place]]:
    for evidence in consert.evidence:
        yield "evidence", evidence.id, evidence.place
    for demand in consert.demands:
        yield "demand", demand.id, demand.place
    for guarantee in consert.guarantees:
        yield "guarantee", guarantee.id, guarantee.place
    for gate in consert.gates:
        yield "gate", gate.id, gate.place


def _repeated_ids(consert: ConSert) -> Iterator[Problem]:
    """Report the ids that are used for two things, in the order of the file (C007)."""
    groups: tuple[list[tuple[str, str, Place]], ...] = (
        list(_nodes(consert)),
        [("required service", s.id, s.place) for s in consert.required_services],
        [("provided service", s.id, s.place) for s in consert.provided_services],
    )
    for group in groups:
        first: dict[str, tuple[str, Place]] = {}
        for kind, id_, place in sorted(group, key=lambda node: _position(node[2])):
            if id_ in first:
                before, there = first[id_]
                message = f"the id {shown(id_)} of this {kind} is already used by the {before}"
                yield error("C007", f"{message} in {_where(there)}", place)
            else:
                first[id_] = (kind, place)


def _position(place: Place) -> tuple[int, int]:
    return place.line or 0, place.col or 0


def _where(place: Place) -> str:
    if place.line is None:
        return place.path or "the same model"
    return f"line {place.line}" + ("" if place.col is None else f", column {place.col}")


def _edges(consert: ConSert, kinds: Mapping[str, NodeKind]) -> Iterator[Problem]:
    seen: set[tuple[str, str]] = set()
    near = NearNames(kinds)
    for edge in consert.tree_propagations:
        text = f"edge from {shown(edge.source)} to {shown(edge.target)}"
        yield from _edge(edge, text, kinds, near)
        if (edge.source, edge.target) in seen:
            yield warning("C023", f"{text} is repeated: read once", edge.place)
        seen.add((edge.source, edge.target))


def _edge(
    edge: Propagation, text: str, kinds: Mapping[str, NodeKind], near: NearNames
) -> Iterator[Problem]:
    if edge.source not in kinds:
        message = f"{text}: nothing has the id {shown(edge.source)}"
        yield error("C008", message, edge.place, near.hint(edge.source))
    if edge.target not in kinds:
        message = f"{text}: nothing has the id {shown(edge.target)}"
        yield error("C009", message, edge.place, near.hint(edge.target))
    elif kinds[edge.target] in LEAF_KINDS:
        kind = kinds[edge.target]
        yield error("C011", f"{text}: {kind} cannot have support", edge.place)


def _cycles(consert: ConSert, inputs: Graph) -> Iterator[Problem]:
    found = cycles(inputs)
    if not found:
        return
    places = {(e.source, e.target): e.place for e in reversed(consert.tree_propagations)}
    for cycle in found:
        closed = [*cycle, cycle[0]]
        names = closed
        if len(closed) > _LONGEST_CHAIN:
            left_out = f"({len(closed) - _LONGEST_CHAIN} more)"
            names = [*closed[: _LONGEST_CHAIN - 1], left_out, closed[-1]]
        message = f"cycle: {' -> '.join(names)}"
        yield error("C010", message, places[closed[0], closed[1]])


def _support(guarantee: Guarantee, fed: set[str]) -> Iterator[Problem]:
    name = f"guarantee {shown(guarantee.id)}"
    if guarantee.default and guarantee.id in fed:
        message = f"{name} is marked as default but has support: a default guarantee holds always"
        hint = "remove `default: true`, or the edges into it"
        yield error("C012", message, guarantee.place, hint)
    elif not guarantee.default and guarantee.id not in fed:
        message = f"{name} has no support: it would always be active"
        hint = (
            "add an edge into it; if it is the fallback of its service and is to hold always, "
            f"mark it with `default: true` or --default-guarantee {guarantee.id}"
        )
        yield error("C012", message, guarantee.place, hint)


def _unreached(consert: ConSert, reachable: set[str]) -> Iterator[Problem]:
    if not consert.guarantees:  # C026 reports it once
        return
    for kind, id_, place in _nodes(consert):
        if id_ not in reachable:
            yield warning("C014", f"{kind} {shown(id_)} supports no guarantee", place)


def _gate(gate: Gate, inputs: Graph, reachable: set[str], fed: set[str]) -> Iterator[Problem]:
    if len(inputs[gate.id]) == 1:
        yield info("C024", f"gate {shown(gate.id)} has only one input", gate.place)
    if gate.id not in fed and gate.id in reachable:
        constant = {"And": "TRUE", "Or": "FALSE"}[gate.function]
        message = f"gate {shown(gate.id)} has no input: it would be constant {constant}"
        yield error("C013", message, gate.place, "add an edge into it, or remove it")


def _no_guarantees(consert: ConSert) -> Iterator[Problem]:
    if not consert.guarantees:
        yield warning("C026", f"ConSert {shown(consert.name)} has no guarantees", consert.place)
