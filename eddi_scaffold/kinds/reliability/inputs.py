"""Inputs of a monitor: one per motor, level, temperature, event."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import replace

from eddi_scaffold.common.claims import Use
from eddi_scaffold.common.units import accepted
from eddi_scaffold.kinds import ModelInput
from eddi_scaffold.kinds.reliability.system import (
    Chain,
    ComponentModel,
    FaultTree,
    ReliabilitySystem,
)

MISSION_END = "mission_end"
_COHERENT = ("AND", "OR", "VOTE")


def inputs_of(system: ReliabilitySystem) -> list[ModelInput]:
    """Return the inputs in the order of the models; one that serves two of them once."""
    found: dict[str, ModelInput] = {}
    for component in system.components.values():
        for input_ in _inputs(component):
            found.setdefault(input_.id, input_)
    if system.mission_end:
        text = "Seconds from now to the end of the mission"
        left = system.horizon * 3600.0
        found[MISSION_END] = ModelInput(
            MISSION_END, "float", unit="s", description=text, sample=left
        )
    inputs = list(found.values())
    return [_with_uses(input_) for input_ in inputs] if _is_coherent(system) else inputs


def _is_coherent(system: ReliabilitySystem) -> bool:
    """Return whether a failure of a part never makes the system better: AND, OR and VOTE only."""
    trees = [c.content for c in system.components.values() if isinstance(c.content, FaultTree)]
    return all(gate.type in _COHERENT for tree in trees for gate in tree.gates.values())


def _with_uses(one: ModelInput) -> ModelInput:
    """Declare that a threshold gains only from parts that work, where that is one of two values."""
    if one.type != "bool" or one.is_good is None:
        return one
    return replace(one, uses=(Use(one.is_good),))


def input_id(model: str, rest: str) -> str:
    """Return the id of an input: names joined, all else than letters and digits as ``_``."""
    return re.sub(r"[^A-Za-z0-9_]", "_", f"{model}_{rest}")


def _inputs(component: ComponentModel) -> Iterator[ModelInput]:
    name, content, values = component.name, component.content, component.values
    if isinstance(content, Chain):
        for one in content.observe:
            text = f"{'False' if not one.negated else 'True'}: {name} is not in state {one.state}"
            start = (one.state in content.initial) is not one.negated
            yield _truth(one.input, text, start)
    elif isinstance(content, FaultTree):
        for key, event in content.events.items():
            if event.observed:
                found = _truth(input_id(name, key), f"Has the event {event.name} happened?", False)
                yield replace(found, is_good=lambda v: v is False)
    elif component.type == "propulsion":
        yield from _motors(component)
    elif component.type == "battery":
        text = "State of charge in percent"
        yield _number(name, "level", text, 100.0, "above 25", unit="percent")
        if "t_ref" in values:
            yield _temperature(component, "Temperature of the battery")
    elif component.type == "processor":
        yield _temperature(component, "Temperature of the processor")
        text, most = "Load of the processor, 1 for full", values["u_max"]
        yield _number(name, "utilisation", text, min(1.0, most), f"0 to {most:g}")
    elif component.type == "k_out_of_n":
        text = f"How many units are available, {values['k']} are needed"
        units, good = values["max"] or values["k"], f"at least {values['k']}"
        yield replace(_number(name, "available", text, units, good), type="int")


def _motors(component: ComponentModel) -> Iterator[ModelInput]:
    count = len(component.values["rates"])
    if component.values["status"] == "list":
        yield ModelInput(
            input_id(component.name, "status"),
            "bool[]",
            description=f"Does each of the {count} motors work?",
            covered="each true",
            sample=[True] * count,
        )
        return
    for i in range(count):
        found = _truth(input_id(component.name, f"motor_{i}"), f"Does motor {i} work?", True)
        yield replace(found, is_good=lambda v: v is True)


def _truth(name: str, text: str, start: bool) -> ModelInput:
    return ModelInput(
        name, "bool", description=_line(text), covered="true" if start else "false", sample=start
    )


def _temperature(component: ComponentModel, text: str) -> ModelInput:
    usual, most = component.values["t_ref"], component.values["t_max"]
    return _number(
        component.name, "temperature", text, min(usual, most), f"at most {most:g}", unit="degC"
    )


def _number(
    model: str, rest: str, text: str, sample: float, covered: str, unit: str | None = None
) -> ModelInput:
    return ModelInput(
        input_id(model, rest),
        "float",
        unit=unit,
        units=accepted(unit),
        description=text,
        covered=covered,
        sample=sample,
    )


def _line(text: str) -> str:
    return re.sub(r"[\s\"'\\]+", " ", text)[:120]
