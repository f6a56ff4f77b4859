"""Checks of ConSerts: what is wrong with a model by itself (C006 to C023)."""

from __future__ import annotations

from collections import Counter
from dataclasses import replace
from typing import TYPE_CHECKING, Literal

from eddi_scaffold.common import units
from eddi_scaffold.common.graphs import cycles, reached
from eddi_scaffold.common.problems import Place, Problem, SimilarNames, did_you_mean, problem
from eddi_scaffold.kinds.consert.graph import inputs_of
from eddi_scaffold.kinds.consert.model import (
    CategoricalDimension,
    Dimension,
    NumericDimension,
    Range,
)
from eddi_scaffold.kinds.consert.name_checks import check_names, check_services
from eddi_scaffold.kinds.consert.ranges import is_empty, is_nan, overlap, range_text
from eddi_scaffold.yaml_text.nodes import shown

if TYPE_CHECKING:
    from collections.abc import Container, Iterator, Mapping

    from eddi_scaffold.common.graphs import Graph
    from eddi_scaffold.kinds.consert.model import ConSert, Gate, Guarantee, Propagation


NodeKind = Literal["evidence", "demand", "gate", "guarantee"]
LEAF_KINDS: tuple[NodeKind, ...] = ("evidence", "demand")
_LONGEST_CHAIN = 12
_LOOSE_ENDS = frozenset({"C008.no_source", "C008.no_target"})
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
    loose = any(problem.case in _LOOSE_ENDS for problem in problems)
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
        for kind, id_, place in sorted(group, key=lambda n: (n[2].line or 0, n[2].col or 0)):
            if id_ in first:
                before, there = first[id_]
                message = f"the id {shown(id_)} of this {kind} is already used by the {before}"
                yield problem("C007.duplicate", place, message=message, there=_where(there))
            else:
                first[id_] = (kind, place)


def _where(place: Place) -> str:
    if place.line is None:
        return place.path or "the same model"
    return f"line {place.line}" + ("" if place.col is None else f", column {place.col}")


def _edges(consert: ConSert, kinds: Mapping[str, NodeKind]) -> Iterator[Problem]:
    seen: set[tuple[str, str]] = set()
    near = SimilarNames(kinds)
    for edge in consert.tree_propagations:
        text = f"edge from {shown(edge.source)} to {shown(edge.target)}"
        yield from _edge(edge, text, kinds, near)
        if (edge.source, edge.target) in seen:
            yield problem("C023.edge_twice", edge.place, text=text)
        seen.add((edge.source, edge.target))


def _edge(
    edge: Propagation, text: str, kinds: Mapping[str, NodeKind], near: SimilarNames
) -> Iterator[Problem]:
    if edge.source not in kinds:
        yield problem(
            "C008.no_source",
            edge.place,
            hint=near.hint(edge.source),
            text=text,
            source=shown(edge.source),
        )
    if edge.target not in kinds:
        yield problem(
            "C008.no_target",
            edge.place,
            hint=near.hint(edge.target),
            text=text,
            target=shown(edge.target),
        )
    elif kinds[edge.target] in LEAF_KINDS:
        kind = kinds[edge.target]
        yield problem("C011.no_support_possible", edge.place, text=text, kind=kind)


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
        yield problem("C010", places[closed[0], closed[1]], names=" -> ".join(names))


def _support(guarantee: Guarantee, fed: set[str]) -> Iterator[Problem]:
    name = f"guarantee {shown(guarantee.id)}"
    if guarantee.default and guarantee.id in fed:
        yield problem("C011.default_with_support", guarantee.place, name=name)
    elif not guarantee.default and guarantee.id not in fed:
        mark = "" if guarantee.place.path else "`default: true` or "  # an EDDI has no such flag
        yield problem(
            "C011.no_support", guarantee.place, name=name, mark=mark, guarantee=guarantee.id
        )


def _unreached(consert: ConSert, reachable: set[str]) -> Iterator[Problem]:
    if not consert.guarantees:  # C014 reports it once
        return
    for kind, id_, place in _nodes(consert):
        if id_ not in reachable:
            yield problem("C014.supports_nothing", place, kind=kind, id=shown(id_))


def _gate(gate: Gate, inputs: Graph, reachable: set[str], fed: set[str]) -> Iterator[Problem]:
    if len(inputs[gate.id]) == 1:
        yield problem("C023.one_input", gate.place, gate=shown(gate.id))
    if gate.id not in fed and gate.id in reachable:
        constant = {"And": "TRUE", "Or": "FALSE"}[gate.function]
        yield problem("C011.gate_without_input", gate.place, gate=shown(gate.id), constant=constant)


