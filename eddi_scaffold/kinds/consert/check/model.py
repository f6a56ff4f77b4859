"""All checks of one ConSert: C006 to C026, with the model that is left to go on with.

The codes and when a model is built in spite of an error are those of the tool's reference; the
faulty part is left out so that the rest can still be checked and explained.
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from eddi_scaffold.kinds.consert.check.dimensions import check_dimensions, without_repetitions
from eddi_scaffold.kinds.consert.check.graph import LEAF_KINDS, check_graph, kinds_of
from eddi_scaffold.kinds.consert.check.names import check_names
from eddi_scaffold.kinds.consert.check.services import check_services

if TYPE_CHECKING:
    from collections.abc import Container

    from eddi_scaffold.kinds.consert.model import ConSert, Propagation
    from eddi_scaffold.problems import Problem

FATAL = frozenset({"C006", "C007", "C008", "C010", "C015", "C016"})
"""Codes after which nothing is built (those of reading, C001 to C005, build nothing anyway)."""


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
    if any(problem.code in FATAL for problem in problems):
        return None, problems
    return _repaired(consert), problems


def _repaired(consert: ConSert) -> ConSert:
    edges = _edges(consert)
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
            replace(d, dimensions=tuple(without_repetitions(one) for one in d.dimensions))
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


def _edges(consert: ConSert) -> tuple[Propagation, ...]:
    kinds = kinds_of(consert)
    kept: dict[tuple[str, str], Propagation] = {}
    for edge in consert.tree_propagations:
        if kinds.get(edge.target, "evidence") not in LEAF_KINDS:
            kept.setdefault((edge.source, edge.target), edge)
    return tuple(kept.values())


def _members(ids: tuple[str, ...], known: Container[str]) -> tuple[str, ...]:
    return tuple(id_ for id_ in dict.fromkeys(ids) if id_ in known)
