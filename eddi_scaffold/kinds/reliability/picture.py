"""The picture of a system: chains as circles and arcs, trees as gates (IEC 61025)."""

from __future__ import annotations

from collections.abc import Iterator

from eddi_scaffold.diagrams import Diagram, DiagramEdge, DiagramNode, LegendEntry
from eddi_scaffold.diagrams.diagram import Shape, Tone
from eddi_scaffold.kinds.reliability.model import (
    Chain,
    ComponentModel,
    FaultTree,
    Gate,
    ReliabilitySystem,
)
from eddi_scaffold.kinds.reliability.report import law_text

_LEGEND = (
    LegendEntry("gate", "or", "gate"),
    LegendEntry("basic event", "ellipse", "input"),
    LegendEntry("state", "rounded", "neutral"),
    LegendEntry("failure", "rounded", "warning"),
    LegendEntry("evidence", "hexagon", "output"),
)
_SHAPES: dict[str, Shape] = {"AND": "and", "PAND": "and", "SAND": "and", "NOT": "not"}


def picture(name: str, system: ReliabilitySystem) -> Diagram:
    """Return what a picture of the chains and trees shows."""
    nodes: list[DiagramNode] = []
    edges: list[DiagramEdge] = []
    for component in system.components.values():
        content = component.content
        if isinstance(content, Chain):
            nodes += _states(component.name, content)
            edges += [
                DiagramEdge(
                    f"{component.name}:{a.source}", f"{component.name}:{a.target}", f"{a.rate:g}/h"
                )
                for a in content.arcs
            ]
        elif isinstance(content, FaultTree):
            nodes += _tree_nodes(component.name, content)
            edges += _tree_edges(system, component.name, content)
        else:
            nodes.append(_box(component))
            edges += [
                DiagramEdge(_top(system, below), component.name)
                for below in component.uses
                if below in system.components  # `check` says what is missing
            ]
    for one in system.thresholds:
        lines = (one.id, f"p_fail <= {one.activate:g}")
        nodes.append(DiagramNode(f"evidence:{one.id}", lines, "hexagon", "output"))
        edges.append(DiagramEdge(_top(system, system.top), f"evidence:{one.id}"))
    shapes = {(node.shape, node.tone) for node in nodes}
    legend = tuple(one for one in _LEGEND if (one.shape, one.tone) in shapes)
    text = "chains of states and the fault trees that use them"
    return Diagram(f"Reliability {name}", tuple(nodes), tuple(edges), "up", legend, text)


def _top(system: ReliabilitySystem, name: str) -> str:
    """Return the node that represents the failure of a model."""
    content = system.components[name].content
    if isinstance(content, Chain):
        return f"{name}:{content.fail[0]}" if content.fail else name
    return f"{name}:{content.top}" if isinstance(content, FaultTree) else name


def _states(name: str, chain: Chain) -> Iterator[DiagramNode]:
    for state in chain.states:
        tone: Tone = "warning" if state in chain.fail else "neutral"
        marks = ("initial",) if state in chain.initial else ()
        yield DiagramNode(f"{name}:{state}", (state, *marks), "rounded", tone)


def _tree_nodes(name: str, tree: FaultTree) -> Iterator[DiagramNode]:
    for key, gate in tree.gates.items():
        tone: Tone = "warning" if key == tree.top else "gate"
        yield DiagramNode(f"{name}:{key}", (key, _label(gate)), _SHAPES.get(gate.type, "or"), tone)
    for key, event in tree.events.items():
        yield DiagramNode(f"{name}:{key}", (key, law_text(event)), "ellipse", "input")


def _label(gate: Gate) -> str:
    return f"{gate.k}/{len(gate.of)}" if gate.type == "VOTE" else gate.type


def _tree_edges(system: ReliabilitySystem, name: str, tree: FaultTree) -> Iterator[DiagramEdge]:
    for key, gate in tree.gates.items():
        for below in gate.of:
            yield DiagramEdge(f"{name}:{below}", f"{name}:{key}", arrow=False)
    for key, event in tree.events.items():
        if event.law is not None and event.law.model in system.components:
            yield DiagramEdge(_top(system, event.law.model), f"{name}:{key}")


def _box(component: ComponentModel) -> DiagramNode:
    return DiagramNode(component.name, (component.name, component.type), "box", "neutral")
