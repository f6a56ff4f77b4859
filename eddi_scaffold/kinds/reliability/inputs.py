"""What a monitor must be told: one input per motor, level, temperature, event."""

from __future__ import annotations

import re
from collections.abc import Iterator

from eddi_scaffold.kinds import ModelInput
from eddi_scaffold.kinds.reliability.model import Chain, Component, FaultTree, System

MISSION_END = "mission_end"


def inputs_of(system: System) -> list[ModelInput]:
    """Return the inputs in the order of the models; one that serves two of them once."""
    found: dict[str, ModelInput] = {}
    for component in system.components.values():
        for one in _inputs(component):
            found.setdefault(one.id, one)
    if system.mission_end:
        text = "Seconds from now to the end of the mission"
        found[MISSION_END] = ModelInput(MISSION_END, "float", unit="s", description=text)
    return list(found.values())


def input_id(model: str, rest: str) -> str:
    """Return the id of an input: names joined, all else than letters and digits as ``_``."""
    return re.sub(r"[^A-Za-z0-9_]", "_", f"{model}_{rest}")


def _inputs(component: Component) -> Iterator[ModelInput]:
    name, content = component.name, component.content
    if isinstance(content, Chain):
        for one in content.observe:
            text = f"{'False' if not one.negated else 'True'}: {name} is not in state {one.state}"
            yield ModelInput(one.input, "bool", description=_line(text))
    elif isinstance(content, FaultTree):
        for key, event in content.events.items():
            if event.observed:
                text = _line(f"Has the event {event.name} happened?")
                yield ModelInput(
                    input_id(name, key), "bool", description=text, is_good=lambda v: v is False
                )
    elif component.type == "propulsion":
        yield from _motors(component)
    elif component.type == "battery":
        text = "State of charge in percent"
        yield ModelInput(input_id(name, "level"), "float", unit="%", description=text)
        if "t_ref" in component.values:
            text = "Temperature of the battery"
            yield ModelInput(input_id(name, "temperature"), "float", unit="degC", description=text)
    elif component.type == "processor":
        text = "Temperature of the processor"
        yield ModelInput(input_id(name, "temperature"), "float", unit="degC", description=text)
        text = "Load of the processor, 1 for full"
        yield ModelInput(input_id(name, "utilisation"), "float", description=text)
    elif component.type == "k_out_of_n":
        text = f"How many units are available, {component.values['k']} are needed"
        yield ModelInput(input_id(name, "available"), "int", description=text)


def _motors(component: Component) -> Iterator[ModelInput]:
    count = len(component.values["rates"])
    if component.values["status"] == "list":
        text = f"Does each of the {count} motors work?"
        yield ModelInput(input_id(component.name, "status"), "bool[]", description=text)
        return
    for i in range(count):
        text = f"Does motor {i} work?"
        yield ModelInput(
            input_id(component.name, f"motor_{i}"),
            "bool",
            description=text,
            is_good=lambda v: v is True,
        )


def _line(text: str) -> str:
    return re.sub(r"[\s\"'\\]+", " ", text)[:120]
