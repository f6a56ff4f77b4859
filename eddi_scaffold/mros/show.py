"""Systems and models for ``show``: as plain JSON, and as a tree for people."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from eddi_scaffold.common.problems import Problem, plural
from eddi_scaffold.mros.model import SECTIONS, Field, RosModel, System
from eddi_scaffold.mros.text import MrosSyntaxError

Json = Any


def system_json(system: System) -> dict[str, Json]:
    """Return a system as one JSON object."""
    components = [
        {
            "name": component.name,
            "namespace": component.namespace,
            "from": component.from_node,
            "parameters": component.parameters,
            "interfaces": [
                [interface.kind, interface.name, interface.ref, interface.ns, interface.place.line]
                for interface in component.interfaces
            ],
        }
        for component in system.components
    ]
    return {
        "result": "ok",
        "dialect": system.dialect,
        "name": system.name,
        "fromFile": system.from_file,
        "subsystems": [subsystem.name for subsystem in system.subsystems],
        "processes": system.processes,
        "components": components,
        "connections": [
            [connection.kind, connection.name, list(connection.sources), list(connection.targets)]
            for connection in system.connections
        ],
        **_warnings(system.problems),
    }


def model_json(model: RosModel) -> dict[str, Json]:
    """Return the packages of a file as one JSON object."""
    packages = []
    for package in model.packages:
        artifacts = [
            {
                "name": artifact.name,
                "node": artifact.node,
                "parameters": artifact.parameters,
                "interfaces": [
                    [interface.kind, interface.name, interface.type, interface.place.line]
                    for interface in artifact.interfaces
                ],
            }
            for artifact in package.artifacts
        ]
        specs = [
            [spec.name, {name: [*map(_field, fields)] for name, fields in spec.sections}]
            for spec in package.specs
        ]
        packages.append({"name": package.name, "artifacts": artifacts, "specs": specs})
    return {
        "result": "ok", "dialect": model.dialect, "packages": packages, **_warnings(model.problems)
    }  # fmt: skip


def _field(field: Field) -> list[str]:
    return [field.type, field.name if field.value is None else f"{field.name}={field.value}"]


def failure_json(failed: MrosSyntaxError) -> dict[str, Json]:
    """Return why a file cannot be read, without the problem itself."""
    dialect = {"dialect": failed.dialect} if failed.dialect else {}
    if failed.why:
        return {"result": "refuse", **dialect, "why": failed.why}
    (fault,) = failed.problems
    place = {"line": fault.place.line, "col": fault.place.col}
    return {"result": "error", **dialect, **place, "msg": fault.message}


def _warnings(problems: list[Problem]) -> dict[str, Json]:
    rows = [[reported.place.line, reported.place.col, reported.code] for reported in problems]
    return {"warnings": rows} if rows else {}


def system_tree(system: System) -> Iterator[str]:
    """Return the lines of a system, two blanks per level."""
    yield f"system {system.name or '(without a name)'} ({system.dialect} dialect)"
    if system.from_file:
        yield f"  from {system.from_file}"
    for part in system.subsystems:
        yield f"  part {part.name}"
    for component in system.components:
        space = f" in {component.namespace}" if component.namespace else ""
        node = f" from {component.from_node}" if component.from_node else ""
        yield f"  component {component.name}{space}{node}"
        for interface in component.interfaces:
            yield f"    {SECTIONS[interface.kind].verb:10} {interface.name} = {interface.ref}"
        if component.parameters:
            yield f"    {plural(component.parameters, 'parameter')}"
    for connection in system.connections:
        name = f" {connection.name}" if connection.name else ""
        ends = f"{', '.join(connection.sources)} -> {', '.join(connection.targets)}"
        yield f"  connection{name}: {ends}"


def model_tree(model: RosModel) -> Iterator[str]:
    """Return the lines of the packages of a file."""
    for package in model.packages:
        yield f"package {package.name}"
        for artifact in package.artifacts:
            node = "" if artifact.node is None else f": node {artifact.node}"
            yield f"  artifact {artifact.name}{node}"
            for interface in artifact.interfaces:
                yield f"    {SECTIONS[interface.kind].verb:10} {interface.name}: {interface.type}"
            if artifact.parameters:
                yield f"    {plural(artifact.parameters, 'parameter')}"
        for spec in package.specs:
            yield f"  {spec.kind or 'message'} {spec.name}"
            for section, fields in spec.sections:
                names = ", ".join(" ".join(_field(field)) for field in fields)
                yield f"    {section}: {names or 'nothing'}"
