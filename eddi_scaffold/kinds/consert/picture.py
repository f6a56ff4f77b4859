"""The picture of a ConSert as SESAME D7.2 Fig 4 draws it: evidence below, guarantees above."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

from eddi_scaffold.diagrams import Diagram, DiagramEdge, DiagramNode, LegendEntry, Shape
from eddi_scaffold.kinds.consert.graph import inputs_of
from eddi_scaffold.kinds.consert.inputs import covered_text

if TYPE_CHECKING:
    from eddi_scaffold.kinds.consert.model import ConSert, Dimension

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
        lines = (guarantee.id, *map(_dimension, guarantee.dimensions))
        yield DiagramNode(guarantee.id, lines, "rounded", "output", guarantee.description or "")
    for gate in consert.gates:
        shape: Shape = "and" if gate.function == "And" else "or"
        yield DiagramNode(gate.id, (gate.function.upper(),), shape, "gate", gate.id)
    for one in consert.evidence:
        lines = (one.id, _dimension(one.dimension))
        yield DiagramNode(one.id, lines, "ellipse", "input", one.description or "")
    for demand in consert.demands:
        lines = (demand.id, *map(_dimension, demand.dimensions))
        yield DiagramNode(demand.id, lines, "hexagon", "demand", demand.description or "")


def _dimension(dimension: Dimension) -> str:
    return covered_text(dimension)
