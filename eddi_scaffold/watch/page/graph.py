"""The verdicts of a robot as a graph: monitors, what they guarantee, and what is missing."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

from eddi_scaffold.diagrams import Diagram, DiagramEdge, DiagramNode, LegendEntry, Tone, drawn
from eddi_scaffold.verdicts import State
from eddi_scaffold.watch.fleet import MonitorView, RobotView
from eddi_scaffold.watch.page.models import Pictures

TONES: dict[State, Tone] = {"active": "output", "not active": "refused", "unknown": "warning"}
_LEGEND = (
    LegendEntry("monitor", "box", "neutral"),
    LegendEntry("active", "rounded", "output"),
    LegendEntry("not active", "rounded", "refused"),
    LegendEntry("unknown", "rounded", "warning"),
    LegendEntry("what it lacks", "ellipse", "refused"),
)
_LACKS = "lacks"
Part = DiagramNode | DiagramEdge


def graph(robot: RobotView, pictures: Pictures) -> str:
    """Return the SVG of a robot's verdicts.

    Args:
        robot: what is known of it.
        pictures: of the models that are known here; of others, only what monitors say is drawn.
    """
    parts = [
        part
        for number, monitor in enumerate(robot.monitors)
        for part in _parts(f"m{number}", monitor, pictures.get((monitor.title, monitor.name)))
    ]
    nodes = tuple(part for part in parts if isinstance(part, DiagramNode))
    edges = tuple(part for part in parts if isinstance(part, DiagramEdge))
    text = "below a monitor its guarantees, below these what they rest on, or lack"
    return drawn(Diagram(robot.name, nodes, edges, "up", _LEGEND, text))


def _parts(key: str, monitor: MonitorView, picture: Diagram | None) -> Iterator[Part]:
    lines = (monitor.name, "silent" if monitor.silent else monitor.title)
    yield DiagramNode(key, lines, "box", "neutral")
    for one in monitor.verdicts:
        yield DiagramEdge(f"{key} {one.id}", key, arrow=False)
    if picture is not None and fits(monitor, picture):
        yield from _of_model(key, monitor, picture)
    else:
        yield from _of_words(key, monitor)


def fits(monitor: MonitorView, picture: Diagram) -> bool:
    """Return whether the picture has all that the monitor says: else it is of another version."""
    return {one.id for one in monitor.verdicts} <= {node.id for node in picture.nodes}


def _of_model(key: str, monitor: MonitorView, picture: Diagram) -> Iterator[Part]:
    """Yield the picture of the model, with what the monitor says."""
    states = {one.id: one.state for one in monitor.verdicts}
    lacking = {reason for one in monitor.verdicts for reason in one.reasons}
    for node in picture.nodes:
        head, *rest = node.lines
        made = replace(node, id=f"{key} {node.id}")
        if node.id in states:
            state = states[node.id]
            made = replace(made, lines=(head, state, *rest), tone=TONES[state])
        elif node.id in lacking:
            made = replace(made, lines=(head, _LACKS, *rest), tone="refused")
        yield made
    for edge in picture.edges:
        yield replace(edge, source=f"{key} {edge.source}", target=f"{key} {edge.target}")


def _of_words(key: str, monitor: MonitorView) -> Iterator[Part]:
    """Yield verdicts, and the reasons that they have."""
    lacking: dict[str, list[str]] = {}
    for one in monitor.verdicts:
        id_ = f"{key} {one.id}"
        yield DiagramNode(id_, (one.id, one.state), "rounded", TONES[one.state])
        for reason in one.reasons if not monitor.silent else ():
            lacking.setdefault(reason, []).append(id_)
    for reason, users in lacking.items():
        id_ = f"{key} lacks {reason}"
        yield DiagramNode(id_, (reason, _LACKS), "ellipse", "refused")
        for user in users:
            yield DiagramEdge(id_, user)
