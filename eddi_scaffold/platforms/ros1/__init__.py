"""ROS 1: catkin packages below ``src/eddi_monitor`` of a workspace."""

import os
from collections.abc import Sequence
from pathlib import Path
from shlex import quote

from eddi_scaffold.platforms import Meeting, MeetingPlace, Platform, Workspace, built_in
from eddi_scaffold.platforms.ros1 import templates
from eddi_scaffold.platforms.ros1.names import taken_names
from eddi_scaffold.platforms.ros1.package_answers import monitor_answers, support_answers
from eddi_scaffold.ros.package_names import LAUNCHER


def _next_steps(place: Path, _monitors: Sequence[str]) -> Sequence[str]:
    active = "VIRTUAL_ENV" in os.environ  # its Python hides that of ROS
    return [
        *(["deactivate  # the virtual environment: ROS needs the Python of the system"] * active),
        *_build(place),
        f"roslaunch {LAUNCHER} eddi.launch",
    ]


def _build(place: Path) -> Sequence[str]:
    return [
        built_in(place, "catkin_make -DPYTHON_EXECUTABLE=/usr/bin/python3"),
        "source devel/setup.bash",
    ]


def _steps_of_robot(
    at: MeetingPlace, place: Path, namespace: str, _monitors: Sequence[str]
) -> Sequence[str]:
    uri = f"ROS_MASTER_URI={quote(at.name)} " if at.name else ""
    robot = f"robot.launch ns:={namespace.removeprefix('/')}" if namespace else "eddi.launch"
    return [*_build(place), f"{uri}roslaunch {LAUNCHER} {robot}"]


PLATFORM = Platform(
    name="ros1",
    templates=templates.ALL,
    workspace=Workspace("catkin workspace", "src/eddi_monitor"),
    needs_config=True,
    monitor=monitor_answers,
    support=support_answers,
    taken_names=taken_names,
    next_steps=_next_steps,
    meeting=Meeting("master", "", _steps_of_robot),
)
