"""ROS 2: ament packages below ``src/eddi_monitor`` of a colcon workspace."""

import os
from collections.abc import Mapping, Sequence
from pathlib import Path

from eddi_scaffold.platforms import Meeting, MeetingPlace, Platform, Templates, Workspace, built_in
from eddi_scaffold.platforms.ros2.package_answers import (
    LAUNCHER_TEMPLATE,
    MESSAGES_TEMPLATE,
    MONITOR_TEMPLATE,
    RUNTIME_TEMPLATE,
    monitor_answers,
    support_answers,
)
from eddi_scaffold.ros import package_names
from eddi_scaffold.ros.package_names import LAUNCHER

_IMPORTED_BY_RCLPY = (
    "ament_index_python", "builtin_interfaces", "diagnostic_msgs", "launch", "launch_ros", "numpy",
    "osrf_pycommon", "rcl_interfaces", "rclpy", "ros2cli", "rosgraph_msgs", "rosidl_parser",
    "rosidl_runtime_py", "rpyutils", "setuptools", "std_msgs", "unique_identifier_msgs", "yaml",
)  # fmt: skip


def _taken_names(root: Path | None) -> Mapping[str, str]:
    prefixes = os.environ.get("AMENT_PREFIX_PATH", "").split(os.pathsep)
    environment = [os.path.join(one, "share") for one in prefixes if one]  # noqa: PTH118 - as text
    return package_names.taken_names(root, environment, "COLCON_IGNORE", _IMPORTED_BY_RCLPY)


def _next_steps(place: Path, _monitors: Sequence[str]) -> Sequence[str]:
    return [*_build(place), f"ros2 launch {LAUNCHER} eddi.launch.py"]


def _build(place: Path) -> Sequence[str]:
    return [built_in(place, "colcon build"), "source install/setup.bash"]


def _steps_of_robot(
    at: MeetingPlace, place: Path, namespace: str, _monitors: Sequence[str]
) -> Sequence[str]:
    robot = f" namespace:={namespace.removeprefix('/')}" if namespace else ""
    return [
        *_build(place),
        f"ROS_DOMAIN_ID={at.name} ros2 launch {LAUNCHER} eddi.launch.py{robot}",
    ]


PLATFORM = Platform(
    name="ros2",
    templates=Templates(MONITOR_TEMPLATE, (MESSAGES_TEMPLATE, LAUNCHER_TEMPLATE, RUNTIME_TEMPLATE)),
    workspace=Workspace("colcon workspace", "src/eddi_monitor"),
    needs_config=True,
    monitor=monitor_answers,
    support=support_answers,
    taken_names=_taken_names,
    next_steps=_next_steps,
    meeting=Meeting("domain", "0", _steps_of_robot),
)
