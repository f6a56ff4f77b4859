"""System -> the ``model`` part of ``config/model.json``."""

from __future__ import annotations

from functools import lru_cache
from typing import Any

from eddi_scaffold.common.problems import Place
from eddi_scaffold.compiling.reliability.cut_sets import cut_sets_of_gates
from eddi_scaffold.compiling.reliability.diagram import NODE_LIMIT, Diagram, build
from eddi_scaffold.compiling.reliability.model import certain
from eddi_scaffold.compiling.reliability.simplification import Gate as Number
from eddi_scaffold.kinds.reliability.inputs import input_id
from eddi_scaffold.kinds.reliability.system import (
    DYNAMIC,
    Chain,
    ComponentModel,
    FaultTree,
    Gate,
    ReliabilitySystem,
    order,
)


def runtime_model(system: ReliabilitySystem) -> dict[str, Any]:
    """Return what the runtime compiles: only what the top uses, each behind what it needs."""
    below = {name: component.below for name, component in system.components.items()}
    names = [n for n in order(system.top, below)[0] if n in system.components]
    return {
        "components": [_component(system.components[name]) for name in names],
        "top": system.top,
        "horizon": system.horizon,
        "mission_end": system.mission_end,
        "quantum": system.quantum,
        "thresholds": [
            {"id": t.id, "activate": t.activate, "release": t.release, "hold": t.hold}
            for t in system.thresholds
        ],
        "on_unknown": "worst_case" if system.worst_case else "inactive",
        "max_gap": system.usual_gap,
    }


def _component(component: ComponentModel) -> dict[str, Any]:
    head = {"name": component.name, "type": component.type, "place": _place(component.place)}
    if isinstance(component.content, FaultTree):
        return {**head, **_tree(component.name, component.content)}
    if isinstance(component.content, Chain):
        return {**head, **_chain(component.content)}
    return {**head, **_VALUES[component.type](component)}


def _place(place: Place) -> str:
    """Return the fragment path in the EDDI, or the line in the file."""
    return place.path or (f"line {place.line}" if place.line else "")


def _chain(chain: Chain) -> dict[str, Any]:
    number = {state: i for i, state in enumerate(chain.states)}
    return {
        "states": list(chain.states),
        "initial": number[chain.initial[0]],
        "fail": [number[state] for state in chain.fail],
        "arcs": [[number[a.source], number[a.target], a.rate] for a in chain.arcs],
        "observe": [[number[o.state], o.input, o.negated] for o in chain.observe],
        **({"repair": True} if chain.repair else {}),
        **_age(chain.age),
    }


def _tree(name: str, tree: FaultTree) -> dict[str, Any]:
    """Return events and gates by number; ports are ORs, dynamic gates are events."""
    names, _ = order(tree.top, {key: gate.of for key, gate in tree.gates.items()})
    inner = {below for key in names if _is_dynamic(tree, key) for below in tree.gates[key].of}
    leaves = [key for key in names if key in tree.events and key not in inner]
    leaves += [key for key in names if _is_dynamic(tree, key)]
    number = {key: i for i, key in enumerate(leaves)}
    merged = _merge_models(tree, leaves, number)
    gates = [key for key in names if key in tree.gates and not _is_dynamic(tree, key)]
    count = len(merged)
    number.update({key: count + i for i, key in enumerate(gates)})
    numbered = [_gate(tree.gates[key], number) for key in gates]
    return {
        "events": [
            _event(name, key, tree) if key in tree.events else _dynamic(tree, key) for key in merged
        ],
        "gates": numbered,
        "top": number[tree.top],
        "repair": tree.repair,
        **({"node_limit": tree.node_limit} if tree.node_limit else {}),
        **(_cut_sets(count, numbered, number[tree.top]) if tree.approximate else {}),
    }


def gates_of(part: dict[str, Any]) -> tuple[Number, ...]:
    """Return the gates of a fault tree of the runtime model."""
    return tuple(
        Number(gate["type"], tuple(gate["of"]), gate.get("k", 0)) for gate in part["gates"]
    )


def diagram_of(part: dict[str, Any], known: dict[int, bool] | None = None) -> Diagram:
    """Return the diagram of a fault tree of the runtime model, as it will run.

    Args:
        part: the tree.
        known: events that are certain or cannot happen; None: those whose probability says so.

    Raises:
        TooLargeError: it is above the limit.
    """
    events = part["events"]
    first = frozenset(i for i, event in enumerate(events) if event["input"] is not None)
    limit = part.get("node_limit", NODE_LIMIT)
    sure = certain(events) if known is None else known
    return build(len(events), gates_of(part), part["top"], first, limit, sure)


