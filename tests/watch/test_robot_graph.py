"""The graph of a robot: what is joined to what, in which colour, with which words."""

from dataclasses import replace

from eddi_runtime.why import Cause, ClaimWhy

from eddi_scaffold.common.claims import State
from eddi_scaffold.diagrams import Diagram
from eddi_scaffold.watch.fleet import MonitorView, RobotView, VerdictView
from eddi_scaffold.watch.messages import InputReport, NodeReport
from eddi_scaffold.watch.robot_graph import robot_graph


def verdict(name: str, state: State, holds: int, *path: str, cause: str = "gone") -> VerdictView:
    causes = (Cause(path, cause, "", path[-1]),) if path else ()
    return VerdictView(name, state, why=ClaimWhy(name, holds, causes))


def monitor(topic: str, verdicts: list[VerdictView], *inputs: InputReport) -> MonitorView:
    name = topic.split("/")[1]
    report = NodeReport(0.0, f"/{name}", name, "", inputs)
    return MonitorView(name, "Kind", topic, f"/{name}", (*verdicts,), (), 0.0, False, report)


PATH = ("Clear", "nearest", "/scan")
LIDAR = monitor(
    "/lidar/events",
    [verdict("Clear", "unknown", 1, *PATH[1:]), verdict("Fog", "not active", 2)],
    InputReport("nearest", "stale", 0.9, ("/scan",)),
    InputReport("light", "ok", 0.1, ("/light",)),
)
DRIVE = monitor(
    "/drive/guarantees",
    [verdict("Fast", "unknown", 1, *PATH), verdict("Slow", "not active", 0)],
    InputReport("Clear", "untold", 0.1, ("/lidar/events/status Clear",)),
    InputReport("Dry", "ok", 0.1, ("/lidar/events/status Fog", "/robots Dry")),
)


def read(graph: Diagram) -> tuple[list[str], list[str]]:
    """Return nodes and edges as lines."""
    head = {node.id: f"{node.shape} {node.lines[0]}" for node in graph.nodes}
    nodes = [f"{node.tone} {node.shape} {' | '.join(node.lines)}" for node in graph.nodes]
    return nodes, [f"{head[edge.source]} -> {head[edge.target]}" for edge in graph.edges]


def test_claims_are_joined_to_the_inputs_that_read_them_and_topics_are_at_the_edge() -> None:
    nodes, edges = read(robot_graph(RobotView("/r", (DRIVE, LIDAR))))
    assert [line.replace("\N{NO-BREAK SPACE}", " ") for line in nodes] == [
        "neutral box drive | Kind",
        "warning rounded Fast | unknown | <- Clear <- nearest | <- /scan (gone)",
        "refused rounded Slow | not active",
        "neutral box lidar | Kind",
        "warning rounded Clear | unknown | <- nearest <- /scan (gone)",
        "output rounded Fog | absent",
        "warning ellipse Clear | unknown",
        "input ellipse Dry",
        "neutral hexagon /robots | Dry",
        "warning ellipse nearest | stale",
        "warning hexagon /scan | gone",
        "input ellipse light",
        "neutral hexagon /light",
    ]
    assert edges == [
        "box drive -> rounded Fast",
        "box drive -> rounded Slow",
        "box lidar -> rounded Clear",
        "box lidar -> rounded Fog",
        "ellipse Clear -> box drive",
        "rounded Clear -> ellipse Clear",
        "ellipse Dry -> box drive",
        "rounded Fog -> ellipse Dry",
        "hexagon /robots -> ellipse Dry",
        "ellipse nearest -> box lidar",
        "hexagon /scan -> ellipse nearest",
        "ellipse light -> box lidar",
        "hexagon /light -> ellipse light",
    ]


def test_who_is_silent_keeps_its_links_and_knows_nothing() -> None:
    _, edges = read(robot_graph(RobotView("/r", (DRIVE, LIDAR))))
    silent = replace(LIDAR, silent=True)
    nodes, now = read(robot_graph(RobotView("/r", (DRIVE, silent))))
    assert now == edges
    assert {"neutral box lidar | silent", "warning ellipse light | unknown"} <= {*nodes}


def test_the_situation_of_a_system_is_in_the_box_of_its_monitor() -> None:
    state = "in Ready or Slow or Halted or Secured"
    nodes, _ = read(robot_graph(RobotView("/r", (replace(LIDAR, situation=state),))))
    assert "neutral box lidar | Kind | in Ready or Slow or Halted | or Secured" in nodes


def test_without_diagnostics_there_are_monitors_and_claims() -> None:
    nodes, edges = read(robot_graph(RobotView("/r", (replace(LIDAR, report=None),))))
    assert len(nodes) == 3
    assert edges == ["box lidar -> rounded Clear", "box lidar -> rounded Fog"]
