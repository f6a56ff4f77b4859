"""Several robots: who meets whom, whose guarantees may fulfil whose demands, and how each runs.

The control station is one more, whose ConSert has every guarantee of those that it hears.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path

from eddi_scaffold.common.files import Source
from eddi_scaffold.common.identifiers import attribute, free_name
from eddi_scaffold.common.problems import EddiError, Problem, has_errors, problem
from eddi_scaffold.config.deployment_file import FleetFile, Robot, read_fleet
from eddi_scaffold.config.file import ConfigFile
from eddi_scaffold.config.schema import FleetSection, PeersSection, SimulatorOutput
from eddi_scaffold.deployments.joining import join_pairs
from eddi_scaffold.deployments.offers import (
    DemandBinding,
    Fulfilment,
    RobotMonitor,
    demand_bindings,
)
from eddi_scaffold.deployments.robots import (
    FleetRobot,
    Pair,
    graph_of,
    read_robots,
    with_demand_inputs,
)
from eddi_scaffold.deployments.support import publishers_of, wired
from eddi_scaffold.kinds import ReadResult
from eddi_scaffold.monitors.binding import BoundMonitor, monitor_of
from eddi_scaffold.monitors.config_reading import read_config
from eddi_scaffold.monitors.loading import read_models
from eddi_scaffold.monitors.robots import MESSAGE, fleet_message
from eddi_scaffold.platforms import MeetingPlace, Platform, chosen
from eddi_scaffold.yaml_text.nodes import dump_plain


@dataclass(frozen=True)
class Fleet:
    """Robots that meet."""

    file: FleetFile  # the deployment file
    robots: tuple[FleetRobot, ...]  # in its order
    monitors: tuple[RobotMonitor, ...]  # the monitors of all robots, as they are without the others
    bindings: tuple[DemandBinding, ...]  # the demands that other robots fulfil

    def bindings_of(self, monitor: RobotMonitor) -> list[DemandBinding]:
        """Return the demands of a monitor that other robots fulfil."""
        return [binding for binding in self.bindings if binding.user is monitor]

    def bound_monitors(
        self, robot: FleetRobot, config_of: Callable[[RobotMonitor], ConfigFile]
    ) -> tuple[list[BoundMonitor], list[Problem]]:
        """Return the monitors of a robot with other configurations, and what is wrong with them."""
        # the model as it was read, without the options of the configuration
        pairs = [
            (robot.pairs[monitor.index][0], config_of(monitor))
            for monitor in self.monitors
            if monitor.robot is robot
        ]
        return join_pairs(pairs)


def read_whole_fleet(
    source: Source, read: Callable[[Path], ReadResult]
) -> tuple[Fleet | None, list[Problem]]:
    """Read a deployment file and all that it names; ``None`` where something is missing."""
    file, problems = read_fleet(source)
    if file is None:
        return None, problems
    robots, reported = read_robots(file, read)
    problems += reported
    if has_errors(problems):
        return None, problems
    monitors: list[RobotMonitor] = []
    for robot in robots:
        for index, (model, config) in enumerate(robot.pairs):
            monitor, reported = monitor_of(model, config)
            if monitor is None:
                problems += reported
            else:  # what is only a warning may be due to a demand that is not bound yet
                monitors.append(RobotMonitor(robot, index, monitor))
    if has_errors(problems):
        return None, problems
    bindings, reported = demand_bindings(file, monitors)
    problems += reported
    if has_errors(problems):  # what else there is would follow from these
        return None, problems
    return Fleet(file, tuple(robots), tuple(monitors), tuple(bindings)), problems


Digests = Mapping[tuple[str, int], str]
"""Robot and number of its monitor -> SHA-256 of the data of its model."""
_NOT_YET = "0" * 64


def digests_of(fleet: Fleet) -> Digests:
    """Return the digests by which robots know each other's models.

    A digest covers how the inputs of a model are made, though not of whose word: of any robot there
    is a source for each model, and how many these are is known only with the digests of others. It
    settles after as many rounds as there are robots in the longest chain of demands.
    """
    digests: Digests = {}
    for _ in fleet.monitors:
        before = digests
        config_of = partial(among_others, fleet, digests=before)
        digests = {
            (robot.name, index): monitor.facts.digest
            for robot in fleet.robots
            for index, monitor in enumerate(fleet.bound_monitors(robot, config_of)[0])
        }
        if digests == before:
            break
    return digests


def among_others(
    fleet: Fleet, monitor: RobotMonitor, digests: Digests, *, closed: bool = False
) -> ConfigFile:
    """Return the configuration of a monitor on its robot, one of a fleet."""
    shared, config = fleet.file.form.Fleet, monitor.config
    if monitor.robot.graph is None or fleet_message(monitor.bound.kind) is None:
        return config
    section = FleetSection(
        robot=monitor.robot.name, topic=shared.topic, lease=shared.lease, closed=closed
    )
    places = dict(config.places)
    places["Fleet",] = fleet.file.place("Fleet")
    places["Fleet", "lease"] = fleet.file.place("Fleet", "lease")
    form = config.config.model_copy(update={"Fleet": section})
    config = replace(config, config=form, places=places)
    for binding in fleet.bindings_of(monitor):
        peers = dict.fromkeys(  # of any robot, each model once
            PeersSection(
                robots="any" if binding.of_any else (fulfilment.provider.robot.name,),
                model=fulfilment.provider.bound.model.name,
                digest=digests.get(fulfilment.provider.key, _NOT_YET),
                guarantee=fulfilment.guarantee,
            )
            for fulfilment in binding.fulfilments
        )
        sources = []
        for entry in peers:
            robot = "any" if binding.of_any else entry.robots[0]
            id_ = f"peer_{robot}_{attribute(entry.guarantee)}"
            output = SimulatorOutput(id=id_, type=MESSAGE, topic=shared.topic, peers=entry)
            sources.append((output, entry.guarantee))
        config = with_demand_inputs(config, binding.demand, sources, shared.lease, binding.place)
    return config


STATION = "Station"
_DEMAND = "told_"  # before the name of a guarantee: the demand that it is active


def with_station(fleet: Fleet) -> Fleet:
    """Return a fleet with its control station, without one where there is nothing to hear.

    Raises:
        EddiError: there is no such platform (G008).
    """
    name = fleet.file.form.Station.name
    platform, graph = _place(fleet)
    offered: dict[str, Fulfilment] = {}  # by a name that tells whose they are
    for fulfilment in _heard(fleet):
        whose = f"{fulfilment.provider.robot.name}_{attribute(fulfilment.guarantee)}"
        offered[free_name(whose, offered)] = fulfilment
    if platform is None or not offered:
        return fleet
    model, config = _pair(name, offered)
    entry = Robot.model_construct(name=name, platform=platform.name, monitors=[])
    robot = FleetRobot(entry, len(fleet.robots), platform, graph, ((model, config),))
    bound, problems = monitor_of(model, config)
    if bound is None:
        raise EddiError(*problems)
    monitor, place = RobotMonitor(robot, 0, bound), fleet.file.place(STATION)
    bindings = [
        DemandBinding(monitor, f"{_DEMAND}{id_}", (fulfilment,), of_any=False, place=place)
        for id_, fulfilment in offered.items()
    ]
    return replace(
        fleet,
        robots=(*fleet.robots, robot),
        monitors=(*fleet.monitors, monitor),
        bindings=(*fleet.bindings, *bindings),
    )


def check_station(fleet: Fleet) -> Iterator[Problem]:
    """Report a station that hears nothing where it was put (D013)."""
    place = fleet.file.place(STATION)
    if place != fleet.file.place() and not _heard(fleet):
        yield problem("D013.station", place, station=fleet.file.form.Station.name)


def _place(fleet: Fleet) -> tuple[Platform | None, MeetingPlace | None]:
    """Return platform and place of the station: by default those of the first robot that has one.

    Raises:
        EddiError: there is no such platform (G008).
    """
    form = fleet.file.form.Station
    first = next((robot for robot in fleet.robots if robot.graph is not None), None)
    if form.platform is not None:
        platform = chosen(form.platform)
    elif first is not None:
        platform = first.platform
    else:
        return None, None
    is_named = (form.master, form.domain, form.partition) != (None, None, None)
    return platform, graph_of(form if first is None or is_named else first.form, platform)


def _heard(fleet: Fleet) -> list[Fulfilment]:
    """Return the guarantees of all robots where the station is."""
    _, graph = _place(fleet)
    return [
        Fulfilment(monitor, guarantee)
        for monitor in fleet.monitors
        if graph is not None and monitor.robot.graph == graph
        for guarantee in monitor.guarantees
    ]


def _pair(name: str, offered: Mapping[str, Fulfilment]) -> Pair:
    model = {
        "demands": {f"{_DEMAND}{id_}": {"is": "bool", "type": "Active"} for id_ in offered},
        "guarantees": {
            id_: {
                "when": f"{_DEMAND}{id_}",
                "type": "Active",
                "description": f"{of.provider.name} guarantees {of.guarantee}",
            }
            for id_, of in offered.items()
        },
    }
    frequency = max(of.provider.config.config.Model.frequency for of in offered.values())
    config = {
        "Model": {"id": name, "type": "ConSert", "frequency": frequency},
        "EDDIOutputs": [{"id": "station", "topic": "guarantees"}],
    }
    reading = read_models(Source(f"{name}.yml", dump_plain(model).encode()))
    file, problems = read_config(Source(f"{name}_config.yml", dump_plain(config).encode()))
    if file is None or not reading.models:
        raise EddiError(*reading.problems, *problems)
    return reading.models[0], file


def is_closed(fleet: Fleet) -> bool:
    """Return whether all circles of a fleet are found in its file.

    Who relies on any robot may rely on one that is not in the file. By its digest its model is one
    of those here, and so no circle leads through it if their guarantees rest on no other monitor.
    """
    of_any = [binding.fulfilments for binding in fleet.bindings if binding.of_any]
    if not of_any:
        return True
    monitors = {
        monitor: wired(monitor.bound, monitor.robot.form.prefix) for monitor in fleet.monitors
    }
    published = publishers_of([*monitors.values()])
    bound_demands = {(binding.user, binding.demand) for binding in fleet.bindings}

    def rests_on_others(fulfilment: Fulfilment) -> bool:
        provider, monitor = fulfilment.provider, monitors[fulfilment.provider]
        return any(
            (provider, input_) in bound_demands
            or any(topic in published for topic, _ in monitor.topics_read.get(input_, ()))
            for input_ in monitor.claims[fulfilment.guarantee].rests_on
        )

    return not any(rests_on_others(fulfilment) for each in of_any for fulfilment in each)
