"""ROS 2: ament packages below ``src/eddi_monitor`` of a colcon workspace."""

from __future__ import annotations

import os
from collections.abc import Iterator, Mapping, Sequence
from functools import partial
from pathlib import Path

from eddi_scaffold import platforms
from eddi_scaffold.common.problems import Problem, problem
from eddi_scaffold.config.field_types import packages_of
from eddi_scaffold.kinds import JsonValue
from eddi_scaffold.monitors.answers import shared_answers
from eddi_scaffold.monitors.binding import BoundMonitor, bound_to
from eddi_scaffold.monitors.nodes import MonitorNode, node_of
from eddi_scaffold.monitors.publications import MESSAGE_PACKAGE
from eddi_scaffold.platforms import (
    Meeting,
    MeetingPlace,
    PackageAnswers,
    Platform,
    Templates,
    Workspace,
    built_in,
)
from eddi_scaffold.platforms.ros_packages import packages
from eddi_scaffold.platforms.ros_packages.messages import (
    class_of,
    classes_of,
    imports_of,
    messages_of,
    packages_of_classes,
    types_of,
)
from eddi_scaffold.platforms.ros_packages.packages import (
    LAUNCHER,
    RUNTIME,
    interfaces_of,
    nodes_of,
    package_answers,
    runtime_parts,
    specs_of,
)

MONITOR_TEMPLATE = "ros2_monitor"
MESSAGES_TEMPLATE = "ros2_messages"
LAUNCHER_TEMPLATE = "ros2_launcher"
RUNTIME_TEMPLATE = "ros2_runtime"


def monitor_answers(monitor: BoundMonitor) -> tuple[PackageAnswers, list[Problem]]:
    """Return the answers of one monitor package."""
    monitor, problems = bound_to(monitor, types_of(monitor))
    node = node_of(monitor)
    classes = classes_of(node)
    answers = shared_answers(monitor, MONITOR_TEMPLATE, f"{monitor.package}/")
    answers[platforms.RUNTIME] = platforms.VENDORED
    answers["message_packages"] = [*packages_of_classes(classes)]
    answers["system_packages"] = [f"python3-{name}" for name in monitor.kind.requirements]
    answers["message_imports"] = [*imports_of(classes)]
    answers |= node.answers(partial(class_of, classes=classes), has_qos=True)
    answers["lifecycle"] = node.config.config.Model.lifecycle
    answers["interfaces"] = interfaces_of(node.publications, node.heard, node.between_robots)
    files = {f"{monitor.package}/{name}": of for name, of in monitor.compiled.tables.items()}
    problems += [*node.problems, *_check_topics(node)]
    return PackageAnswers(monitor.package, answers, files), problems


def _check_topics(node: MonitorNode) -> Iterator[Problem]:
    """Refuse names that ROS 1 takes and ROS 2 does not."""
    config = node.config.config
    sections = {
        "EDDIOutputs": [entry.topic for entry in config.EDDIOutputs],
        "SimulatorOutputs": [entry.topic for entry in config.SimulatorOutputs],
    }
    places = {
        topic: node.config.place(section, index, "topic")
        for section, topics in sections.items()
        for index, topic in enumerate(topics)
    }
    used = [*(one.output.topic for one in node.publications), *(one.topic for one in node.heard)]
    for topic in dict.fromkeys([*used, *node.between_robots]):
        if any(part[:1].isdigit() for part in topic.lstrip("~").split("/")):
            yield problem(
                "K003.ros2_name", places.get(topic, node.config.place("Model")), key=topic
            )


def support_answers(monitors: Mapping[str, Mapping[str, JsonValue]]) -> list[PackageAnswers]:
    """Return the answers of messages, launcher, and of the runtime library if one needs it."""
    texts = messages_of(monitors)
    messages = [{"name": name, "text": texts[name]} for name in sorted(texts)]
    needed = packages_of(texts.values())
    listed = sorted(monitors)

    def package(template: str, name: str, description: str, **more: JsonValue) -> PackageAnswers:
        return PackageAnswers(name, package_answers(template, name, description, monitors, **more))

    title = "Messages of the EDDI runtime monitors"
    start = "Launch file that starts every EDDI runtime monitor of this workspace"
    packages = [
        package(
            MESSAGES_TEMPLATE,
            MESSAGE_PACKAGE,
            title,
            messages=messages,
            specs=specs_of(texts),
            message_packages=needed,
        ),
        package(LAUNCHER_TEMPLATE, LAUNCHER, start, monitors=listed, nodes=nodes_of(monitors)),
    ]
    if platforms.runtime_of(monitors) == platforms.VENDORED:
        parts = sorted(runtime_parts(monitors))
        title = "Runtime library of the EDDI monitors"
        packages.append(package(RUNTIME_TEMPLATE, RUNTIME, title, parts=[*parts]))
    return packages


_IMPORTED_BY_RCLPY = (
    "ament_index_python", "builtin_interfaces", "diagnostic_msgs", "launch", "launch_ros", "numpy",
    "osrf_pycommon", "rcl_interfaces", "rclpy", "ros2cli", "rosgraph_msgs", "rosidl_parser",
    "rosidl_runtime_py", "rpyutils", "setuptools", "std_msgs", "unique_identifier_msgs", "yaml",
)  # fmt: skip


def _taken_names(root: Path | None) -> Mapping[str, str]:
    prefixes = os.environ.get("AMENT_PREFIX_PATH", "").split(os.pathsep)
    environment = [os.path.join(prefix, "share") for prefix in prefixes if prefix]  # noqa: PTH118 - as text
    return packages.taken_names(root, environment, "COLCON_IGNORE", _IMPORTED_BY_RCLPY)


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
