"""Systems and models as a tree for people: what ``show`` prints."""

from __future__ import annotations

from collections.abc import Iterator

from eddi_scaffold.mros.model import (
    Component,
    Connection,
    InterfaceKind,
    Package,
    RosModel,
    RosNode,
    System,
)
from eddi_scaffold.problems import counted

_VERBS: dict[InterfaceKind, str] = {
    "publisher": "publishes",
    "subscriber": "subscribes",
    "serviceserver": "serves",
    "serviceclient": "calls",
    "actionserver": "acts",
    "actionclient": "commands",
}
_WIDTH = max(len(verb) for verb in _VERBS.values())


def system_tree(system: System) -> Iterator[str]:
    """Return the lines of a system, two blanks per level."""
    yield f"system {system.name or '(without a name)'} ({system.dialect} dialect)"
    if system.from_file:
        yield f"  from {system.from_file}"
    for part in system.subsystems:
        yield f"  part {part.name}"
    for component in system.components:
        yield from (f"  {line}" for line in _component(component))
    for connection in system.connections:
        yield f"  {_connection(connection)}"


def model_tree(model: RosModel) -> Iterator[str]:
    """Return the lines of the packages of a file."""
    for package in model.packages:
        yield from _package(package)


def _component(component: Component) -> Iterator[str]:
    space = f" in {component.namespace}" if component.namespace else ""
    of = f" from {component.from_node}" if component.from_node else ""
    yield f"component {component.name}{space}{of}"
    for one in component.interfaces:
        yield f"  {_VERBS[one.kind]:{_WIDTH}} {one.name} = {one.ref}"
    if component.parameters:
        yield f"  {counted(component.parameters, 'parameter')}"


def _connection(connection: Connection) -> str:
    name = f" {connection.name}" if connection.name else ""
    ends = f"{', '.join(connection.sources)} -> {', '.join(connection.targets)}"
    return f"connection{name}: {ends}"


def _package(package: Package) -> Iterator[str]:
    yield f"package {package.name}"
    for artifact in package.artifacts:
        node = f": node {artifact.node.name}" if artifact.node else ""
        yield f"  artifact {artifact.name}{node}"
        if artifact.node:
            yield from (f"    {line}" for line in _node(artifact.node))
    for spec in package.specs:
        yield f"  {spec.kind or 'message'} {spec.name}"
        for section, fields in spec.sections:
            names = ", ".join(
                f"{field.type} {field.name}" + (f"={field.value}" if field.value else "")
                for field in fields
            )
            yield f"    {section}: {names or 'nothing'}"


def _node(node: RosNode) -> Iterator[str]:
    for one in node.interfaces:
        yield f"{_VERBS[one.kind]:{_WIDTH}} {one.name}: {one.type}"
    if node.parameters:
        yield counted(node.parameters, "parameter")
