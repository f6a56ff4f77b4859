"""Our messages in a workspace: which it needs, and their classes in a node's module."""

from __future__ import annotations

from collections.abc import Iterable, Mapping

from eddi_scaffold.common.problems import EddiError, Place
from eddi_scaffold.config.field_types import MessageFields, fields_of
from eddi_scaffold.config.file import from_json
from eddi_scaffold.kinds import JsonValue, kinds
from eddi_scaffold.monitors.binding import BoundMonitor, known_types
from eddi_scaffold.monitors.message_types import known_messages, ros2_fields, ros2_messages
from eddi_scaffold.monitors.nodes import MonitorNode
from eddi_scaffold.monitors.publications import MESSAGE_PACKAGE, read_respelt

_OURS = frozenset({"Input", "Output", "RosNode", "EDDIInput", "EDDIMonitor", "MonitorNode"})


def classes_of(node: MonitorNode) -> dict[str, str]:
    """Return message type -> Python name of its class; whole messages of ours keep their module."""
    values = [one.type for one in node.published if one.path]
    classes = _class_names([*(source.type for source in node.heard), *values])
    return classes | {p.type: _in_module(p.type) for p in node.published if not p.path}


def class_of(type_: str, classes: Mapping[str, str]) -> str:
    """Return the Python name of a message class."""
    return classes.get(type_, _in_module(type_))


def packages_of_classes(classes: Mapping[str, str]) -> list[str]:
    """Return the packages of message types, sorted, without our own."""
    return sorted({name.partition("/")[0] for name in classes} - {MESSAGE_PACKAGE})


def _in_module(type_: str) -> str:
    return type_.replace("/", ".msg.")


def _class_names(types: Iterable[str]) -> dict[str, str]:
    """Return message type -> Python name; equal names of two packages get the package before."""
    unique = sorted(set(types))
    names = [name.partition("/")[2] for name in unique]
    return {
        full: name if names.count(name) == 1 and name not in _OURS else full.replace("/", "_")
        for full, name in zip(unique, names, strict=True)
    }


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
    """Return message name -> text.

    Raises:
        EddiError: a monitor listens to a message that another one wants spelt otherwise (G026).
    """
    texts = {name: text for kind in kinds().values() for name, text in kind.all_messages.items()}
    wanted: list[str] = []
    heard: dict[str, str] = {}
    respelt: dict[str, str] = {}
    for package, answers in monitors.items():
        kind = kinds()[str(answers["kind"])]
        wanted += kind.messages
        if answers["config_json"]:
            config = from_json(str(answers["config_json"]), "the configuration of a package").config
            wanted += kind.between_robots if config.Fleet is not None else ()
            respelt |= kind.respelt(config.Model.model_extra or {})
            types = (entry.type.partition("/") for entry in config.SimulatorOutputs)
            heard |= {name: package for of, _, name in types if of == MESSAGE_PACKAGE}
    for name in heard.keys() & respelt.keys():
        raise EddiError(read_respelt(name, Place(heard[name])))
    texts |= respelt
    wanted += heard
    found: dict[str, str] = {}
    while wanted:
        name = wanted.pop()
        if name in texts and name not in found:
            found[name] = texts[name]
            wanted += [line.partition(" ")[0].partition("[")[0] for line in texts[name].split("\n")]
    return found


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
