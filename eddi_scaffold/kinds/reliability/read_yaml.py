"""``reliability_config.yml``, or its keys in an ``eddi_config.yml``: plain values -> System."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import replace
from typing import Any

from eddi_runtime.reliability.component import ReliabilityResult

from eddi_scaffold.common.identifiers import is_ros_name
from eddi_scaffold.common.problems import Problem
from eddi_scaffold.common.units import duration, rate, seconds, temperature
from eddi_scaffold.kinds.reliability import KEYS, system
from eddi_scaffold.kinds.reliability.values import KEY, Values

_Library = Mapping[str, system.ReliabilitySystem]


def read_chain(name: str, entry: Values, before: system.Chain | None) -> system.Chain:
    """Read a chain; of that of an EDDI, ``before``, only what follows its arcs may change."""
    errors = entry.errors
    keys = ("type", "model", "states", "initial", "fail", "arcs", "observe", "repair", "age")
    entry.only(*keys)
    chain = before or _chain(entry, errors)
    # the names of states are only known where what makes them could be read
    if entry.has("observe") and (entry.errors == errors or entry.has("states") or before):
        chain = replace(chain, observe=_observe(name, entry, chain))
    repair, age = entry.boolean("repair", chain.repair), entry.quantity("age", duration, chain.age)
    return replace(chain, repair=repair, age=age)


def _chain(entry: Values, errors: int) -> system.Chain:
    """Read a chain of an entry that had so many errors before anything of it was looked at."""
    arcs: list[system.Arc] = []
    for map_ in entry.maps("arcs"):
        map_.only("from", "to", "rate")
        source, target = map_.text("from", required=True), map_.text("to", required=True)
        value = map_.quantity("rate", rate, None, required=True)
        if source is None or target is None or value is None:
            continue
        if source == target:
            map_.report("X020.arc_itself", source=source)
        else:
            arcs.append(system.Arc(source, target, value, map_.place()))
    named = [name for arc in arcs for name in (arc.source, arc.target)]
    states = entry.texts("states") or tuple(dict.fromkeys(named))
    for i, arc in enumerate(arcs):
        for key, state in (("from", arc.source), ("to", arc.target)):
            if state not in states:
                entry.report("R001.state", "arcs", i, key, key=key, state=state)
    chain = system.Chain(states, entry.texts("initial"), entry.texts("fail"), tuple(arcs))
    if entry.errors == errors or entry.has("states"):
        for key, names in (("initial", chain.initial), ("fail", chain.fail)):
            for state in names:
                if state not in states:
                    entry.unknown("state", state, states, key)
    return chain


def _observe(name: str, entry: Values, chain: system.Chain) -> tuple[system.Observation, ...]:
    observe, errors = entry.map("observe"), entry.errors
    if observe is None:
        return ()
    observations: list[system.Observation] = []
    for state in map(str, observe.data):
        text = observe.text(state)
        if state not in chain.states:
            observe.unknown(f"state of {name!r}", state, chain.states, state, KEY)
        elif text is not None:
            *words, input_ = text.split() or [""]
            is_negated = [word.casefold() for word in words] == ["not"]
            if (words and not is_negated) or not input_:
                observe.report("R002.input", state, value=text)
            else:
                observations.append(system.Observation(state, input_, is_negated))
    seen = {observation.state for observation in observations}
    unseen = [state for state in chain.fail if state not in seen]
    if observations and unseen and entry.errors == errors:
        entry.report("R013.observe", "observe", KEY, name=name, shown=", ".join(unseen))
    # in the order of the states, whatever that of the map: packages remember it sorted
    return tuple(sorted(observations, key=lambda seen: chain.states.index(seen.state)))


def read_tree(name: str, entry: Values, before: system.FaultTree | None) -> system.FaultTree | None:
    """Read a tree; of that of an EDDI, ``before``, its events and what follows may change."""
    errors = entry.errors
    keys = ("type", "model", "top", "gates", "events", "repair", "node_limit", "approximation")
    entry.only(*keys, "age")
    has_own_keys = entry.errors == errors
    gates = before.gates if before else _gates(entry)
    events = dict(before.events) if before else {}
    for id_, map_ in entry.entries("events"):
        if before and id_ not in before.events:
            map_.unknown(f"event of {name!r}", id_, before.events, KEY)
        else:
            events[id_] = _event(id_, map_, events.get(id_))
    if not has_own_keys:
        return before  # gates or events may be missing only because their key is misspelt
    top = before.top if before else entry.text("top")
    if top is None:
        used = {below for gate in gates.values() for below in gate.of}
        tops = [gate for gate in gates if gate not in used]
        if len(tops) != 1:
            shown = f"several tops: {', '.join(tops)}" if tops else "no gate that no other one uses"
            entry.report("R012.top", name=name, tops=shown)
            return None
        (top,) = tops
    if not before:
        if top not in gates and top not in events:
            entry.unknown("gate", top, [*gates, *events], "top")
        for gate in gates.values():
            for i, below in enumerate(gate.of):
                if below not in gates and below not in events:
                    entry.report("R001.unknown_part", "gates", gate.name, "of", i, part=below)
        for both in sorted(set(gates) & set(events)):
            entry.report("R001.gate_and_event", "events", both, KEY, name=both)
    tree = before or system.FaultTree(top, events, gates)
    approximation = entry.choice("approximation", ("cut_sets",))
    return replace(
        tree,
        events=events,
        repair=entry.boolean("repair", tree.repair),
        node_limit=entry.whole_number("node_limit", 1, 10_000_000, tree.node_limit),
        approximate=tree.approximate or approximation is not None,
        bounds_place=tree.bounds_place if approximation is None else entry.place("approximation"),
        age=entry.quantity("age", duration, tree.age),
    )


def _gates(entry: Values) -> dict[str, system.Gate]:
    gates: dict[str, system.Gate] = {}
    for name, map_ in entry.entries("gates"):
        map_.only("type", "of", "k")
        kind = (map_.text("type") or "OR").upper()
        if kind not in system.GATES:
            map_.unknown("type of gate", kind, system.GATES, "type")
        k = map_.whole_number("k", -(10**9), 10**9, None)
        gates[name] = system.Gate(name, kind, map_.texts("of"), k, map_.place())
    return gates


def _event(name: str, entry: Values, before: system.BasicEvent | None) -> system.BasicEvent:
    entry.only("rate", "scale", "shape", "p", "model", "observed", "age")
    event = before or system.BasicEvent(name, None, place=entry.place())
    value = entry.quantity("rate", rate, None)
    scale = entry.quantity("scale", duration, None, positive=True)
    shape = entry.number("shape", 1e-6, 1e6, 1.0)
    p = entry.number("p", 0.0, 1.0, None)
    laws = [key for key in ("rate", "scale", "p", "model") if entry.has(key)]
    if len(laws) > 1:
        entry.report("R002.several", laws[1], name=name, listed=" and ".join(laws))
    law = event.law
    if value is not None:
        law = system.Law("exponential", (value,))
    elif scale is not None:
        law = system.Law("weibull", (scale, shape))
    elif p is not None:
        law = system.Law("fixed", (p,))
    elif model := entry.text("model"):
        law = system.Law("model", model=model)
    if entry.has("age") and law is not None and law.kind in ("fixed", "model"):
        entry.report("R002.age", "age", name=name)
    age = entry.quantity("age", duration, event.age)
    return replace(event, law=law, observed=entry.boolean("observed", event.observed), age=age)


_ID = re.compile(r"[A-Za-z_][A-Za-z0-9_]*")
_RESULTS = (
    *("t", "header", "model", "mttf_hours", "horizon_seconds", "unknown_inputs", "accepted"),
    *ReliabilityResult._fields,
)
"""Names of what is published and recorded, thresholds apart."""
_HEAT = ("t_ref", "t_max", "activation_energy")


def read_system(
    values: Values, library: _Library, base: system.ReliabilitySystem | None
) -> tuple[system.ReliabilitySystem | None, list[Problem]]:
    """Read the keys of a monitor, which change ``base``; ``model:`` names one of the library."""
    before = base or system.ReliabilitySystem({}, "", place=values.place())
    components = dict(before.components)
    for name, entry in values.entries("models"):
        components.update(_component(name, entry, library, before))
    values.only(*KEYS, "file", "parameters")
    longest = values.quantity("mission_time", duration, None, positive=True)
    horizon, mission_end = before.horizon, before.mission_end
    if values.text("horizon") == "mission_end":
        if longest is None:
            values.report("R001.no_mission_time", "horizon")
        horizon, mission_end = longest or 1.0, True
    else:
        horizon = values.quantity("horizon", duration, horizon, positive=True)
        mission_end = mission_end and not values.has("horizon")
    on_unknown = values.choice("on_unknown", ("inactive", "worst_case"))
    gap = values.converted("max_gap", seconds, before.max_gap)
    thresholds = _thresholds(values) if values.has("thresholds") else before.thresholds
    if values.errors:  # components that cannot be read would be missed by what uses them
        return None, values.problems
    top = values.text("top") or before.top
    used = {name for component in components.values() for name in component.below}
    free = [name for name in components if name not in used] or list(components)
    if not top and len(free) > 1:  # several that no other uses become a series
        top = "all" if "all" not in components else "all_models"
        components[top] = system.ComponentModel(
            top, "series", uses=tuple(free), place=values.place()
        )
    elif not top and free:
        top = free[0]
    elif not top:
        values.report("R001.no_model")
    elif top not in components:
        values.unknown("model", top, components, "top")
    changed = replace(
        before,
        components=components,
        top=top,
        horizon=horizon,
        mission_end=mission_end,
        thresholds=thresholds,
        worst_case=on_unknown == "worst_case" if on_unknown else before.worst_case,
        max_gap=gap,
    )
    return (None if values.errors else changed), values.problems


def _thresholds(values: Values) -> tuple[system.Threshold, ...]:
    thresholds: dict[str, system.Threshold] = {}
    owners: dict[str, str] = {}  # of topics
    for entry in values.maps("thresholds"):
        key = "activate" if entry.has("activate") else "at_most"  # the former name
        entry.only("id", key, "release", "hold", "topic")
        name = entry.text("id", required=True)
        activate = entry.number(key, 0.0, 1.0, None, required=True)
        release = entry.number("release", 0.0, 1.0, activate)
        hold = entry.converted("hold", seconds, 0.0)
        topic = entry.text("topic")
        if topic is not None and not is_ros_name(topic):
            entry.report("R002.topic", "topic")
        if name is None or activate is None or release is None:
            continue
        if _ID.fullmatch(name) is None:
            entry.report("R001.id", "id", name=name)
        elif name in _RESULTS:
            entry.report("R001.reserved", "id", name=name, results=", ".join(_RESULTS))
        if name in thresholds:
            entry.report("R001.same_name", "id", name=name)
        other = owners.setdefault(topic, name) if topic else name
        if other != name:
            entry.report("R001.same_topic", "topic", first=other, second=name, topic=topic)
        if release < activate:
            entry.report("R001.release", "release", name=name, release=release, activate=activate)
        thresholds[name] = system.Threshold(name, activate, release, hold, topic, entry.place())
    return tuple(thresholds.values())


def _component(
    name: str, entry: Values, library: _Library, base: system.ReliabilitySystem
) -> Mapping[str, system.ComponentModel]:
    before = base.components.get(name)
    kind = entry.text("type") or (before.type if before else None)
    if kind is None:
        known, types = ", ".join(base.components) or "none", ", ".join(system.TYPES)
        entry.report("R001.no_type", name=name, known=known, types=types)
    elif kind in ("markov", "fault_tree"):
        return _content(name, kind, entry, library, before)
    elif kind == "series":
        entry.only("type", "of")
        uses = entry.texts("of", required=True)
        if entry.data.get("of") == []:
            entry.report("R005.series", "of", name=name)
        return {name: system.ComponentModel(name, kind, uses=uses, place=entry.place())}
    elif kind not in system.TYPES:
        entry.unknown("type", kind, system.TYPES, "type")
    else:
        values = _ready_made(kind, entry, name)
        return {name: system.ComponentModel(name, kind, values=values, place=entry.place())}
    return {}


def _content(
    name: str, kind: str, entry: Values, library: _Library, before: system.ComponentModel | None
) -> Mapping[str, system.ComponentModel]:
    parts: Mapping[str, system.ComponentModel] = {}
    referred = entry.text("model")
    if referred is not None:
        fitting = {n: s for n, s in library.items() if s.components[s.top].type == kind}
        if referred not in fitting:
            entry.unknown(kind.replace("_", " "), referred, fitting, "model")
            return {}
        parts = fitting[referred].components
        before = parts[fitting[referred].top]
    content = before.content if before else None
    if kind == "markov":
        content = read_chain(name, entry, content if isinstance(content, system.Chain) else None)
    else:
        content = read_tree(name, entry, content if isinstance(content, system.FaultTree) else None)
    if content is None:
        return {}
    component = system.ComponentModel(name, kind, content, place=entry.place())
    # with the chains that the tree of the file is bound to
    return {**{n: parts[n] for n in component.below if n in parts}, name: component}


def _ready_made(kind: str, entry: Values, name: str) -> Mapping[str, Any]:
    match kind:
        case "propulsion":
            return _propulsion(entry, name)
        case "battery":
            keys = ("failure_rate", "alpha", "beta", "degradation")
            entry.only("type", *keys, *_HEAT, "repair")
            values: dict[str, Any] = {
                key: entry.quantity(key, rate, None, required=True) for key in keys
            }
            if any(entry.has(key) for key in _HEAT):
                for key in ("t_ref", "t_max"):
                    values[key] = entry.converted(key, temperature, None, required=True)
                energy = entry.number("activation_energy", 0.0, 10.0, None, required=True)
                values["activation_energy"] = energy
            return {**values, "repair": entry.boolean("repair")}
        case "processor":
            entry.only("type", "mttf_ref", *_HEAT, "u_max", "shape", "age")
            age = entry.quantity("age", duration, None)
            return {
                "mttf_ref": entry.quantity(
                    "mttf_ref", duration, None, required=True, positive=True
                ),
                "t_ref": entry.converted("t_ref", temperature, None, required=True),
                "t_max": entry.converted("t_max", temperature, None, required=True),
                "u_max": entry.number("u_max", 0.0, 1e6, None, required=True),
                "activation_energy": entry.number("activation_energy", 0.0, 10.0, 0.3),
                "shape": entry.number("shape", 0.01, 100.0, 1.0),
                **({"age": age} if age is not None else {}),
            }
    entry.only("type", "k", "rate", "max")
    k = entry.whole_number("k", 1, 10_000, None, required=True)
    value = entry.quantity("rate", rate, None, required=True)
    return {"k": k, "rate": value, "max": entry.whole_number("max", k or 1, 10_000, None)}


def _propulsion(entry: Values, name: str) -> Mapping[str, Any]:
    entry.only("type", "configuration", "rate", "rates", "positions", "status", "repair")
    configuration = entry.text("configuration", required=True)
    motors = len(configuration or "")
    rates, common_rate = entry.quantities("rates", rate), entry.quantity("rate", rate, None)
    positions = entry.data["positions"] if entry.has("positions") else list(range(motors))
    places = sorted(map(repr, positions)) if isinstance(positions, list) else None
    fields: dict[str, Any] = {"configuration": configuration, "motors": motors}
    if configuration is None:
        pass  # it was reported
    elif configuration not in system.FATAL:
        fields["known"] = ", ".join(system.CONFIGURATIONS)
        entry.report("R001.configuration", "configuration", **fields)
    elif entry.has("rate") == entry.has("rates"):
        entry.report("R001.rate", name=name)
    elif rates is not None and len(rates) != motors:
        entry.report("R005.rates", "rates", rates=len(rates), **fields)
    elif places != sorted(map(repr, range(motors))):
        entry.report("R005.positions", "positions", last=motors - 1)
    return {
        "configuration": configuration,
        "rates": [common_rate] * motors if rates is None else rates,
        "positions": positions,
        "status": entry.choice("status", ("motors", "list")) or "motors",
        "repair": entry.boolean("repair"),
    }
