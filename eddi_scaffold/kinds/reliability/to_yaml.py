"""A system as ``reliability_config.yml``: all of it in one file, every number with its unit."""

from __future__ import annotations

from typing import Any

from eddi_scaffold.kinds.reliability.model import (
    BasicEvent,
    Chain,
    ComponentModel,
    FaultTree,
    ReliabilitySystem,
)
from eddi_scaffold.positioned_yaml.nodes import dump_plain


def to_yaml(system: ReliabilitySystem) -> str:
    """Return the text of a file that reads back as the same system."""
    data: dict[str, Any] = {}
    if system.mission_end:
        data["horizon"] = "mission_end"
        data["mission_time"] = _hours(system.horizon)
    else:
        data["horizon"] = _hours(system.horizon)
    data["top"] = system.top
    data["models"] = {name: _component(one) for name, one in system.components.items()}
    if system.thresholds:
        data["thresholds"] = [
            {"id": t.id, "activate": t.activate, "release": t.release, "hold": f"{t.hold!r} s"}
            | ({"topic": t.topic} if t.topic else {})
            for t in system.thresholds
        ]
    data["on_unknown"] = "worst_case" if system.worst_case else "inactive"
    if system.max_gap is not None:
        data["max_gap"] = f"{system.max_gap!r} s"
    return dump_plain(data)


def _hours(value: float) -> str:
    return f"{value!r} h"


def _per_hour(value: float) -> str:
    return f"{value!r} 1/h"


def _component(component: ComponentModel) -> dict[str, Any]:
    content = component.content
    if isinstance(content, Chain):
        return {"type": "markov", **_chain(content)}
    if isinstance(content, FaultTree):
        return {"type": "fault_tree", **_tree(content)}
    if component.type == "series":
        return {"type": "series", "of": list(component.uses)}
    found: dict[str, Any] = {"type": component.type}
    for key, value in component.values.items():
        if value is not None:
            found[key] = _value(key, value)
    return found


def _value(key: str, value: Any) -> Any:
    if key == "rates":
        return [_per_hour(one) for one in value]
    if key in ("rate", "failure_rate", "alpha", "beta", "degradation"):
        return _per_hour(value)
    if key in ("mttf_ref", "age"):
        return _hours(value)
    if key in ("t_ref", "t_max"):
        return f"{value!r} degC"
    return value


def _chain(chain: Chain) -> dict[str, Any]:
    found: dict[str, Any] = {
        "states": list(chain.states),
        "initial": list(chain.initial),
        "fail": list(chain.fail),
        "arcs": [{"from": a.source, "to": a.target, "rate": _per_hour(a.rate)} for a in chain.arcs],
    }
    if chain.observe:
        found["observe"] = {
            o.state: f"not {o.input}" if o.negated else o.input for o in chain.observe
        }
    if chain.repair:
        found["repair"] = True
    if chain.age:
        found["age"] = _hours(chain.age)
    return found


def _tree(tree: FaultTree) -> dict[str, Any]:
    gates: dict[str, Any] = {}
    for name, gate in tree.gates.items():
        gates[name] = {"type": gate.type, "of": list(gate.of)}
        if gate.k is not None:
            gates[name]["k"] = gate.k
    found: dict[str, Any] = {"top": tree.top, "gates": gates}
    found["events"] = {name: _event(event) for name, event in tree.events.items()}
    if tree.repair:
        found["repair"] = True
    if tree.node_limit:
        found["node_limit"] = tree.node_limit
    if tree.approximate:
        found["approximation"] = "cut_sets"
    if tree.age:
        found["age"] = _hours(tree.age)
    return found


def _event(event: BasicEvent) -> dict[str, Any]:
    law = event.law
    found: dict[str, Any] = {}
    if law is not None:
        if law.kind == "exponential":
            found["rate"] = _per_hour(law.values[0])
        elif law.kind == "weibull":
            found["scale"], found["shape"] = _hours(law.values[0]), law.values[1]
        elif law.kind == "fixed":
            found["p"] = law.values[0]
        else:
            found["model"] = law.model
    found["observed"] = event.observed
    if event.age is not None:
        found["age"] = _hours(event.age)
    return found
