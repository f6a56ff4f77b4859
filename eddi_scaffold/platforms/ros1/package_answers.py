"""The answers of the packages of a ROS 1 workspace."""

from __future__ import annotations

from collections.abc import Mapping
from functools import partial

from eddi_scaffold import platforms
from eddi_scaffold.compiling.parts import HOST
from eddi_scaffold.config.message_types import known_messages, packages_of
from eddi_scaffold.kinds import JsonValue
from eddi_scaffold.monitors.answers import shared_answers
from eddi_scaffold.monitors.binding import BoundMonitor, bound_to, known_types
from eddi_scaffold.monitors.nodes import node_of
from eddi_scaffold.monitors.publications import MESSAGE_PACKAGE
from eddi_scaffold.platforms import PackageAnswers
from eddi_scaffold.platforms.ros1 import templates
from eddi_scaffold.platforms.ros1.names import METAPACKAGE
from eddi_scaffold.problems import Problem
from eddi_scaffold.ros.message_classes import (
    class_of,
    classes_of,
    imports_of,
    packages_of_classes,
)
from eddi_scaffold.ros.messages import messages_of
from eddi_scaffold.ros.mros_models import interfaces_of, nodes_of, specs_of
from eddi_scaffold.ros.package_names import LAUNCHER, RUNTIME
from eddi_scaffold.ros.shared_packages import package_answers, runtime_parts


def monitor_answers(monitor: BoundMonitor) -> tuple[PackageAnswers, list[Problem]]:
    """Return the answers of one monitor package."""
    monitor, problems = bound_to(monitor, known_types(monitor.config, known_messages()))
    node = node_of(monitor)
    classes = classes_of(node)
    answers = shared_answers(monitor, templates.MONITOR)
    answers |= {platforms.RUNTIME: platforms.VENDORED, platforms.SINGLE_PROCESS: False}
    answers["message_packages"] = [*packages_of_classes(classes)]
    answers["system_packages"] = [f"python3-{name}" for name in monitor.kind.requirements]
    answers["message_imports"] = [*imports_of(classes)]
    answers |= node.answers(partial(class_of, classes=classes))
    answers["interfaces"] = interfaces_of(node.found, node.heard, node.between_robots)
    files = {
        f"src/{monitor.package}/{n}": data
        for n, data in monitor.kind.functions.data_files(monitor.model).items()
    }
    return PackageAnswers(monitor.package, answers, files), [*problems, *node.problems]


def support_answers(monitors: Mapping[str, Mapping[str, JsonValue]]) -> list[PackageAnswers]:
    """Return the answers of messages, launcher, metapackage, and of the runtime if one needs it."""
    texts = messages_of(monitors)
    messages = [{"name": name, "text": texts[name]} for name in sorted(texts)]
    single = all(one.get(platforms.SINGLE_PROCESS) is True for one in monitors.values())
    runtime = platforms.runtime_of(monitors)
    listed = sorted(monitors)

    def package(template: str, name: str, description: str, **more: JsonValue) -> PackageAnswers:
        return PackageAnswers(name, package_answers(template, name, description, monitors, **more))

    packages = [
        package(
            templates.MESSAGES,
            MESSAGE_PACKAGE,
            "Messages of the EDDI runtime monitors",
            messages=messages,
            specs=specs_of(texts),
            message_packages=packages_of(texts.values()),
        ),
        package(
            templates.METAPACKAGE,
            METAPACKAGE,
            "All EDDI runtime monitors of this workspace",
            monitors=listed,
            runtime=runtime,
        ),
        package(
            templates.LAUNCHER,
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
        packages.append(package(templates.RUNTIME, RUNTIME, title, parts=sorted(parts)))
    return packages
