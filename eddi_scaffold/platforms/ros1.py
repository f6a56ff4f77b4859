"""ROS 1: catkin packages below ``src/eddi_monitor`` of a workspace."""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from pathlib import Path
from shlex import quote

import rospkg

from eddi_scaffold import platforms
from eddi_scaffold.common.problems import Problem
from eddi_scaffold.kinds import JsonValue
from eddi_scaffold.monitors.binding import BoundMonitor, known_types
from eddi_scaffold.monitors.message_types import known_messages
from eddi_scaffold.platforms import Choices, PackageAnswers, ros_packages
from eddi_scaffold.program.runtime_parts import HOST

METAPACKAGE = "eddi_monitor"
_IMPORTED_BY_ROSPY = (
    "catkin", "catkin_pkg", "defusedxml", "diagnostic_msgs", "genmsg", "genpy", "numpy", "rosclean",
    "rosgraph", "rosgraph_msgs", "roscpp", "roslaunch", "roslib", "roslz4", "rosmaster", "rosnode",
    "rospkg", "rospy", "rosservice", "rostopic", "setuptools", "std_msgs", "std_srvs", "yaml",
)  # fmt: skip


def taken_names(root: Path | None) -> Mapping[str, str]:
    """Return package names that must not be used, with the reason."""
    return ros_packages.taken_names(root, rospkg.get_ros_paths(), _IMPORTED_BY_ROSPY, [METAPACKAGE])


MONITOR, MESSAGES, META, LAUNCHER, RUNTIME = (
    f"ros1_{part}" for part in ("monitor", "messages", "metapackage", "launcher", "runtime")
)


def monitor_answers(monitor: BoundMonitor) -> tuple[PackageAnswers, list[Problem]]:
    """Return the answers of one monitor package."""
    known = known_types(monitor.config, known_messages())
    choices: Choices = {platforms.RUNTIME: platforms.VENDORED, platforms.SINGLE_PROCESS: False}
    package, _, problems = ros_packages.monitor_package(monitor, known, MONITOR, "src/", choices)
    return package, problems


def support_answers(monitors: Mapping[str, Mapping[str, JsonValue]]) -> list[PackageAnswers]:
    """Return the answers of messages, launcher, metapackage, and of the runtime if one needs it."""
    single = all(monitor.get(platforms.SINGLE_PROCESS) is True for monitor in monitors.values())
    templates, host = (MESSAGES, LAUNCHER, RUNTIME), [HOST] if single else ()
    launcher = {"single_process": single}
    messages, *others = ros_packages.support_packages(monitors, templates, launcher, host)
    meta = ros_packages.package_answers(
        META,
        METAPACKAGE,
        "All EDDI runtime monitors of this workspace",
        monitors,
        monitors=sorted(monitors),
        runtime=platforms.runtime_of(monitors),
    )
    return [messages, PackageAnswers(METAPACKAGE, meta), *others]


def _next_steps(place: Path, _monitors: Sequence[str]) -> Sequence[str]:
    active = "VIRTUAL_ENV" in os.environ  # its Python hides that of ROS
    return [
        *(["deactivate  # the virtual environment: ROS needs the Python of the system"] * active),
        *_build(place),
        f"roslaunch {ros_packages.LAUNCHER} eddi.launch",
    ]


def _build(place: Path) -> Sequence[str]:
    return [
        platforms.built_in(place, "catkin_make -DPYTHON_EXECUTABLE=/usr/bin/python3"),
        "source devel/setup.bash",
    ]


def _steps_of_robot(
    at: platforms.MeetingPlace, place: Path, namespace: str, _monitors: Sequence[str]
) -> Sequence[str]:
    uri = f"ROS_MASTER_URI={quote(at.name)} " if at.name else ""
    robot = f"robot.launch ns:={namespace.removeprefix('/')}" if namespace else "eddi.launch"
    return [*_build(place), f"{uri}roslaunch {ros_packages.LAUNCHER} {robot}"]


PLATFORM = platforms.Platform(
    name="ros1",
    templates=(MONITOR, MESSAGES, META, LAUNCHER, RUNTIME),
    workspace="catkin workspace",
    root="src/eddi_monitor",
    monitor=monitor_answers,
    support=support_answers,
    taken_names=taken_names,
    next_steps=_next_steps,
    meeting=platforms.Meeting("master", "", _steps_of_robot),
)
