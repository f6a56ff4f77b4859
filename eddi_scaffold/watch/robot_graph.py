"""The graph of a robot: monitors, joined where one reads a claim of another, and their topics."""

from __future__ import annotations

from dataclasses import replace
from textwrap import wrap

from eddi_scaffold.common.claims import State
from eddi_scaffold.diagrams import Diagram, DiagramEdge, DiagramNode, LegendEntry, Tone
from eddi_scaffold.watch.fleet import RobotView, VerdictView
from eddi_scaffold.watch.messages import base_topic, plain

_TONES: dict[State, Tone] = {"active": "output", "not active": "refused", "unknown": "warning"}
_LEGEND = (
    LegendEntry("holds, hazard absent", "rounded", "output"),
    LegendEntry("known not to hold", "rounded", "refused"),
    LegendEntry("unknown", "rounded", "warning"),
    LegendEntry("monitor", "box", "neutral"),
    LegendEntry("its input", "ellipse", "input"),
    LegendEntry("topic", "hexagon", "neutral"),
)
_WORDS = {"type": "wrong type", "offer": "wrong QoS", "never": "no message yet"}
"""States of causes that a person would not understand as they are."""
_LONGEST, _MOST_LINES = 26, 4  # of the chain at a claim


def robot_graph(robot: RobotView) -> Diagram:
    """Return topics, above them the inputs that read them, their monitor, its claims, and so on.

    What an input reads is known from ``/diagnostics``, why a claim does not hold from ``Why``.
    """
    nodes: dict[str, DiagramNode] = {}
    edges: dict[DiagramEdge, None] = {}
    claims: dict[str, dict[str, str]] = {}  # topic -> claim -> its node
    wrong: dict[str, str] = {}  # topic -> what is wrong with it
    boxes = [f"monitor {monitor.node} {monitor.name}" for monitor in robot.monitors]
    for box, monitor in zip(boxes, robot.monitors, strict=True):
        state = "silent" if monitor.silent else monitor.title
        lines = (monitor.name, state, *_wrapped(monitor.situation))
        nodes.setdefault(box, DiagramNode(box, lines, "box"))
        for verdict in monitor.verdicts:
            node = f"claim {monitor.node} {monitor.topic} {verdict.id}"
            lines, tone = (verdict.id, verdict.word, *_chain(verdict)), _TONES[verdict.good]
            nodes[node] = DiagramNode(node, lines, "rounded", tone)
            edges[DiagramEdge(box, node, arrow=False)] = None
            claims.setdefault(monitor.topic, {})[verdict.id] = node
            causes = verdict.why.causes if verdict.why is not None else ()
            wrong.update((cause.topic, _WORDS.get(cause.state, cause.state)) for cause in causes)
    for box, monitor in zip(boxes, robot.monitors, strict=True):
        for one in monitor.report.inputs if monitor.report is not None else ():
            node, is_known = f"input {box} {one.id}", one.state == "ok" and not monitor.silent
            state = "unknown" if monitor.silent or one.state == "untold" else one.state
            lines = (one.id,) if is_known else (one.id, state)
            nodes[node] = DiagramNode(node, lines, "ellipse", "input" if is_known else "warning")
            edges[DiagramEdge(node, box)] = None
            for source in one.sources:
                topic, _, claim = source.partition(" ")
                given = claims.get(base_topic(topic), {})
                for origin in [given[claim]] if claim in given else given.values() or [source]:
                    edges[DiagramEdge(origin, node)] = None
                if not given:
                    at_edge = DiagramNode(source, (*source.split(" ", 1),), "hexagon")
                    nodes.setdefault(source, at_edge)
                    if not is_known:
                        lines = (*at_edge.lines, wrong.get(topic, state))
                        nodes[source] = replace(at_edge, lines=lines, tone="warning")
    text = "from topics up to inputs, monitors and their claims, which other monitors read"
    return Diagram(f"Robot {robot.name}", (*nodes.values(),), (*edges,), "up", _LEGEND, text)


def _chain(verdict: VerdictView) -> list[str]:
    """Return the first reason without its times, so that the graph stays while it lasts."""
    for cause in verdict.why.causes[:1] if verdict.why is not None else ():
        state = _WORDS.get(cause.state, cause.state)
        parts = [*(f"<- {plain(link)}" for link in cause.path), f"({state})"]
        text = " ".join(part.replace(" ", "\N{NO-BREAK SPACE}") for part in parts)
        return _wrapped(text)
    return []


def _wrapped(text: str) -> list[str]:
    return wrap(text, _LONGEST, max_lines=_MOST_LINES, placeholder=" …")
