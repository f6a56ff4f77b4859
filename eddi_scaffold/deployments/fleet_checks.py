"""``check`` of a deployment file: each robot by itself, and what only all of them show."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import replace
from pathlib import Path

from eddi_scaffold.common.files import Source
from eddi_scaffold.common.identifiers import attribute
from eddi_scaffold.common.problems import Problem, has_errors, problem
from eddi_scaffold.config.file import ConfigFile
from eddi_scaffold.config.schema import OutputEntry, SimulatorOutput
from eddi_scaffold.deployments.fleet import Fleet, among_others, read_whole_fleet
from eddi_scaffold.deployments.joining import packages_of, unanswered
from eddi_scaffold.deployments.lifetimes import check_ages
from eddi_scaffold.deployments.offers import RobotMonitor
from eddi_scaffold.deployments.robots import FleetRobot, GuaranteeSource, with_demand_inputs
from eddi_scaffold.deployments.station import check_station, is_closed
from eddi_scaffold.deployments.topics import Deployment, Member, absent_publishers, deployment
from eddi_scaffold.deployments.wiring import check_hidden, check_wiring
from eddi_scaffold.kinds import ReadResult
from eddi_scaffold.monitors.publications import MESSAGE_PACKAGE
from eddi_scaffold.monitors.robots import fleet_message


def read_directly(fleet: Fleet, monitor: RobotMonitor) -> ConfigFile:
    """Return the configuration of a monitor that publishes for others, and reads them, by topic."""
    config, shared = monitor.config, fleet.file.form.Fleet
    topic, lease = shared.topic, shared.lease
    if monitor.guarantees:
        own = OutputEntry.model_construct(id="peers", topic=_topic(monitor, topic))
        outputs = [*config.config.EDDIOutputs, own]
        config = replace(config, config=config.config.model_copy(update={"EDDIOutputs": outputs}))
    for binding in fleet.bindings_of(monitor):
        sources = [
            GuaranteeSource(
                SimulatorOutput(
                    id=f"peer_{fulfilment.provider.robot.name}_{attribute(fulfilment.guarantee)}",
                    type=f"{MESSAGE_PACKAGE}/{fulfilment.provider.bound.kind.output_message}",
                    topic=_topic(fulfilment.provider, topic),
                ),
                fulfilment.guarantee,
            )
            for fulfilment in binding.fulfilments
        ]
        if sources:
            config = with_demand_inputs(config, binding.demand, sources, lease, binding.place)
    return config


def _topic(monitor: RobotMonitor, topic: str) -> str:
    return f"{topic}/{monitor.robot.name}/{monitor.bound.package}"


_OWN_PERIODS = 2
"""Of a robot that relies on a word: it is an answer to its own last word, and used at its step."""


def check_fleet(
    source: Source, read: Callable[[Path], ReadResult]
) -> tuple[list[Problem], frozenset[Path]]:
    """Return all that is wrong with a deployment file and what it names, and these files.

    Args:
        source: the deployment file.
        read: reads a file of models, with all problems in it; raises EddiError.
    """
    fleet, problems = read_whole_fleet(source, read)
    if fleet is None:
        return problems, frozenset()
    pairs = [pair for robot in fleet.robots for pair in robot.pairs]
    names = [name for model, config in pairs for name in (model.source.name, config.name)]
    return problems_of(fleet, problems), frozenset(Path(name).resolve() for name in names)


def problems_of(fleet: Fleet, found: Iterable[Problem]) -> list[Problem]:
    """Return what is wrong with robots that could be read: each by itself, then together.

    Args:
        fleet: the robots.
        found: when they were read.
    """
    told = unanswered(found, [model for robot in fleet.robots for model, _ in robot.pairs])
    problems = [*told, *check_station(fleet), *_check_names(fleet), *_check_ages(fleet)]
    closed = is_closed(fleet)
    members: dict[FleetRobot, list[Member]] = {}
    for robot in fleet.robots:
        monitors, found = fleet.bound_monitors(
            robot, lambda monitor: among_others(fleet, monitor, {}, closed=closed)
        )
        members[robot] = [Member(monitor, robot.form.prefix) for monitor in monitors]
        problems += [
            *(_with_binding(one, robot) for one in found),
            *packages_of(monitors, robot.platform, None)[1],
        ]
    if not has_errors(problems):
        for robots in _meetings(fleet.robots):
            problems += _check_together([member for of in robots for member in _members(fleet, of)])
            together = [one for of in robots for one in members[of]]
            problems += check_hidden([one.participant for one in together])
            problems += check_ages(deployment(together))  # words have ages of their own: D015
    return problems


def _with_binding(problem: Problem, robot: FleetRobot) -> Problem:
    """Return the warning that nothing provides an input, and what a deployment file can do.

    Args:
        problem: of a configuration, which other robots may share.
        robot: in which it was found.
    """
    if problem.code != "K014":
        return problem
    hint = f"{problem.hint}, or bind the demand of {robot.name} in the deployment file"
    return replace(problem, message=f"{robot.name}: {problem.message}", hint=hint)


def _members(fleet: Fleet, robot: FleetRobot) -> list[Member]:
    monitors, _ = fleet.bound_monitors(robot, lambda monitor: read_directly(fleet, monitor))
    return [Member(monitor, robot.form.prefix) for monitor in monitors]


def _meetings(robots: Sequence[FleetRobot]) -> list[list[FleetRobot]]:
    """Return the robots in groups that hear each other."""
    groups: dict[object, list[FleetRobot]] = {}
    for robot in robots:
        groups.setdefault(robot.graph or robot.name, []).append(robot)
    return list(groups.values())


def _check_together(members: Sequence[Member]) -> Iterator[Problem]:
    yield from check_wiring(members)
    together = deployment(members)
    yield from absent_publishers(together)
    yield from _check_shared(together)


def _check_shared(together: Deployment) -> Iterator[Problem]:
    """Report topics of sensors that several robots read (D014)."""
    first: dict[str, Member] = {}
    for member in together.members:
        used = {
            requirement.id for binding in member.monitor.inputs for requirement in binding.requires
        }
        for index, source in enumerate(member.config.config.SimulatorOutputs):
            if source.id not in used or member.topic(source.topic) in together.publishers:
                continue
            before = first.setdefault(source.topic, member) if source.topic[0] == "/" else member
            if before.namespace != member.namespace:
                place = member.config.place("SimulatorOutputs", index, "topic")
                yield problem(
                    "D014",
                    place,
                    other=before.name,
                    robot=member.name,
                    topic=source.topic,
                    relative=source.topic[1:],
                )


def _check_names(fleet: Fleet) -> Iterator[Problem]:
    """Report monitors of one robot whose words nobody could tell apart (D010)."""
    relied = {
        fulfilment.provider for binding in fleet.bindings for fulfilment in binding.fulfilments
    }
    first: dict[tuple[str, str], RobotMonitor] = {}
    for monitor in fleet.monitors:
        if monitor.robot.graph is None or fleet_message(monitor.bound.kind) is None:
            continue
        before = first.setdefault((monitor.robot.name, monitor.bound.model.name), monitor)
        if before is not monitor:
            yield problem(
                "D010.same_model" if relied & {before, monitor} else "D010.same_model_unheard",
                fleet.file.place("Robots", monitor.robot.number, "monitors", monitor.index),
                first=before.name,
                second=monitor.name,
                model=monitor.bound.model.name,
            )


def _check_ages(fleet: Fleet) -> Iterator[Problem]:
    """Report age limits that end before the next word can have come (D015)."""
    for binding in fleet.bindings:
        config = binding.user.config
        for index, entry in enumerate(config.config.EDDIInputs):
            limit = entry.max_age
            if entry.id != binding.demand or not isinstance(limit, float):
                continue
            for monitor in dict.fromkeys(fulfilment.provider for fulfilment in binding.fulfilments):
                least = _OWN_PERIODS / binding.user.frequency + 1 / monitor.frequency
                if limit < least:
                    place = config.place("EDDIInputs", index, "max_age")
                    yield problem(
                        "D015",
                        place,
                        demand=binding.demand,
                        limit=limit,
                        source=monitor.name,
                        age=least,
                        user=binding.user.name,
                    )
