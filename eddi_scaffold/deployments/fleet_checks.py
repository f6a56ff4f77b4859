"""A deployment file checked, drawn, and what is generated of it: a workspace for each robot."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path

from eddi_scaffold.common.files import Source
from eddi_scaffold.common.identifiers import attribute
from eddi_scaffold.common.problems import EddiError, Problem, has_errors, problem
from eddi_scaffold.config.file import ConfigFile
from eddi_scaffold.config.schema import OutputEntry, SimulatorOutput
from eddi_scaffold.deployments.fleet import (
    Fleet,
    among_others,
    check_station,
    digests_of,
    is_closed,
    read_whole_fleet,
    with_station,
)
from eddi_scaffold.deployments.joining import packages_of, unanswered
from eddi_scaffold.deployments.lifetimes import check_ages
from eddi_scaffold.deployments.offers import RobotMonitor
from eddi_scaffold.deployments.robots import FleetRobot, with_demand_inputs
from eddi_scaffold.deployments.support import Deployment, WiredMonitor, wired
from eddi_scaffold.deployments.wiring import absent_publishers, check_hidden, check_wiring
from eddi_scaffold.diagrams import Diagram, DiagramEdge, DiagramNode, LegendEntry
from eddi_scaffold.diagrams.svg import drawn
from eddi_scaffold.kinds import ReadResult
from eddi_scaffold.monitors.binding import BoundMonitor
from eddi_scaffold.monitors.publications import MESSAGE_PACKAGE
from eddi_scaffold.monitors.robots import fleet_message


def read_directly(fleet: Fleet, monitor: RobotMonitor) -> ConfigFile:
    """Return the configuration of a monitor that publishes for others, and reads them, by topic."""
    config, shared = monitor.config, fleet.file.form.Fleet

    def topic(publisher: RobotMonitor) -> str:
        return f"{shared.topic}/{publisher.robot.name}/{publisher.bound.package}"

    if monitor.guarantees:
        own = OutputEntry.model_construct(id="peers", topic=topic(monitor))
        outputs = [*config.config.EDDIOutputs, own]
        config = replace(config, config=config.config.model_copy(update={"EDDIOutputs": outputs}))
    for binding in fleet.bindings_of(monitor):
        sources = []
        for fulfilment in binding.fulfilments:
            provider, guarantee = fulfilment.provider, fulfilment.guarantee
            id_ = f"peer_{provider.robot.name}_{attribute(guarantee)}"
            type_ = f"{MESSAGE_PACKAGE}/{provider.bound.kind.output_message}"
            output = SimulatorOutput(id=id_, type=type_, topic=topic(provider))
            sources.append((output, guarantee))
        config = with_demand_inputs(config, binding.demand, sources, shared.lease, binding.place)
    return config


def check_fleet(
    source: Source, read: Callable[[Path], ReadResult]
) -> tuple[list[Problem], frozenset[Path]]:
    """Return all that is wrong with a deployment file and what it names, and these files."""
    fleet, problems = read_whole_fleet(source, read)
    if fleet is None:
        return problems, frozenset()
    pairs = [pair for robot in fleet.robots for pair in robot.pairs]
    names = [name for model, config in pairs for name in (model.source.name, config.name)]
    return problems_of(fleet, problems), frozenset(Path(name).resolve() for name in names)


def problems_of(fleet: Fleet, reported: Iterable[Problem]) -> list[Problem]:
    """Return what is wrong with robots that could be read: each by itself, then together."""
    open_ = unanswered(reported, [model for robot in fleet.robots for model, _ in robot.pairs])
    problems = [*open_, *check_station(fleet), *_check_names(fleet)]
    config_of = partial(among_others, fleet, digests={}, closed=is_closed(fleet))
    groups: dict[object, list[FleetRobot]] = {}  # of robots that hear each other
    running: dict[FleetRobot, list[WiredMonitor]] = {}
    for robot in fleet.robots:
        groups.setdefault(robot.graph or robot.name, []).append(robot)
        monitors, of_robot = fleet.bound_monitors(robot, config_of)
        running[robot] = [wired(monitor, robot.form.prefix) for monitor in monitors]
        problems += [*of_robot, *packages_of(monitors, robot.platform, None)[1]]
    if has_errors(problems):
        return problems
    by_topic = partial(read_directly, fleet)
    for robots in groups.values():
        members = [
            wired(monitor, robot.form.prefix)
            for robot in robots
            for monitor in fleet.bound_monitors(robot, by_topic)[0]
        ]
        together = Deployment(members)
        problems += [*check_wiring(members), *absent_publishers(together), *_check_shared(together)]
        members = [member for robot in robots for member in running[robot]]
        problems += check_hidden(members)
        problems += check_ages(Deployment(members))
    return problems


def _check_shared(together: Deployment) -> Iterator[Problem]:
    """Report topics of sensors that several robots read (D014)."""
    first: dict[str, WiredMonitor] = {}
    for member in together.members:
        used = {name for input_ in member.facts.inputs for name in input_.requires}
        for index, source in enumerate(member.config.config.SimulatorOutputs):
            if source.id not in used or member.topic(source.topic) in together.publishers:
                continue
            before = first.setdefault(source.topic, member) if source.topic[0] == "/" else member
            if before.namespace != member.namespace:
                place = member.config.place("SimulatorOutputs", index, "topic")
                values = {"topic": source.topic, "relative": source.topic[1:]}
                yield problem("D014", place, other=before.name, robot=member.name, **values)


def _check_names(fleet: Fleet) -> Iterator[Problem]:
    """Report monitors of one robot whose statements nobody could tell apart (D010)."""
    first: dict[tuple[str, str], RobotMonitor] = {}
    for monitor in fleet.monitors:
        robot, model = monitor.robot, monitor.bound.model.name
        if robot.graph is None or fleet_message(monitor.bound.kind) is None:
            continue
        before = first.setdefault((robot.name, model), monitor)
        if before is not monitor:
            place = fleet.file.place("Robots", robot.number, "monitors", monitor.index)
            names = {"first": before.name, "second": monitor.name, "model": model}
            yield problem("D010.same_model", place, **names)


@dataclass(frozen=True, eq=False)
class Site(FleetRobot):
    """A robot with the monitors that it has among others, and the workspace or folder for them."""

    monitors: tuple[BoundMonitor, ...]

    def next_steps(self, place: Path) -> Sequence[str]:
        """Return shell commands that build the workspace and start the monitors."""
        packages = [monitor.package for monitor in self.monitors]
        meeting = self.platform.meeting
        if meeting is None or self.graph is None:
            return self.platform.next_steps(place, packages)
        return meeting.next_steps(self.graph, place, self.form.prefix, packages)


def sites_of(
    source: Source, read: Callable[[Path], ReadResult]
) -> tuple[list[Site], list[Problem]]:
    """Return what is to be generated, and the warnings.

    Raises:
        EddiError: it, or what it names, has errors.
    """
    fleet, problems = read_whole_fleet(source, read)
    if fleet is None:
        raise EddiError(*problems)
    problems = problems_of(fleet, problems)
    if has_errors(problems):
        raise EddiError(*problems)
    closed = is_closed(fleet)
    fleet = with_station(fleet)
    digests = digests_of(fleet)
    sites = []
    for robot in fleet.robots:
        monitors, reported = fleet.bound_monitors(
            robot, lambda monitor: among_others(fleet, monitor, digests, closed=closed)
        )
        if has_errors(reported):
            raise EddiError(*reported)
        sites.append(Site(**vars(robot), monitors=tuple(monitors)))
    return sites, problems


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
    robots = [
        DiagramNode(robot.name, (robot.name, robot.form.prefix or "/", robot.where), "rounded")
        for robot in fleet.robots
    ]
    ids = {monitor: f"{monitor.robot.name}/{monitor.index}" for monitor in fleet.monitors}
    monitors, edges = [], []
    for monitor, id_ in ids.items():
        rows = [f"gives {name}" for name in monitor.guarantees]
        rows += [f"needs {binding.demand}" for binding in fleet.bindings_of(monitor)]
        lines = (monitor.id, *(rows or [monitor.bound.kind.title]))
        monitors.append(DiagramNode(id_, lines, "table", "output"))
        edges.append(DiagramEdge(monitor.robot.name, id_, arrow=False))
    labels: dict[tuple[str, str], list[str]] = {}
    for binding in fleet.bindings:
        for fulfilment in binding.fulfilments:
            ends = ids[fulfilment.provider], ids[binding.user]
            labels.setdefault(ends, []).append(f"{fulfilment.guarantee} for {binding.demand}")
    edges += [DiagramEdge(*ends, ", ".join(texts)) for ends, texts in labels.items()]
    legend = (LegendEntry("robot", "rounded", "neutral"), LegendEntry("monitor", "table", "output"))
    text = f"{len(robots)} robots, {len(monitors)} monitors, and who relies on whom"
    return Diagram(title, (*robots, *monitors), tuple(edges), "down", legend, text)