def _no_guarantees(consert: ConSert) -> Iterator[Problem]:
    if not consert.guarantees:
        yield problem("C014.no_guarantees", consert.place, consert=shown(consert.name))


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
                found.append(problem("C006.asks_nothing", node.place, subject=what))
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
    return problem("C006.covers_nothing", place, type=shown(dimension.type), subject=what)


def _categorical(dimension: CategoricalDimension, what: str, place: Place) -> Iterator[Problem]:
    if not dimension.covered:
        yield _nothing_covered(dimension, what, place)
    for category, count in Counter(dimension.covered).items():
        if count > 1:
            yield problem(
                "C023.category_twice", place, category=shown(category), count=count, subject=what
            )


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
        return problem("C006.bound", place, subject=what)
    if is_empty(one):
        return problem("C006.empty_range", place, name=range_text(one), subject=what)
    return None


def _overlaps(dimension: NumericDimension, what: str, place: Place) -> Iterator[Problem]:
    for first, second in overlap(dimension.covered):
        yield problem(
            "C023.overlap",
            place if second.place.line is None else second.place,
            first=range_text(first),
            second=range_text(second),
            subject=what,
        )


def _unit(dimension: NumericDimension, what: str, place: Place) -> Iterator[Problem]:
    if dimension.uom is None:
        yield problem(
            "C016.no_unit", place, hint=_NO_UNIT, type=shown(dimension.type), subject=what
        )
    elif units.find(dimension.uom) is None:
        near = did_you_mean(dimension.uom, [s for s in units.spellings() if s])
        hint = "write percent" if dimension.uom == "%" else near
        yield problem(
            "C016.unknown_unit",
            place,
            hint=hint,
            unit=shown(dimension.uom),
            subject=what,
            units=units.listed(),
        )


FATAL = frozenset(
    {
        "C006.asks_nothing",
        "C006.covers_nothing",
        "C006.empty_gate",
        "C006.empty_list",
        "C006.no_dimension",
        "C007.duplicate",
        "C007.duplicate_name",
        "C008.no_source",
        "C010",
        "C006.bound",
        "C006.empty_range",
        "C016.unknown_unit",
    }
)
"""Cases after which nothing is built (those of reading, C001 and C002, build nothing anyway)."""


def check_consert(consert: ConSert) -> tuple[ConSert | None, list[Problem]]:
    """Check what the elements of a ConSert mean together.

    Returns:
        The ConSert without its faulty parts (edges that lead nowhere or into evidence, unknown
        members of services, repetitions, the mark of a default guarantee that has support), or
        ``None`` when nothing can be built; and all problems.
    """
    problems = [
        *check_dimensions(consert),
        *check_graph(consert),
        *check_names(consert),
        *check_services(consert),
    ]
    if any(problem.case in FATAL for problem in problems):
        return None, problems
    return _repaired(consert), problems


def _repaired(consert: ConSert) -> ConSert:
    edges = _sound_edges(consert)
    supported = {edge.target for edge in edges}
    demands = {demand.id for demand in consert.demands}
    guarantees = {guarantee.id for guarantee in consert.guarantees}
    return replace(
        consert,
        tree_propagations=edges,
        guarantees=tuple(
            replace(
                g,
                default=g.default and g.id not in supported,
                dimensions=tuple(without_repetitions(d) for d in g.dimensions),
            )
            for g in consert.guarantees
        ),
        demands=tuple(
            replace(
                d, dimensions=tuple(without_repetitions(dimension) for dimension in d.dimensions)
            )
            for d in consert.demands
        ),
        evidence=tuple(
            replace(e, dimension=without_repetitions(e.dimension)) for e in consert.evidence
        ),
        required_services=tuple(
            replace(service, demands=_members(service.demands, demands))
            for service in consert.required_services
        ),
        provided_services=tuple(
            replace(service, guarantees=_members(service.guarantees, guarantees))
            for service in consert.provided_services
        ),
    )


def _sound_edges(consert: ConSert) -> tuple[Propagation, ...]:
    kinds = kinds_of(consert)
    kept: dict[tuple[str, str], Propagation] = {}
    for edge in consert.tree_propagations:
        if kinds.get(edge.target, "evidence") not in LEAF_KINDS:
            kept.setdefault((edge.source, edge.target), edge)
    return tuple(kept.values())


def _members(ids: tuple[str, ...], known: Container[str]) -> tuple[str, ...]:
    return tuple(id_ for id_ in dict.fromkeys(ids) if id_ in known)
