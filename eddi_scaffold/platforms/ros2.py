"""ROS 2: ament packages below ``src/eddi_monitor`` of a colcon workspace."""

from __future__ import annotations

import os
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path

from eddi_scaffold import platforms
from eddi_scaffold.common.problems import Problem, problem
from eddi_scaffold.kinds import JsonValue
from eddi_scaffold.monitors.binding import BoundMonitor
from eddi_scaffold.monitors.nodes import MonitorNode
from eddi_scaffold.platforms import PackageAnswers, ros_packages

MONITOR, *SUPPORT = (f"ros2_{part}" for part in ("monitor", "messages", "launcher", "runtime"))


def monitor_answers(monitor: BoundMonitor) -> tuple[PackageAnswers, list[Problem]]:
    """Return the answers of one monitor package."""
    known, choices = ros_packages.types_of(monitor), {platforms.RUNTIME: platforms.VENDORED}
    package, node, problems = ros_packages.monitor_package(
        monitor, known, MONITOR, "", choices, is_ros2=True
    )
    return package, [*problems, *_check_topics(node)]


def _check_topics(node: MonitorNode) -> Iterator[Problem]:
    """Refuse names that ROS 1 takes and ROS 2 does not."""
    place = node.config.place
    sources = enumerate(node.config.config.SimulatorOutputs)
    places = {source.topic: place("SimulatorOutputs", index, "topic") for index, source in sources}
    used = {topic.output.topic: topic.place for topic in node.publications}
    used |= {topic.topic: places[topic.topic] for topic in node.subscribed}
    used |= dict.fromkeys(node.between_robots, place("Fleet", "topic"))
    for name, where in used.items():
        if any(part[:1].isdigit() for part in name.lstrip("~").split("/")):
            yield problem("K003.ros2_name", where, key=name)


def support_answers(monitors: Mapping[str, Mapping[str, JsonValue]]) -> list[PackageAnswers]:
    """Return the answers of messages, launcher, and of the runtime library if one needs it."""
    return ros_packages.support_packages(monitors, SUPPORT)


_IMPORTED_BY_RCLPY = (
    "ament_index_python", "builtin_interfaces", "diagnostic_msgs", "launch", "launch_ros", "numpy",
    "osrf_pycommon", "rcl_interfaces", "rclpy", "ros2cli", "rosgraph_msgs", "rosidl_parser",
    "rosidl_runtime_py", "rpyutils", "setuptools", "std_msgs", "unique_identifier_msgs", "yaml",
)  # fmt: skip


def _taken_names(root: Path | None) -> Mapping[str, str]:
    prefixes = os.environ.get("AMENT_PREFIX_PATH", "").split(os.pathsep)
    environment = [os.path.join(prefix, "share") for prefix in prefixes if prefix]  # noqa: PTH118 - as text
    return ros_packages.taken_names(root, environment, _IMPORTED_BY_RCLPY)


def _next_steps(place: Path, _monitors: Sequence[str]) -> Sequence[str]:
    return [*_build(place), f"ros2 launch {ros_packages.LAUNCHER} eddi.launch.py"]


def _build(place: Path) -> Sequence[str]:
    return [platforms.built_in(place, "colcon build"), "source install/setup.bash"]


def _steps_of_robot(
    at: platforms.MeetingPlace, place: Path, namespace: str, _monitors: Sequence[str]
) -> Sequence[str]:
    robot = f" namespace:={namespace.removeprefix('/')}" if namespace else ""
    return [
        *_build(place),
        f"ROS_DOMAIN_ID={at.name} ros2 launch {ros_packages.LAUNCHER} eddi.launch.py{robot}",
    ]


PLATFORM = platforms.Platform(
    name="ros2",
    templates=(MONITOR, *SUPPORT),
    workspace="colcon workspace",
    root="src/eddi_monitor",
    monitor=monitor_answers,
    support=support_answers,
    taken_names=_taken_names,
    next_steps=_next_steps,
    meeting=platforms.Meeting("domain", "0", _steps_of_robot),
)
