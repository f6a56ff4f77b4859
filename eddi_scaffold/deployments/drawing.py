"""``diagram`` of a deployment file: robots, their monitors, and who relies on whom."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from pathlib import Path

from eddi_scaffold.common.files import Source
from eddi_scaffold.common.problems import EddiError
from eddi_scaffold.deployments.fleet import Fleet, read_whole_fleet
from eddi_scaffold.deployments.offers import RobotMonitor
from eddi_scaffold.deployments.robots import FleetRobot
from eddi_scaffold.deployments.topics import Member
from eddi_scaffold.diagrams import Diagram, DiagramEdge, DiagramNode, LegendEntry, Tone, drawn
from eddi_scaffold.kinds import ReadResult


def picture_of_fleet(source: Source, read: Callable[[Path], ReadResult]) -> str:
    """Return the SVG of a deployment file.

    Args:
        source: the deployment file.
        read: reads a file of models; raises EddiError.

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
        *(_monitor(fleet, seat) for seat in fleet.seats),
    ]
    edges = [
        *(DiagramEdge(_id(seat.robot), _id(seat), arrow=False) for seat in fleet.seats),
        *(edge for robot in fleet.robots for edge in _within(fleet, robot)),
        *_between(fleet),
    ]
    count = f"{len(fleet.robots)} robots, {len(fleet.seats)} monitors"
    lines = [
        f"{bond.demand} of {bond.user.name} is fulfilled by "
        + " or ".join(f"{offer.guarantee} of {offer.seat.name}" for offer in bond.offers)
        for bond in fleet.bonds
    ]
    return Diagram(
        title,
        tuple(nodes),
        tuple(edges),
        "down",
        (
            LegendEntry("robot", "rounded", "neutral"),
            LegendEntry("monitor", "table", "output"),
            LegendEntry("monitor with demands of other robots", "table", "demand"),
        ),
        ". ".join([count, *lines]),
    )


def _id(one: FleetRobot | RobotMonitor) -> str:
    return f"{one.robot.name}/{one.index}" if isinstance(one, RobotMonitor) else one.name


def _robot(robot: FleetRobot) -> DiagramNode:
    at = robot.graph
    place = f"{at.key} {at.name}" if at is not None and at.name else ""
    part = f"partition {at.partition}" if at is not None and at.partition else ""
    lines = (robot.name, " ".join((robot.platform.name, robot.form.prefix or "/")), place, part)
    return DiagramNode(_id(robot), tuple(line for line in lines if line), "rounded", "neutral")


def _monitor(fleet: Fleet, seat: RobotMonitor) -> DiagramNode:
    bound = [bond.demand for bond in fleet.bonds_of(seat)]
    rows = [f"gives {name}" for name in seat.guarantees] + [f"needs {name}" for name in bound]
    tone: Tone = "demand" if bound else "output"
    lines = (seat.id, *(rows or [seat.monitor.kind.title]))
    return DiagramNode(_id(seat), lines, "table", tone, f"{seat.name} ({seat.monitor.kind.title})")


def _between(fleet: Fleet) -> Iterator[DiagramEdge]:
    """Yield a line for each guarantee that may fulfil a demand of another robot."""
    labels: dict[tuple[str, str], list[str]] = {}
    for bond in fleet.bonds:
        for offer in bond.offers:
            ends = _id(offer.seat), _id(bond.user)
            labels.setdefault(ends, []).append(f"{offer.guarantee} for {bond.demand}")
    for (source, target), found in labels.items():
        yield DiagramEdge(source, target, ", ".join(found))


def _within(fleet: Fleet, robot: FleetRobot) -> Iterator[DiagramEdge]:
    """Yield a line for each monitor of a robot that another one of it relies on, by topics."""
    own = [(seat, Member(seat.monitor).participant) for seat in fleet.seats_of(robot)]
    publishers = {topic: seat for seat, one in own for topic, _ in one.published}
    ends = {
        (_id(publishers[topic]), _id(seat)): None
        for seat, one in own
        for reads in one.topics_read.values()
        for topic, _ in reads
        if topic in publishers
    }
    for source, target in ends:
        yield DiagramEdge(source, target)