def gate_name(tree: FaultTree, part: dict[str, Any], number: int) -> str:
    """Return the name of a gate that has a number in the runtime model."""
    names, _ = order(tree.top, {key: gate.of for key, gate in tree.gates.items()})
    gates = [key for key in names if key in tree.gates and not _is_dynamic(tree, key)]
    return tree.gates[gates[number - len(part["events"])]].name


def _cut_sets(events: int, gates: list[dict[str, Any]], top: int) -> dict[str, Any]:
    found = _all_cut_sets(events, gates_of({"gates": gates}), top)
    return {} if found is None else {"cut_sets": [sorted(one) for one in found]}


@lru_cache(maxsize=8)
def _all_cut_sets(
    events: int, gates: tuple[Number, ...], top: int
) -> tuple[frozenset[int], ...] | None:
    """Return all minimal cut sets; None: too many, or none of a tree with NOT or XOR."""
    try:
        return cut_sets_of_gates(events, gates, top)
    except ValueError:
        return None


def _is_dynamic(tree: FaultTree, key: str) -> bool:
    return key in tree.gates and tree.gates[key].type in DYNAMIC


def _merge_models(tree: FaultTree, leaves: list[str], number: dict[str, int]) -> list[str]:
    """Number the leaves; two events of the same other model are one event."""
    kept: list[str] = []
    of_model: dict[str, int] = {}
    for key in leaves:
        event = tree.events.get(key)
        model = event.law.model if event and event.law and not event.observed else ""
        if model and model in of_model:
            number[key] = of_model[model]
            continue
        number[key] = len(kept)
        if model:
            of_model[model] = number[key]
        kept.append(key)
    return kept


def _event(name: str, key: str, tree: FaultTree) -> dict[str, Any]:
    event = tree.events[key]
    law = event.law
    assert law is not None
    return {
        "name": event.name,
        "law": law.kind,
        "values": list(law.values),
        "model": law.model,
        "input": input_id(name, key) if event.observed else None,
        **_age(tree.age if event.age is None else event.age),
        **_path(event.place),
    }


def _path(place: Place) -> dict[str, str]:
    return {"place": place.path} if place.path else {}


def _age(hours: float) -> dict[str, float]:
    return {"age": hours} if hours else {}


def _dynamic(tree: FaultTree, key: str) -> dict[str, Any]:
    gate = tree.gates[key]
    rates = [law.values[0] for name in gate.of if (law := tree.events[name].law)]
    if gate.type == "SAND":  # independent continuous events never happen at the same instant
        return {"name": key, "law": "fixed", "values": [0.0], "model": "", "input": None}
    found = {"name": key, "law": gate.type, "values": rates, "model": "", "input": None}
    return {**found, **_age(tree.age)}


def _gate(gate: Gate, number: dict[str, int]) -> dict[str, Any]:
    found: dict[str, Any] = {"type": gate.type, "of": [number[name] for name in gate.of]}
    if gate.type == "NOT" and not gate.of:
        found["type"] = "OR"
    if gate.type == "VOTE":
        found["k"] = gate.k
    return {**found, "name": gate.name, **_path(gate.place)}


def _propulsion(component: ComponentModel) -> dict[str, Any]:
    values = component.values
    name, count = component.name, len(values["rates"])
    rates: list[float] = [0.0] * count
    inputs: list[list[Any]] = [[] for _ in range(count)]
    for motor, position in enumerate(values["positions"]):
        rates[position] = values["rates"][motor]
        as_list = values["status"] == "list"
        inputs[position] = (
            [input_id(name, "status"), motor]
            if as_list
            else [input_id(name, f"motor_{motor}"), None]
        )
    return {
        "configuration": values["configuration"],
        "rates": rates,
        "inputs": inputs,
        "repair": values["repair"],
    }


def _battery(component: ComponentModel) -> dict[str, Any]:
    found = {**component.values, "level": input_id(component.name, "level")}
    if "t_ref" in component.values:
        found["temperature"] = input_id(component.name, "temperature")
    return found


def _processor(component: ComponentModel) -> dict[str, Any]:
    return {
        **component.values,
        "temperature": input_id(component.name, "temperature"),
        "utilisation": input_id(component.name, "utilisation"),
    }


def _k_out_of_n(component: ComponentModel) -> dict[str, Any]:
    return {**component.values, "available": input_id(component.name, "available")}


def _series(component: ComponentModel) -> dict[str, Any]:
    return {"of": list(component.uses)}


_VALUES = {
    "propulsion": _propulsion,
    "battery": _battery,
    "processor": _processor,
    "k_out_of_n": _k_out_of_n,
    "series": _series,
}
