"""A system as ``reliability_config.yml``."""

from __future__ import annotations

import re
from collections.abc import Iterator
from typing import Any

from eddi_scaffold.common.escaping import xml_text
from eddi_scaffold.common.identifiers import free_name
from eddi_scaffold.kinds.reliability.system import (
    DYNAMIC,
    UNITS,
    BasicEvent,
    Chain,
    ComponentModel,
    FaultTree,
    Gate,
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


_UNITS = {"exponential": "hours-1", "weibull": "hours"}
"""Law -> unit of its first number, which is a parameter because only these have units."""


def to_open_psa(system: ReliabilitySystem) -> str | None:
    """Return the text; ``None`` for what the format does not have: ages, orders, chains."""
    tree = system.components[system.top].content
    if not isinstance(tree, FaultTree) or tree.age:
        return None
    for event in tree.events.values():
        if event.law is None or event.law.model or event.age:
            return None
    for gate in tree.gates.values():
        is_repeated = len(set(gate.of)) < len(gate.of) and gate.type not in ("AND", "OR")
        if gate.type in DYNAMIC or is_repeated:
            return None
    return "".join(f"{line}\n" for line in _lines(system.top, tree))


def _lines(name: str, tree: FaultTree) -> Iterator[str]:
    names: dict[str, str] = {}
    taken: set[str] = set()
    for key in tree.reached()[0][::-1]:
        names[key] = _name(key, taken)
        taken.add(names[key])
    laws = {key: event.law for key, event in tree.events.items() if event.law}
    yield '<?xml version="1.0" encoding="UTF-8"?>'
    yield "<opsa-mef>"
    yield f'  <define-fault-tree name="{_name(name, set())}">'
    for key, own in names.items():
        gate = tree.gates.get(key)
        type_, label = ("gate", gate.name) if gate else ("basic-event", tree.events[key].name)
        yield f'    <define-{type_} name="{own}">'
        if label != own:
            yield f"      <label>{xml_text(label)}</label>"
        yield f"      {_formula(gate, tree, names) if gate else _law(laws[key], own)}"
        yield f"    </define-{type_}>"
    for key, own in names.items():
        if key in laws and laws[key].kind in _UNITS:
            yield f'    <define-parameter name="{own}" unit="{_UNITS[laws[key].kind]}">'
            yield f'      <float value="{laws[key].values[0]!r}"/>'
            yield "    </define-parameter>"
    yield "  </define-fault-tree>"
    yield "</opsa-mef>"


def _name(text: str, taken: set[str]) -> str:
    """Return an identifier of the format: ASCII letters, digits, underscores, a letter first."""
    word = re.sub(r"[^A-Za-z0-9_]", "_", text).strip("_")
    return free_name(word if word[:1].isalpha() else f"n{word}", taken)


def _formula(gate: Gate, tree: FaultTree, names: dict[str, str]) -> str:
    inputs = [
        f'<{"gate" if key in tree.gates else "basic-event"} name="{names[key]}"/>'
        for key in dict.fromkeys(gate.of)
    ]
    kind, count = gate.type.lower(), len(inputs)
    if gate.type == "VOTE":
        kind = {1: "or", count: "and"}.get(gate.k or 0, f'atleast min="{gate.k}"')
    if not inputs:
        return '<constant value="false"/>'
    if count == 1 and kind != "not":
        return inputs[0]
    while kind == "xor" and len(inputs) > 2:
        inputs[:2] = [f"<xor>{inputs[0]}{inputs[1]}</xor>"]
    return f"<{kind}>{''.join(inputs)}</{kind.split()[0]}>"


def _law(law: Law, name: str) -> str:
    if law.kind == "fixed":
        return f'<float value="{law.values[0]!r}"/>'
    if law.kind == "exponential":
        return f'<exponential><parameter name="{name}"/><system-mission-time/></exponential>'
    values = f'<parameter name="{name}"/><float value="{law.values[1]!r}"/><float value="0"/>'
    return f"<Weibull>{values}<system-mission-time/></Weibull>"
