"""Systems and models for ``show``: as plain JSON, and as a tree for people."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from eddi_scaffold.common.problems import plural
from eddi_scaffold.mros.model import (
    Artifact,
    Component,
    Connection,
    Field,
    InterfaceKind,
    Notice,
    Package,
    RosModel,
    RosNode,
    System,
)
from eddi_scaffold.mros.text import EMPTY_FILE, FOREIGN_FORMAT, MrosSyntaxError

Json = Any


def system_json(system: System) -> dict[str, Json]:
    """Return a system as one JSON object."""
    found: dict[str, Json] = {
        "result": "ok",
        "dialect": system.dialect,
        "name": system.name,
        "fromFile": system.from_file,
        "subsystems": [subsystem.name for subsystem in system.subsystems],
        "processes": system.processes,
        "components": [_component(component) for component in system.components],
        "connections": [
            [connection.kind, connection.name, list(connection.sources), list(connection.targets)]
            for connection in system.connections
        ],
    }
    return found | _notices(system.notices)


def model_json(model: RosModel) -> dict[str, Json]:
    """Return the packages of a file as one JSON object."""
    found: dict[str, Json] = {
        "result": "ok",
        "dialect": model.dialect,
        "packages": [_package(package) for package in model.packages],
    }
    return found | _notices(model.notices)


def failure_json(failed: MrosSyntaxError) -> dict[str, Json]:
    """Return why a file cannot be read, without the problem itself."""
    dialect = {"dialect": failed.dialect} if failed.dialect else {}
    if failed.case == FOREIGN_FORMAT:
        return {"result": "refuse", **dialect, "why": failed.format}
    if failed.case == EMPTY_FILE:
        return {"result": "refuse", **dialect, "why": "empty"}
    found = {"result": "error", **dialect, "line": failed.line, "col": failed.col}
    return {**found, "msg": failed.message}


def _notices(notices: tuple[Notice, ...]) -> dict[str, Json]:
    rows = [[notice.line, notice.col, notice.case.partition(".")[0]] for notice in notices]
    return {"warnings": rows} if rows else {}


def _component(component: Component) -> dict[str, Json]:
    return {
        "name": component.name,
        "namespace": component.namespace,
        "from": component.from_node,
        "parameters": component.parameters,
        "interfaces": [
            [interface.kind, interface.name, interface.ref, interface.ns, interface.line]
            for interface in component.interfaces
        ],
    }


def _package(package: Package) -> dict[str, Json]:
    return {
        "name": package.name,
        "artifacts": [_artifact(artifact) for artifact in package.artifacts],
        "specs": [
            [
                spec.name,
                {part: [_field(field) for field in fields] for part, fields in spec.sections},
            ]
            for spec in package.specs
        ],
    }


def _artifact(artifact: Artifact) -> dict[str, Json]:
    node = artifact.node
    return {
        "name": artifact.name,
        "node": node.name if node else None,
        "parameters": node.parameters if node else 0,
        "interfaces": [
            [one.kind, one.name, one.type, one.line] for one in (node.interfaces if node else ())
        ],
    }


def _field(field: Field) -> list[str]:
    return [field.type, field.name if field.value is None else f"{field.name}={field.value}"]


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
        yield from (f"  {line}" for line in _component_tree(component))
    for connection in system.connections:
        yield f"  {_connection(connection)}"


def model_tree(model: RosModel) -> Iterator[str]:
    """Return the lines of the packages of a file."""
    for package in model.packages:
        yield from _package_tree(package)


def _component_tree(component: Component) -> Iterator[str]:
    space = f" in {component.namespace}" if component.namespace else ""
    of = f" from {component.from_node}" if component.from_node else ""
    yield f"component {component.name}{space}{of}"
    for interface in component.interfaces:
        yield f"  {_VERBS[interface.kind]:{_WIDTH}} {interface.name} = {interface.ref}"
    if component.parameters:
        yield f"  {plural(component.parameters, 'parameter')}"


def _connection(connection: Connection) -> str:
    name = f" {connection.name}" if connection.name else ""
    ends = f"{', '.join(connection.sources)} -> {', '.join(connection.targets)}"
    return f"connection{name}: {ends}"


def _package_tree(package: Package) -> Iterator[str]:
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
    for interface in node.interfaces:
        yield f"{_VERBS[interface.kind]:{_WIDTH}} {interface.name}: {interface.type}"
    if node.parameters:
        yield plural(node.parameters, "parameter")
