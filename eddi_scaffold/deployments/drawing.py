"""``diagram`` of a deployment file: robots, their monitors, and who relies on whom."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from pathlib import Path

from eddi_scaffold.common.files import Source
from eddi_scaffold.common.problems import EddiError
from eddi_scaffold.deployments.fleet import Fleet, read_whole_fleet
from eddi_scaffold.deployments.offers import RobotMonitor
from eddi_scaffold.deployments.robots import FleetRobot
from eddi_scaffold.deployments.support import wired
from eddi_scaffold.diagrams import Diagram, DiagramEdge, DiagramNode, LegendEntry, Tone
from eddi_scaffold.diagrams.svg import drawn
from eddi_scaffold.kinds import ReadResult


def picture_of_fleet(source: Source, read: Callable[[Path], ReadResult]) -> str:
    """Return the SVG of a deployment file.

    Raises:
        EddiError: it, or what it names, cannot be used.
    """
    fleet, problems = read_whole_fleet(source, read)
    if fleet is None:
        raise EddiError(*problems)
    return drawn(diagram(fleet, source.stem))


def diagram(fleet: Fleet, title: str) -> Diagram:
    """Return robots above their monitors, and lines from each monitor to those that rely on it."""
    nodes = [
        *(_robot(robot) for robot in fleet.robots),
        *(_monitor(fleet, monitor) for monitor in fleet.monitors),
    ]
    edges = [
        *(DiagramEdge(_id(monitor.robot), _id(monitor), arrow=False) for monitor in fleet.monitors),
        *(edge for robot in fleet.robots for edge in _within(fleet, robot)),
        *_between(fleet),
    ]
    description = [f"{len(fleet.robots)} robots, {len(fleet.monitors)} monitors"]
    for binding in fleet.bindings:
        guarantees = [f"{each.guarantee} of {each.provider.name}" for each in binding.fulfilments]
        demand = f"{binding.demand} of {binding.user.name}"
        description.append(f"{demand} is fulfilled by {' or '.join(guarantees)}")
    legend = (
        LegendEntry("robot", "rounded", "neutral"),
        LegendEntry("monitor", "table", "output"),
        LegendEntry("monitor with demands of other robots", "table", "demand"),
    )
    return Diagram(title, tuple(nodes), tuple(edges), "down", legend, ". ".join(description))


def _id(part: FleetRobot | RobotMonitor) -> str:
    return f"{part.robot.name}/{part.index}" if isinstance(part, RobotMonitor) else part.name


def _robot(robot: FleetRobot) -> DiagramNode:
    graph = robot.graph
    lines = [robot.name, f"{robot.platform.name} {robot.form.prefix or '/'}"]
    if graph is not None:
        lines += [f"{graph.key} {graph.name}"] if graph.name else []
        lines += [f"partition {graph.partition}"] if graph.partition else []
    return DiagramNode(_id(robot), tuple(lines), "rounded", "neutral")


def _monitor(fleet: Fleet, monitor: RobotMonitor) -> DiagramNode:
    title, demands = monitor.bound.kind.title, fleet.bindings_of(monitor)
    rows = [f"gives {name}" for name in monitor.guarantees]
    rows += [f"needs {binding.demand}" for binding in demands]
    tone: Tone = "demand" if demands else "output"
    lines = (monitor.id, *(rows or [title]))
    return DiagramNode(_id(monitor), lines, "table", tone, f"{monitor.name} ({title})")


def _between(fleet: Fleet) -> Iterator[DiagramEdge]:
    """Yield a line for each guarantee that may fulfil a demand of another robot."""
    labels: dict[tuple[str, str], list[str]] = {}
    for binding in fleet.bindings:
        for fulfilment in binding.fulfilments:
            ends = _id(fulfilment.provider), _id(binding.user)
            labels.setdefault(ends, []).append(f"{fulfilment.guarantee} for {binding.demand}")
    for (source, target), texts in labels.items():
        yield DiagramEdge(source, target, ", ".join(texts))


def _within(fleet: Fleet, robot: FleetRobot) -> Iterator[DiagramEdge]:
    """Yield a line for each monitor of a robot that another one of it relies on, by topics."""
    monitors = {_id(own): wired(own.bound) for own in fleet.monitors_of(robot)}
    publishers = {topic: id_ for id_, monitor in monitors.items() for topic, _ in monitor.published}
    ends = {
        (publishers[topic], id_): None
        for id_, monitor in monitors.items()
        for reads in monitor.topics_read.values()
        for topic, _ in reads
        if topic in publishers
    }
    for source, target in ends:
        yield DiagramEdge(source, target)
