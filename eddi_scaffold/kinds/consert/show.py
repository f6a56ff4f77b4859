"""What ``show`` prints of a ConSert, and its picture as SESAME D7.2 Fig 4 draws it."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

from eddi_scaffold.diagrams import Diagram, DiagramEdge, DiagramNode, LegendEntry, Shape
from eddi_scaffold.kinds.consert.graph import inputs_of
from eddi_scaffold.kinds.consert.model import BinaryDimension, CategoricalDimension
from eddi_scaffold.kinds.consert.ranges import range_text

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from eddi_scaffold.kinds.consert.model import ConSert, Demand, Dimension, Guarantee


DEEPEST = 30
"""Levels that are printed; what lies deeper is counted as "..." (a line grows with its level)."""


def covered_text(dimension: Dimension) -> str:
    """Describe in one line what counts as good: ``Distance in [0, 5) m``."""
    if isinstance(dimension, BinaryDimension):
        return dimension.type if dimension.value else f"{dimension.type} is false"
    if isinstance(dimension, CategoricalDimension):
        return f"{dimension.type} in {{{', '.join(dimension.covered)}}}"
    ranges = " or ".join(range_text(range_, dimension.uom) for range_ in dimension.covered)
    return f"{dimension.type} in {ranges}"


def counts(consert: ConSert) -> Mapping[str, int]:
    """Return the number of elements of each kind, in the order of D7.2 Fig 6."""
    return {
        "guarantees": len(consert.guarantees),
        "demands": len(consert.demands),
        "evidence": len(consert.evidence),
        "gates": len(consert.gates),
        "tree_propagations": len(consert.tree_propagations),
        "required_services": len(consert.required_services),
        "provided_services": len(consert.provided_services),
    }


def outline(consert: ConSert) -> Sequence[str]:
    """Return the guarantees with their support as lines, two blanks per level, then services.

    A gate or guarantee that several others use is written out once and named after that.
    """
    labels, inputs = _labels(consert), inputs_of(consert)
    shown: set[str] = set()
    lines = [f"of the system {consert.system}"] if consert.system else []
    lines += [line for g in consert.guarantees for line in _tree(g.id, labels, inputs, shown)]
    lines += [
        f"requires {service.id} ({service.functional_service_type}): {', '.join(service.demands)}"
        for service in consert.required_services
    ]
    lines += [
        f"provides {service.id} ({service.functional_service_type}): "
        + ", ".join(service.guarantees)
        for service in consert.provided_services
    ]
    return lines


def _tree(
    root: str, labels: Mapping[str, str], inputs: Mapping[str, Sequence[str]], shown: set[str]
) -> Iterator[str]:
    waiting = [(0, root)]
    while waiting:
        level, id_ = waiting.pop()
        children, indent = inputs[id_], "  " * level
        if id_ in shown and children:
            yield f"{indent}{labels[id_]} (see above)"
        elif level >= DEEPEST and children:
            yield f"{indent}{labels[id_]} ..."
        else:
            shown.add(id_)
            yield f"{indent}{labels[id_]}"
            waiting += [(level + 1, child) for child in reversed(children)]


def _labels(consert: ConSert) -> dict[str, str]:
    labels = {e.id: f"evidence {e.id}: {covered_text(e.dimension)}" for e in consert.evidence}
    for demand in consert.demands:
        labels[demand.id] = f"demand {demand.id}{_covered(demand)}"
    for gate in consert.gates:
        labels[gate.id] = f"{gate.function} {gate.id}"
    for guarantee in consert.guarantees:
        mark = " (default)" if guarantee.default else ""
        labels[guarantee.id] = f"guarantee {guarantee.id}{_covered(guarantee)}{mark}"
    return labels


def _covered(part: Demand | Guarantee) -> str:
    text = "; ".join(covered_text(dimension) for dimension in part.dimensions)
    return f": {text}" if text else ""


_LEGEND = (
    LegendEntry("guarantee", "rounded", "output"),
    LegendEntry("And", "and", "gate"),
    LegendEntry("Or", "or", "gate"),
    LegendEntry("runtime evidence", "ellipse", "input"),
    LegendEntry("demand on another system", "hexagon", "demand"),
)


def diagram(consert: ConSert) -> Diagram:
    """Return what a picture of the ConSert shows."""
    counted = (
        f"{len(consert.guarantees)} guarantees, {len(consert.gates)} gates, "
        f"{len(consert.evidence)} evidence, {len(consert.demands)} demands"
    )
    edges = (
        DiagramEdge(source, target)
        for target, sources in inputs_of(consert).items()
        for source in sources
    )
    return Diagram(
        f"ConSert {consert.name}",
        tuple(_nodes(consert)),
        tuple(edges),
        "up",
        _LEGEND,
        f"{counted}; support leads upwards",
    )


def _nodes(consert: ConSert) -> Iterator[DiagramNode]:
    for guarantee in consert.guarantees:
        lines = (guarantee.id, *map(covered_text, guarantee.dimensions))
        yield DiagramNode(guarantee.id, lines, "rounded", "output", guarantee.description or "")
    for gate in consert.gates:
        shape: Shape = "and" if gate.function == "And" else "or"
        yield DiagramNode(gate.id, (gate.function.upper(),), shape, "gate", gate.id)
    for evidence in consert.evidence:
        lines = (evidence.id, covered_text(evidence.dimension))
        yield DiagramNode(evidence.id, lines, "ellipse", "input", evidence.description or "")
    for demand in consert.demands:
        lines = (demand.id, *map(covered_text, demand.dimensions))
        yield DiagramNode(demand.id, lines, "hexagon", "demand", demand.description or "")
