"""Several robots: who meets whom, whose guarantees may fulfil whose demands, and how each runs.

The only module that writes the keys of a configuration by which a robot is one of a fleet.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path

from eddi_scaffold.common.files import Source
from eddi_scaffold.common.identifiers import attribute
from eddi_scaffold.common.problems import Problem, has_errors
from eddi_scaffold.config.deployment_file import FleetFile, read_fleet
from eddi_scaffold.config.file import ConfigFile
from eddi_scaffold.config.schema import FleetSection, PeersSection, SimulatorOutput
from eddi_scaffold.deployments.joining import join_pairs
from eddi_scaffold.deployments.offers import DemandBinding, RobotMonitor, demand_bindings
from eddi_scaffold.deployments.robots import (
    FleetRobot,
    GuaranteeSource,
    read_robots,
    with_demand_inputs,
)
from eddi_scaffold.kinds import ReadResult
from eddi_scaffold.monitors.binding import BoundMonitor, monitor_of
from eddi_scaffold.monitors.robots import MESSAGE, fleet_message


@dataclass(frozen=True)
class Fleet:
    """Robots that meet."""

    file: FleetFile  # the deployment file
    robots: tuple[FleetRobot, ...]  # in its order
    monitors: tuple[RobotMonitor, ...]  # the monitors of all robots, as they are without the others
    bindings: tuple[DemandBinding, ...]  # the demands that other robots fulfil

    def monitors_of(self, robot: FleetRobot) -> list[RobotMonitor]:
        """Return the monitors of one robot."""
        return [monitor for monitor in self.monitors if monitor.robot is robot]

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
            for monitor in self.monitors_of(robot)
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
            sources.append(GuaranteeSource(output, entry.guarantee))
        config = with_demand_inputs(config, binding.demand, sources, shared.lease, binding.place)
    return config
