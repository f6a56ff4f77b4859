"""A system as ``reliability_config.yml``."""

from __future__ import annotations

from typing import Any

from eddi_scaffold.kinds.reliability.system import (
    UNITS,
    BasicEvent,
    Chain,
    ComponentModel,
    FaultTree,
    Law,
    ReliabilitySystem,
)
from eddi_scaffold.yaml_text.nodes import dump_plain


def to_yaml(system: ReliabilitySystem) -> str:
    """Return the text of a file that reads back as the same system."""
    horizon = _quantity("age", system.horizon)
    end = {"horizon": "mission_end", "mission_time": horizon}
    thresholds = [
        {"id": t.id, "at_most": t.activate, "release": t.release, "hold": f"{t.hold!r} s"}
        | ({"topic": t.topic} if t.topic else {})
        for t in system.thresholds
    ]
    gap = None if system.max_gap is None else f"{system.max_gap!r} s"
    return dump_plain(
        {
            **(end if system.mission_end else {"horizon": horizon}),
            "top": system.top,
            "models": {name: _component(model) for name, model in system.components.items()},
            **_present(thresholds=thresholds),
            "on_unknown": "worst_case" if system.worst_case else "inactive",
            **_present(max_gap=gap),
        }
    )


def _present(**entries: Any) -> dict[str, Any]:
    return {key: value for key, value in entries.items() if value}


def _quantity(key: str, value: Any) -> Any:
    if isinstance(value, list):
        return [_quantity(key, item) for item in value]
    unit = UNITS.get(key, "eV")
    return value if unit == "eV" else f"{value!r} {unit}"


def _component(component: ComponentModel) -> dict[str, Any]:
    content = component.content
    if isinstance(content, Chain):
        return {"type": "markov", **_chain(content)}
    if isinstance(content, FaultTree):
        return {"type": "fault_tree", **_tree(content)}
    if component.type == "series":
        return {"type": "series", "of": list(component.uses)}
    values = component.values.items()
    numbers = {key: _quantity(key, value) for key, value in values if value is not None}
    return {"type": component.type, **numbers}


def _chain(chain: Chain) -> dict[str, Any]:
    seen = {o.state: f"not {o.input}" if o.negated else o.input for o in chain.observe}
    return {
        "states": list(chain.states),
        "initial": list(chain.initial),
        "fail": list(chain.fail),
        "arcs": [
            {"from": arc.source, "to": arc.target, "rate": _quantity("rate", arc.rate)}
            for arc in chain.arcs
        ],
        **_present(observe=seen, repair=chain.repair, age=chain.age and f"{chain.age!r} h"),
    }


def _tree(tree: FaultTree) -> dict[str, Any]:
    return {
        "top": tree.top,
        "gates": {
            name: {"type": gate.type, "of": list(gate.of)}
            | ({} if gate.k is None else {"k": gate.k})
            for name, gate in tree.gates.items()
        },
        "events": {name: _event(event) for name, event in tree.events.items()},
        **_present(
            repair=tree.repair,
            node_limit=tree.node_limit,
            approximation="cut_sets" if tree.approximate else "",
            age=tree.age and f"{tree.age!r} h",
        ),
    }


def _event(event: BasicEvent) -> dict[str, Any]:
    entry: dict[str, Any] = {}
    match event.law:
        case Law("exponential", (rate,)):
            entry["rate"] = _quantity("rate", rate)
        case Law("weibull", (scale, shape)):
            entry |= {"scale": f"{scale!r} h", "shape": shape}
        case Law("fixed", (p,)):
            entry["p"] = p
        case Law("model", model=model):
            entry["model"] = model
    entry["observed"] = event.observed
    return entry if event.age is None else {**entry, "age": f"{event.age!r} h"}
