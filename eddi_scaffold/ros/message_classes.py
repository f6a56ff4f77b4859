"""Message classes in the module of a node, which rospy and rclpy import by the same names."""

from __future__ import annotations

from collections.abc import Iterable, Mapping

from eddi_scaffold.monitors.nodes import MonitorNode
from eddi_scaffold.monitors.publications import MESSAGE_PACKAGE

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
