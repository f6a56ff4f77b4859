"""Systems and models as plain JSON: what ``show --json`` prints."""

from __future__ import annotations

from typing import Any

from eddi_scaffold.mros.errors import EMPTY_FILE, FOREIGN_FORMAT, MrosSyntaxError
from eddi_scaffold.mros.model import Artifact, Component, Field, Notice, Package, RosModel, System

Json = Any


def system_json(system: System) -> dict[str, Json]:
    """Return a system as one JSON object."""
    found: dict[str, Json] = {
        "result": "ok",
        "dialect": system.dialect,
        "name": system.name,
        "fromFile": system.from_file,
        "subsystems": [one.name for one in system.subsystems],
        "processes": system.processes,
        "components": [_component(one) for one in system.components],
        "connections": [
            [one.kind, one.name, list(one.sources), list(one.targets)] for one in system.connections
        ],
    }
    return found | _notices(system.notices)


def model_json(model: RosModel) -> dict[str, Json]:
    """Return the packages of a file as one JSON object."""
    found: dict[str, Json] = {
        "result": "ok",
        "dialect": model.dialect,
        "packages": [_package(one) for one in model.packages],
    }
    return found | _notices(model.notices)


def failure_json(failed: MrosSyntaxError) -> dict[str, Json]:
    """Return why a file cannot be read, without the problem itself."""
    dialect = {"dialect": failed.dialect} if failed.dialect else {}
    if failed.code == FOREIGN_FORMAT:
        return {"result": "refuse", **dialect, "why": failed.format}
    if failed.code == EMPTY_FILE:
        return {"result": "refuse", **dialect, "why": "empty"}
    found = {"result": "error", **dialect, "line": failed.line, "col": failed.col}
    return {**found, "msg": failed.message}


def _notices(notices: tuple[Notice, ...]) -> dict[str, Json]:
    rows = [[one.line, one.col, one.code] for one in notices]
    return {"warnings": rows} if rows else {}


def _component(component: Component) -> dict[str, Json]:
    return {
        "name": component.name,
        "namespace": component.namespace,
        "from": component.from_node,
        "parameters": component.parameters,
        "interfaces": [
            [one.kind, one.name, one.ref, one.ns, one.line] for one in component.interfaces
        ],
    }


def _package(package: Package) -> dict[str, Json]:
    return {
        "name": package.name,
        "artifacts": [_artifact(one) for one in package.artifacts],
        "specs": [
            [spec.name, {part: [_field(one) for one in fields] for part, fields in spec.sections}]
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
