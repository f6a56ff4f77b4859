"""Several robots: who meets whom, and whose guarantees may fulfil whose demands."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from eddi_scaffold.common.files import Source
from eddi_scaffold.common.problems import Problem, has_errors
from eddi_scaffold.config.deployment_file import FleetFile, read_fleet
from eddi_scaffold.config.file import ConfigFile
from eddi_scaffold.deployments.joining import join_pairs
from eddi_scaffold.deployments.offers import DemandBinding, RobotMonitor, bonds_of
from eddi_scaffold.deployments.robots import FleetRobot, read_robots
from eddi_scaffold.kinds import Model, ReadResult, kinds
from eddi_scaffold.monitors.binding import BoundMonitor, monitor_of


@dataclass(frozen=True)
class Fleet:
    """Robots that meet.

    Attributes:
        file: the deployment file.
        robots: in its order.
        seats: the monitors of all robots, as they are without the others.
        bonds: the demands that other robots fulfil.
    """

    file: FleetFile
    robots: tuple[FleetRobot, ...]
    seats: tuple[RobotMonitor, ...]
    bonds: tuple[DemandBinding, ...]

    def seats_of(self, robot: FleetRobot) -> list[RobotMonitor]:
        """Return the monitors of one robot."""
        return [seat for seat in self.seats if seat.robot is robot]

    def bonds_of(self, seat: RobotMonitor) -> list[DemandBinding]:
        """Return the demands of a monitor that other robots fulfil."""
        return [bond for bond in self.bonds if bond.user is seat]

    def monitors(
        self, robot: FleetRobot, config_of: Callable[[RobotMonitor], ConfigFile]
    ) -> tuple[list[BoundMonitor], list[Problem]]:
        """Return the monitors of a robot with other configurations, and what is wrong with them."""
        seats = self.seats_of(robot)
        return join_pairs([(_model(seat), config_of(seat)) for seat in seats])


def read_whole_fleet(
    source: Source, read: Callable[[Path], ReadResult]
) -> tuple[Fleet | None, list[Problem]]:
    """Read a deployment file and all that it names; ``None`` where something is missing.

    Args:
        source: the deployment file.
        read: reads a file of models; raises EddiError.
    """
    file, problems = read_fleet(source)
    if file is None:
        return None, problems
    robots, found = read_robots(file, read)
    problems += found
    if has_errors(problems):
        return None, problems
    seats: list[RobotMonitor] = []
    for robot in robots:
        for index, (model, config) in enumerate(robot.pairs):
            monitor, found = monitor_of(model, kinds()[model.kind], config)
            if monitor is None:
                problems += found
            else:  # what is only a warning may be due to a demand that is not bound yet
                seats.append(RobotMonitor(robot, index, monitor))
    if has_errors(problems):
        return None, problems
    bonds, found = bonds_of(file, seats)
    problems += found
    if has_errors(problems):  # what else there is would follow from these
        return None, problems
    return Fleet(file, tuple(robots), tuple(seats), tuple(bonds)), problems


def _model(seat: RobotMonitor) -> Model:
    """Return the model as it was read, without the options of the configuration."""
    return seat.robot.pairs[seat.index][0]
