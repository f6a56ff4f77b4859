"""Chains and fault trees written by hand, or changes of those of an EDDI."""

from __future__ import annotations

from dataclasses import replace

from eddi_scaffold.common.units import duration, rate
from eddi_scaffold.kinds.reliability import system
from eddi_scaffold.kinds.reliability.values import KEY, Values

_NO_INPUTS = ("not", "and", "or", "xor", "implies", "true", "false", "unknown")
"""What an input of ``observe`` cannot be called: it was meant otherwise."""


def read_chain(name: str, entry: Values, before: system.Chain | None) -> system.Chain:
    """Read a chain; of that of an EDDI, ``before``, only what follows its arcs may change."""
    errors = entry.errors
    keys = ("type", "model", "states", "initial", "fail", "arcs", "observe", "repair", "age")
    entry.only(*keys)
    chain = before or _chain(entry, errors)
    # the names of states are only known where what makes them could be read
    if entry.has("observe") and (entry.errors == errors or entry.has("states") or before):
        chain = replace(chain, observe=_observe(name, entry, chain))
    if entry.has("repair"):
        chain = replace(chain, repair=entry.boolean("repair"))
    age = entry.quantity("age", duration)
    return chain if age is None else replace(chain, age=age)


def _chain(entry: Values, errors: int) -> system.Chain:
    """Read a chain of an entry that had so many errors before anything of it was looked at."""
    arcs: list[system.Arc] = []
    for map_ in entry.maps("arcs"):
        map_.only("from", "to", "rate")
        source, target = map_.text("from", required=True), map_.text("to", required=True)
        value = map_.quantity("rate", rate, required=True)
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
        if len(chain.initial) == 1 and chain.initial[0] in chain.fail:
            entry.report("R007.starts_failed", "initial", state=chain.initial[0])
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
            if (words and not is_negated) or input_.casefold() in ("", *_NO_INPUTS):
                observe.report("R002.input", state, value=text)
            else:
                observations.append(system.Observation(state, input_, is_negated))
    seen = {observation.state for observation in observations}
    unseen = [state for state in chain.fail if state not in seen]
    if observations and unseen and entry.errors == errors:
        first = min(observations, key=lambda observation: observation.state not in chain.initial)
        input_ = first.input if first.negated else f"not {first.input}"
        fields = {"shown": ", ".join(unseen), "unseen": unseen[0], "input": input_}
        entry.report("R013.observe", "observe", KEY, name=name, **fields)
    return tuple(observations)


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
    age = entry.quantity("age", duration)
    limit = entry.whole("node_limit", 1, 10_000_000)
    approximation = entry.choice("approximation", ("cut_sets",))
    return replace(
        tree,
        events=events,
        repair=entry.boolean("repair") if entry.has("repair") else tree.repair,
        node_limit=tree.node_limit if limit is None else limit,
        approximate=tree.approximate or approximation is not None,
        bounds_place=tree.bounds_place if approximation is None else entry.place("approximation"),
        age=tree.age if age is None else age,
    )


def _gates(entry: Values) -> dict[str, system.Gate]:
    gates: dict[str, system.Gate] = {}
    for name, map_ in entry.entries("gates"):
        map_.only("type", "of", "k")
        kind = (map_.text("type") or "OR").upper()
        if kind not in system.GATES:
            map_.unknown("type of gate", kind, system.GATES, "type")
        k = map_.whole("k", -(10**9), 10**9)
        gates[name] = system.Gate(name, kind, map_.texts("of"), k, map_.place())
    return gates


def _event(name: str, entry: Values, before: system.BasicEvent | None) -> system.BasicEvent:
    entry.only("rate", "scale", "shape", "p", "model", "observed", "age")
    event = before or system.BasicEvent(name, None, place=entry.place())
    value = entry.quantity("rate", rate)
    scale = entry.quantity("scale", duration, positive=True)
    shape = entry.number("shape", 1e-6, 1e6, default=1.0)
    p = entry.number("p", 0.0, 1.0)
    model = entry.text("model")
    laws = [key for key in ("rate", "scale", "p", "model") if entry.has(key)]
    if len(laws) > 1:
        entry.report("R002.several", laws[1], name=name, listed=" and ".join(laws))
    law = event.law
    if value is not None:
        law = system.Law("exponential", (value,))
    elif scale is not None and shape is not None:
        law = system.Law("weibull", (scale, shape))
    elif p is not None:
        law = system.Law("fixed", (p,))
    elif model is not None:
        law = system.Law("model", model=model)
    observed = entry.boolean("observed") if entry.has("observed") else event.observed
    age = entry.quantity("age", duration)
    if age is not None and law is not None and law.kind in ("fixed", "model"):
        entry.report("R002.age", "age", name=name)
    return replace(event, law=law, observed=observed, age=event.age if age is None else age)
