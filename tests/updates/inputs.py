"""ConSerts and configurations: a list of inputs that changes in the ways of real models."""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path
from typing import Literal

Type = Literal["bool", "float", "text", "pair"]
TYPES: tuple[Type, ...] = ("bool", "float", "text", "pair")

_DIMENSIONS = {
    "bool": "Binary:\n          type: Healthy\n",
    "pair": "Binary:\n          type: Healthy\n",
    "float": (
        "Numeric:\n          type: Clearance\n          covered:\n            - Inclusive:\n"
        "                start: 1\n                end: 2\n"
        "          subset: Guarantee\n          uom: m\n"
    ),
    "text": (
        "Categorical:\n          type: Mode\n          covered:\n            - manual\n"
        "          subset: Guarantee\n"
    ),
}
_VALUE_TYPES = {"bool": "bool", "pair": "bool", "float": "float", "text": "str"}
_MESSAGES = {
    "bool": "std_msgs.Bool",
    "float": "std_msgs.Float64",
    "text": "std_msgs.String",
    "pair": "geometry_msgs.Twist",
}


@dataclass(frozen=True)
class Element:
    """One input: its name and type, and the name that the configuration says it had."""

    name: str
    type: Type = "bool"
    was: str | None = None

    def renamed(self, name: str, *, declared: bool = True) -> Element:
        return replace(self, name=name, was=self.name if declared else None)


def elements(*names: str) -> tuple[Element, ...]:
    return tuple(Element(name) for name in names)


def model_text(inputs: tuple[Element, ...]) -> str:
    """Return a ConSert whose one guarantee needs every input."""
    lines = [
        "---",
        "guarantees:",
        "  - id: Drive",
        "    dimensions:",
        "      - Binary:",
        "          type: Driving",
    ]
    lines += [
        "demands: []",
        "gates: []",
        "required_services: []",
        "provided_services: []",
        "evidence:",
    ]
    for item in inputs:
        lines += [
            f"  - id: {item.name}",
            "    dimension:",
            f"      {_DIMENSIONS[item.type].rstrip()}",
        ]
    lines.append("tree_propagations:")
    for item in inputs:
        lines += [f"  - from: {item.name}", "    to: Drive"]
    return "\n".join(lines) + "\n"


def config_text(inputs: tuple[Element, ...], name: str = "Rover") -> str:
    """Return the configuration: one topic for each input, a second one for a pair."""
    lines = ["Model:", f"  id: {name}", "  type: ConSert", "SimulatorOutputs:"]
    for item in inputs:
        for source in _sources(item):
            message, topic = _MESSAGES[item.type], f"/{name}/{source}".lower().replace("-", "_")
            lines.append(f"  - {{id: {source}, type: {message}, topic: {topic}, max_age: none}}")
    lines.append("EDDIInputs:")
    for item in inputs:
        requires = ", ".join(_sources(item))
        lines += [
            f"  - id: {item.name}",
            f"    type: {_VALUE_TYPES[item.type]}",
            f"    requires: [{requires}]",
        ]
        if item.was:
            lines.append(f"    renamed_from: {item.was}")
    lines += ["EDDIOutputs:", f"  - {{id: {name.lower()}, topic: /{name.lower()}/guarantees}}"]
    return "\n".join(lines) + "\n"


def write_inputs(
    folder: Path, inputs: tuple[Element, ...], name: str = "Rover"
) -> tuple[Path, Path]:
    """Write model and configuration; returns their paths."""
    folder.mkdir(parents=True, exist_ok=True)
    model, config = folder / f"{name}.yml", folder / "eddi_config.yml"
    model.write_text(model_text(inputs))
    config.write_text(config_text(inputs, name))
    return model, config


def _sources(item: Element) -> list[str]:
    names = [f"{item.name}_topic"]
    return [*names, f"{item.name}_second"] if item.type == "pair" else names
