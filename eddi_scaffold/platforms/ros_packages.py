"""What packages of ROS 1, ROS 2 and DDS have in common: messages, their classes, package names."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from contextlib import suppress
from dataclasses import replace
from pathlib import Path
from typing import Any

import rospkg

from eddi_scaffold import __version__
from eddi_scaffold.common.escaping import toml_text
from eddi_scaffold.common.identifiers import taken_by_python
from eddi_scaffold.common.problems import EddiError, Place, Problem, problem
from eddi_scaffold.config.field_types import (
    MessageFields,
    element,
    fields_of,
    is_primitive,
    packages_of,
)
from eddi_scaffold.config.file import from_data
from eddi_scaffold.kinds import COMMON, WHY, JsonValue, kinds, texts_of_messages
from eddi_scaffold.monitors.answers import files_of, identity_answers, shared_answers
from eddi_scaffold.monitors.binding import BoundMonitor, bound_to, known_types
from eddi_scaffold.monitors.message_types import known_messages, ros2_fields, ros2_messages
from eddi_scaffold.monitors.nodes import MonitorNode, node_of
from eddi_scaffold.monitors.publications import MESSAGE_PACKAGE
from eddi_scaffold.platforms import (
    RUNTIME,
    RUNTIME_PACKAGE,
    VENDORED,
    Choices,
    PackageAnswers,
    runtime_of,
)
from eddi_scaffold.program.runtime_parts import requirements_of

_DIAGNOSTICS = {"/diagnostics": "diagnostic_msgs/DiagnosticArray"}
_SECTIONS = {"pub": "publishers", "sub": "subscribers"}


def interfaces_of(node: MonitorNode) -> list[JsonValue]:
    """Return the topics of a node, each once, sorted: direction, name and type in a row."""
    told, read = (dict.fromkeys(topics, WHY) for topics in node.reasons)
    published = {topic.output.topic: topic.type for topic in node.publications}
    subscribed = {topic.topic: topic.type for topic in node.subscribed}
    topics = {
        "pub": {**told, **published, **_DIAGNOSTICS, **node.between_robots},
        "sub": {**read, **subscribed, **node.between_robots},
    }
    return [
        f"{way} {name} {long_name(of[name])}" for way, of in topics.items() for name in sorted(of)
    ]


def nodes_of(monitors: Mapping[str, Mapping[str, Any]]) -> list[JsonValue]:
    """Return the nodes of a workspace with the sections of their topics that are not empty."""
    nodes: list[JsonValue] = []
    for name, answers in sorted(monitors.items()):
        rows = [row.split(" ") for row in answers.get("interfaces") or ()]
        sections: list[JsonValue] = []
        for direction, section in _SECTIONS.items():
            topics: list[JsonValue] = [
                {"topic": t, "type": of} for d, t, of in rows if d == direction
            ]
            if topics:
                sections.append({"section": section, "direction": direction, "topics": topics})
        nodes += [{"name": name, "interfaces": sections}] if sections else []
    return nodes


def specs_of(messages: Mapping[str, str]) -> Sequence[JsonValue]:
    """Return the fields of messages, without comments and constants."""
    return [
        {
            "name": name,
            "fields": [_field(*field) for field in fields_of(text, MESSAGE_PACKAGE).items()],
        }
        for name, text in sorted(messages.items())
    ]


def _field(name: str, type_: str) -> str:
    item = element(type_) or type_
    if item == "std_msgs/Header":
        written = "Header"  # a word of the language, which needs no model of std_msgs
    else:
        written = item if is_primitive(item) else f"'{long_name(item)}'"
    return f"{written}{type_.removeprefix(item)} {name}"


def long_name(type_: str) -> str:
    """Return a message type as ROS 2 and the models of nodes write it: ``std_msgs/msg/Bool``."""
    return type_.replace("/", "/msg/")


ROSDEP_KEY = "python3-eddi-runtime-pip"  # the runtime library as a distribution that is installed
LAUNCHER = "eddi_monitor_launcher"
GENERATED = "eddi-scaffold generates a package of this name itself"


def taken_names(
    root: Path | None, environment: Sequence[str], imported: Iterable[str], own: Iterable[str] = ()
) -> Mapping[str, str]:
    """Return package names that must not be used, with the reason.

    Packages of the environment count, those below ``root`` do not: they are our own. Without
    ``root`` no package of ours counts: it may be the one that is meant.
    """
    ours = root.resolve() if root is not None else None
    taken: dict[str, str] = {}
    for path in environment:
        folder = rospkg.RosPack([path])
        with suppress(rospkg.InvalidManifest):  # a path with a damaged manifest has no packages
            for name in folder.list():
                place = Path(folder.get_path(name)).resolve()
                if not (place.is_relative_to(ours) if ours is not None else _is_ours(place)):
                    taken.setdefault(name, f"the ROS package {name} is in {place}")
    taken |= taken_by_python()
    taken |= dict.fromkeys(imported, "it would hide a module that every ROS node imports")
    generated = (MESSAGE_PACKAGE, LAUNCHER, RUNTIME_PACKAGE, *own)
    return taken | dict.fromkeys(generated, GENERATED)


def _is_ours(package: Path) -> bool:
    """Return whether a package was generated, also where it is installed."""
    try:
        manifest = (package / "package.xml").read_text("utf-8", "replace")
    except OSError:  # of the time before catkin, which is older than ours
        return False
    return any(
        f"<exec_depend>{dependency}</exec_depend>" in manifest
        for dependency in (RUNTIME_PACKAGE, ROSDEP_KEY)
    )


_RELEASE = ".".join(__version__.split(".")[:3])
"""Version of these packages: they come with the generator."""
_MAINTAINED = ("maintainer_name", "maintainer_email", "license")


def package_answers(
    template: str,
    name: str,
    description: str,
    monitors: Mapping[str, Mapping[str, JsonValue]],
    /,
    **more: JsonValue,
) -> dict[str, JsonValue]:
    """Return the answers of one such package; who maintains a monitor, maintains it too."""
    answers = {"template": template, **identity_answers(name, description, None), **more}
    answers["package_version"], nobody = _RELEASE, answers["maintainer_email"]
    for package in sorted(monitors, reverse=True):
        maintainer = {
            key: monitors[package][key] for key in _MAINTAINED if key in monitors[package]
        }
        answers |= maintainer if maintainer.get("maintainer_email") != nobody else {}
    if {"messages", "parts"} & more.keys():  # files of eddi-scaffold, not a person's
        answers["license"] = "Apache-2.0"
    return answers


_OURS = frozenset({"Input", "Output", "RosNode", "EDDIInput", "EDDIMonitor", "MonitorNode"})


def classes_of(node: MonitorNode) -> dict[str, str]:
    """Return message type -> Python name of its class; whole messages of ours keep their module.

    Equal names of two packages get the package before.
    """
    values = (topic.type for topic in node.published if topic.path)
    types = sorted({*(source.type for source in node.subscribed), *values})
    names = [name.partition("/")[2] for name in types]
    classes = {
        full: name if names.count(name) == 1 and name not in _OURS else full.replace("/", "_")
        for full, name in zip(types, names, strict=True)
    }
    return classes | {p.type: _in_module(p.type) for p in node.published if not p.path}


def _in_module(type_: str) -> str:
    return type_.replace("/", ".msg.")


def imports_of(classes: Mapping[str, str]) -> list[str]:
    """Return the lines that import these classes."""
    lines = []
    for full, name in sorted(classes.items()):
        package, _, message = full.partition("/")
        if name.startswith("eddi_messages.msg."):
            continue
        alias = "" if name == message else f" as {name}"
        lines.append(f"from {package}.msg import {message}{alias}")
    return lines


def messages_of(monitors: Mapping[str, Mapping[str, JsonValue]]) -> dict[str, str]:
    """Return message name -> text (EddiError G026: monitors want one spelt in two ways)."""
    texts = {**texts_of_messages()}
    waiting = [*COMMON]
    read_by: dict[str, str] = {}
    respelt: dict[str, str] = {}
    for package, answers in monitors.items():
        kind = kinds()[str(answers["kind"])]
        waiting += kind.messages
        if answers.get("config"):
            config = from_data(answers["config"], "the configuration of a package").config
            waiting += kind.between_robots if config.Fleet is not None else ()
            respelt |= kind.respelt(config.Model.model_extra or {})
            types = (entry.type.partition("/") for entry in config.SimulatorOutputs)
            read_by |= {name: package for of, _, name in types if of == MESSAGE_PACKAGE}
    for name in read_by.keys() & respelt.keys():
        raise EddiError(problem("G026", Place(read_by[name]), message=name))
    texts |= respelt
    waiting += read_by
    needed: dict[str, str] = {}
    while waiting:
        name = waiting.pop()
        if name in texts and name not in needed:
            needed[name] = texts[name]
            waiting += [
                line.partition(" ")[0].partition("[")[0] for line in texts[name].split("\n")
            ]
    return needed


def types_of(monitor: BoundMonitor) -> MessageFields:
    """Return the message types of ROS 2 that a configuration may name, as the monitor has them."""
    assert monitor.config is not None, "a node needs a configuration"
    options = monitor.config.config.Model.model_extra or {}
    respelt = {
        f"{MESSAGE_PACKAGE}/{name}": fields_of(text, MESSAGE_PACKAGE)
        for name, text in monitor.kind.respelt(options).items()
    }
    known = known_types(monitor.config, ros2_messages({**known_messages(), **respelt}))
    return {name: ros2_fields(fields) for name, fields in known.items()}


def monitor_package(
    monitor: BoundMonitor,
    known: MessageFields,
    template: str,
    inside: str,
    choices: Choices,
    *,
    is_ros2: bool = False,
) -> tuple[PackageAnswers, MonitorNode, list[Problem]]:
    """Return the package of one monitor, its node, and all that is wrong with what it reads.

    ``inside`` is the folder in it that holds that of the modules, with a slash; empty for none.
    ROS 2 has a quality of service of topics, and nodes with a life cycle.
    """
    monitor, problems = bound_to(monitor, known)
    node, problems_of_node = node_of(monitor)
    classes = classes_of(node)
    files = files_of(monitor, f"{inside}{monitor.package}/", "config/")
    answers = {**shared_answers(monitor, template, files), **choices}
    packages = {name.partition("/")[0] for name in classes} - {MESSAGE_PACKAGE}
    answers["message_packages"] = sorted(packages)
    answers["system_packages"] = _system_packages(answers["parts"])
    answers["message_imports"] = [*imports_of(classes)]
    answers |= node.answers(lambda of: classes.get(of, _in_module(of)), has_qos=is_ros2)
    if is_ros2:
        answers["lifecycle"] = node.config.config.Model.lifecycle
    answers["interfaces"] = interfaces_of(node)
    package = PackageAnswers(monitor.package, answers, files)
    return package, node, [*problems, *problems_of_node]


def support_packages(
    monitors: Mapping[str, Mapping[str, JsonValue]],
    templates: Sequence[str],
    launcher: Mapping[str, JsonValue] | None = None,
    parts: Iterable[str] = (),
) -> list[PackageAnswers]:
    """Return messages, launcher, and the runtime library where a monitor needs it in the workspace.

    ``monitors``: package -> its answers; the templates are in this order.
    """

    def package(place: int, name: str, description: str, **more: JsonValue) -> PackageAnswers:
        template = templates[place]
        return PackageAnswers(name, package_answers(template, name, description, monitors, **more))

    texts = messages_of(monitors)
    title = "Messages of the EDDI runtime monitors"
    start = "Launch file that starts every EDDI runtime monitor of this workspace"
    messages = {
        "messages": [{"name": name, "text": texts[name]} for name in sorted(texts)],
        "specs": specs_of(texts),
        "message_packages": packages_of(texts.values()),
    }
    nodes = {"monitors": sorted(monitors), **(launcher or {}), "nodes": nodes_of(monitors)}
    packages = [
        package(0, MESSAGE_PACKAGE, title, **messages),
        package(1, LAUNCHER, start, **nodes),
    ]
    for runtime in runtime_packages(templates[2], monitors, parts):
        system = _system_packages(runtime.answers["parts"])
        packages.append(replace(runtime, answers={**runtime.answers, "system_packages": system}))
    return packages


def runtime_packages(
    template: str, monitors: Mapping[str, Mapping[str, Any]], parts: Iterable[str] = ()
) -> list[PackageAnswers]:
    """Return the package of the runtime library, where a monitor needs one beside it."""
    if runtime_of(monitors) != VENDORED:
        return []
    needed = {*parts}.union(*(answers["parts"] for answers in monitors.values()))
    title = "Runtime library of the EDDI monitors"
    answers = package_answers(template, RUNTIME_PACKAGE, title, monitors, parts=sorted(needed))
    return [PackageAnswers(RUNTIME_PACKAGE, answers)]


def _system_packages(parts: Any) -> list[JsonValue]:
    return [f"python3-{name}" for name in requirements_of(parts)]


def distribution(
    monitor: BoundMonitor, template: str, *required: str
) -> tuple[dict[str, Any], dict[str, bytes]]:
    """Return answers and files of a package that pip installs, which requires others."""
    files = files_of(monitor)
    answers: dict[str, Any] = shared_answers(monitor, template, files)
    requirements = requirements_of(answers["parts"])
    more = {
        "description_literal": toml_text(answers["description"]),
        "requirements": requirements,
        "requirements_text": ", ".join([*required, *requirements]) or "no other packages",
        "package_data": sorted(monitor.compiled.tables),
        RUNTIME: VENDORED,
    }
    return {**answers, **more}, files
