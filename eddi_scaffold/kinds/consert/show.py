"""What ``show`` prints of a ConSert, and its picture as SESAME D7.2 Fig 4 draws it."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

from eddi_scaffold.diagrams import Diagram, DiagramEdge, DiagramNode, LegendEntry, Shape, Tone
from eddi_scaffold.kinds.consert.consert import ConSert, Gate, Guarantee, Node

DEEPEST = 30
"""Levels that are printed; what lies deeper is counted as "..." (a line grows with its level)."""
_GROUPS = (
    *("guarantees", "demands", "evidence", "gates"),
    *("tree_propagations", "required_services", "provided_services"),
)
_LOOKS: dict[str, tuple[Shape, Tone, str]] = {
    "guarantee": ("rounded", "output", "guarantee"),
    "And": ("and", "gate", "And"),
    "Or": ("or", "gate", "Or"),
    "evidence": ("ellipse", "input", "runtime evidence"),
    "demand": ("hexagon", "demand", "demand on another system"),
}


def counts(consert: ConSert) -> Mapping[str, int]:
    """Return the number of elements of each kind, in the order of D7.2 Fig 6."""
    return {group: len(getattr(consert, group)) for group in _GROUPS}


def outline(consert: ConSert) -> Sequence[str]:
    """Return the guarantees with their support as lines, two blanks per level, then services.

    A gate or guarantee that several others use is written out once and named after that.
    """
    labels = {node.id: _label(node) for node in consert.nodes}
    shown: set[str] = set()
    lines = [f"of the system {consert.system}"] if consert.system else []
    for guarantee in consert.guarantees:
        lines += _tree(guarantee.id, labels, consert.inputs, shown)
    for service in consert.services:
        verb = "requires" if service.member_kind == "demand" else "provides"
        members = ", ".join(service.members)
        lines.append(f"{verb} {service.id} ({service.functional_service_type}): {members}")
    return lines


def _tree(
    root: str, labels: Mapping[str, str], inputs: Mapping[str, Sequence[str]], shown: set[str]
) -> Iterator[str]:
    waiting = [(0, root)]
    while waiting:
        level, id_ = waiting.pop()
        children, label = inputs[id_], "  " * level + labels[id_]
        if id_ in shown and children:
            yield f"{label} (see above)"
        elif level >= DEEPEST and children:
            yield f"{label} ..."
        else:
            shown.add(id_)
            yield label
            waiting += [(level + 1, child) for child in reversed(children)]


def _label(node: Node) -> str:
    if isinstance(node, Gate):
        return f"{node.function} {node.id}"
    text = "; ".join(dimension.text for dimension in node.dimensions)
    mark = " (default)" if isinstance(node, Guarantee) and node.default else ""
    return f"{node.kind} {node.id}" + (f": {text}" if text else "") + mark


def diagram(consert: ConSert) -> Diagram:
    """Return what a picture of the ConSert shows."""
    groups = ("guarantees", "gates", "evidence", "demands")
    counted = ", ".join(f"{len(getattr(consert, group))} {group}" for group in groups)
    edges = (
        DiagramEdge(of, target) for target, sources in consert.inputs.items() for of in sources
    )
    nodes = []
    for node in (node for group in groups for node in getattr(consert, group)):
        is_gate = isinstance(node, Gate)
        shape, tone, _ = _LOOKS[node.function if is_gate else node.kind]
        texts = () if is_gate else (dimension.text for dimension in node.dimensions)
        lines = (node.function.upper(),) if is_gate else (node.id, *texts)
        about = node.id if is_gate else node.description or ""
        nodes.append(DiagramNode(node.id, lines, shape, tone, about))
    return Diagram(
        f"ConSert {consert.name}",
        tuple(nodes),
        tuple(edges),
        "up",
        tuple(LegendEntry(title, shape, tone) for shape, tone, title in _LOOKS.values()),
        f"{counted}; support leads upwards",
    )
