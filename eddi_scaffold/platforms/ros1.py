"""ROS 1: catkin packages below ``src/eddi_monitor`` of a workspace."""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from functools import partial
from pathlib import Path
from shlex import quote

import rospkg

from eddi_scaffold import platforms
from eddi_scaffold.common.problems import Problem
from eddi_scaffold.config.field_types import packages_of
from eddi_scaffold.kinds import JsonValue
from eddi_scaffold.monitors.answers import shared_answers
from eddi_scaffold.monitors.binding import BoundMonitor, bound_to, known_types
from eddi_scaffold.monitors.message_types import known_messages
from eddi_scaffold.monitors.nodes import node_of
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
from eddi_scaffold.program.runtime_parts import HOST

METAPACKAGE = "eddi_monitor"
_IMPORTED_BY_ROSPY = (
    "catkin", "catkin_pkg", "defusedxml", "diagnostic_msgs", "genmsg", "genpy", "numpy", "rosclean",
    "rosgraph", "rosgraph_msgs", "roscpp", "roslaunch", "roslib", "roslz4", "rosmaster", "rosnode",
    "rospkg", "rospy", "rosservice", "rostopic", "setuptools", "std_msgs", "std_srvs", "yaml",
)  # fmt: skip


def taken_names(root: Path | None) -> Mapping[str, str]:
    """Return package names that must not be used, with the reason."""
    return packages.taken_names(
        root, rospkg.get_ros_paths(), "CATKIN_IGNORE", _IMPORTED_BY_ROSPY, [METAPACKAGE]
    )


MONITOR_TEMPLATE = "ros1_monitor"
MESSAGES_TEMPLATE = "ros1_messages"
METAPACKAGE_TEMPLATE = "ros1_metapackage"
LAUNCHER_TEMPLATE = "ros1_launcher"
RUNTIME_TEMPLATE = "ros1_runtime"

ALL = Templates(
    MONITOR_TEMPLATE, (MESSAGES_TEMPLATE, METAPACKAGE_TEMPLATE, LAUNCHER_TEMPLATE, RUNTIME_TEMPLATE)
)


def monitor_answers(monitor: BoundMonitor) -> tuple[PackageAnswers, list[Problem]]:
    """Return the answers of one monitor package."""
    monitor, problems = bound_to(monitor, known_types(monitor.config, known_messages()))
    node = node_of(monitor)
    classes = classes_of(node)
    answers = shared_answers(monitor, MONITOR_TEMPLATE, f"src/{monitor.package}/")
    answers |= {platforms.RUNTIME: platforms.VENDORED, platforms.SINGLE_PROCESS: False}
    answers["message_packages"] = [*packages_of_classes(classes)]
    answers["system_packages"] = [f"python3-{name}" for name in monitor.kind.requirements]
    answers["message_imports"] = [*imports_of(classes)]
    answers |= node.answers(partial(class_of, classes=classes))
    answers["interfaces"] = interfaces_of(node.publications, node.heard, node.between_robots)
    files = {f"src/{monitor.package}/{name}": of for name, of in monitor.compiled.tables.items()}
    return PackageAnswers(monitor.package, answers, files), [*problems, *node.problems]


def support_answers(monitors: Mapping[str, Mapping[str, JsonValue]]) -> list[PackageAnswers]:
    """Return the answers of messages, launcher, metapackage, and of the runtime if one needs it."""
    texts = messages_of(monitors)
    messages = [{"name": name, "text": texts[name]} for name in sorted(texts)]
    single = all(monitor.get(platforms.SINGLE_PROCESS) is True for monitor in monitors.values())
    runtime = platforms.runtime_of(monitors)
    listed = sorted(monitors)

    def package(template: str, name: str, description: str, **more: JsonValue) -> PackageAnswers:
        return PackageAnswers(name, package_answers(template, name, description, monitors, **more))

    packages = [
        package(
            MESSAGES_TEMPLATE,
            MESSAGE_PACKAGE,
            "Messages of the EDDI runtime monitors",
            messages=messages,
            specs=specs_of(texts),
            message_packages=packages_of(texts.values()),
        ),
        package(
            METAPACKAGE_TEMPLATE,
            METAPACKAGE,
            "All EDDI runtime monitors of this workspace",
            monitors=listed,
            runtime=runtime,
        ),
        package(
            LAUNCHER_TEMPLATE,
            LAUNCHER,
            "Launch file that starts every EDDI runtime monitor of this workspace",
            monitors=listed,
            single_process=single,
            nodes=nodes_of(monitors),
        ),
    ]
    if runtime == platforms.VENDORED:
        parts = runtime_parts(monitors) | ({HOST} if single else set())
        title = "Runtime library of the EDDI monitors"
        packages.append(package(RUNTIME_TEMPLATE, RUNTIME, title, parts=sorted(parts)))
    return packages


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
    templates=ALL,
    workspace=Workspace("catkin workspace", "src/eddi_monitor"),
    needs_config=True,
    monitor=monitor_answers,
    support=support_answers,
    taken_names=taken_names,
    next_steps=_next_steps,
    meeting=Meeting("master", "", _steps_of_robot),
)
