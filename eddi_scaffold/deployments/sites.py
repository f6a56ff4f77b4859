"""What is generated of a deployment file: a workspace for each robot and for the station."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

from eddi_scaffold.common.files import Source
from eddi_scaffold.common.problems import EddiError, Problem, has_errors
from eddi_scaffold.deployments.fleet import among_others, digests_of, read_whole_fleet
from eddi_scaffold.deployments.fleet_checks import problems_of
from eddi_scaffold.deployments.robots import FleetRobot
from eddi_scaffold.deployments.station import is_closed, with_station
from eddi_scaffold.kinds import ReadResult
from eddi_scaffold.monitors.binding import BoundMonitor
from eddi_scaffold.platforms import Platform


@dataclass(frozen=True, eq=False)
class Site:
    """The workspace or folder of one robot."""

    robot: FleetRobot  # its name is that of the folder
    monitors: tuple[BoundMonitor, ...]  # with the configurations that they have on it

    @property
    def name(self) -> str:
        """Name of the robot, and of the folder."""
        return self.robot.name

    @property
    def platform(self) -> Platform:
        """Where the monitors run."""
        return self.robot.platform

    def next_steps(self, place: Path) -> Sequence[str]:
        """Return shell commands that build the workspace and start the monitors."""
        packages = [monitor.package for monitor in self.monitors]
        meeting, robot = self.platform.meeting, self.robot
        if meeting is None or robot.graph is None:
            return self.platform.next_steps(place, packages)
        return meeting.next_steps(robot.graph, place, robot.form.prefix, packages)


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
        sites.append(Site(robot, tuple(monitors)))
    return sites, problems
