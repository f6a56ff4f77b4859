"""Chains and fault trees written by hand, or changes of those of an EDDI."""

from __future__ import annotations

from dataclasses import replace

from eddi_scaffold.common.problems import problem
from eddi_scaffold.common.units import duration, rate
from eddi_scaffold.kinds.reliability.system import (
    GATES,
    Arc,
    BasicEvent,
    Chain,
    FaultTree,
    Gate,
    Law,
    Observation,
)
from eddi_scaffold.kinds.reliability.values import KEY, Values

_TREE_KEYS = (
    "type",
    "model",
    "top",
    "gates",
    "events",
    "repair",
    "node_limit",
    "approximation",
    "age",
)
_WORDS = ("not", "and", "or", "xor", "implies", "true", "false", "unknown")
"""What an input of ``observe`` cannot be called: it was meant otherwise."""
_CHAIN_KEYS = ("type", "model", "states", "initial", "fail", "arcs", "observe", "repair", "age")


def read_chain(name: str, entry: Values, before: Chain | None) -> Chain | None:
    """Read a chain; ``before`` is that of the EDDI, of which the last three keys may change."""
    errors = entry.errors
    entry.only(_CHAIN_KEYS)
    chain = before if before is not None else _chain(entry, errors)
    # the names of states are only known where what makes them could be read
    if entry.has("observe") and (entry.errors == errors or entry.has("states") or before):
        chain = replace(chain, observe=_observe(name, entry, chain))
    if entry.has("repair"):
        chain = replace(chain, repair=entry.boolean("repair"))
    age = entry.quantity("age", duration)
    return chain if age is None else replace(chain, age=age)


def _chain(entry: Values, errors: int) -> Chain:
    """Read a chain of an entry that had so many errors before anything of it was looked at."""
    arcs: list[Arc] = []
    for map_ in entry.maps("arcs"):
        map_.only(("from", "to", "rate"))
        source, target = map_.text("from", required=True), map_.text("to", required=True)
        value = map_.quantity("rate", rate, required=True)
        if source is None or target is None or value is None:
            continue
        if source == target:
            map_.report("X020.arc_itself", source=source)
        else:
            arcs.append(Arc(source, target, value, map_.place()))
    named = [name for arc in arcs for name in (arc.source, arc.target)]
    states = entry.texts("states") or tuple(dict.fromkeys(named))
    for i, arc in enumerate(arcs):
        for key, state in (("from", arc.source), ("to", arc.target)):
            if state not in states:
                entry.report("R001.state", "arcs", i, key, key=key, state=state)
    initial, fail = entry.texts("initial"), entry.texts("fail")
    if entry.errors > errors and not entry.has("states"):
        return Chain(states, initial, fail, tuple(arcs))
    for key, names in (("initial", initial), ("fail", fail)):
        for state in names:
            if state not in states:
                entry.unknown(key, state, "state", states)
    if len(initial) == 1 and initial[0] in fail:
        entry.report("R007.starts_failed", "initial", state=initial[0])
    return Chain(states, initial, fail, tuple(arcs))


def _observe(name: str, entry: Values, chain: Chain) -> tuple[Observation, ...]:
    found: list[Observation] = []
    errors = entry.errors
    observe = entry.map("observe")
    if observe is None:
        return ()
    for state in observe.names():
        text = observe.text(state)
        if state not in chain.states:
            observe.unknown(state, state, f"state of {name!r}", chain.states, is_key=True)
        elif text is not None:
            words = text.split()
            negated = len(words) == 2 and words[0].casefold() == "not"
            is_one = len(words) == 1 or negated
            if not is_one or words[-1].casefold() in _WORDS:
                observe.report("R002.input", state, value=text)
            else:
                found.append(Observation(state, words[-1], negated))
    if entry.errors == errors:
        _shows_failure(name, entry, chain, found)
    return tuple(found)


def _shows_failure(name: str, entry: Values, chain: Chain, found: list[Observation]) -> None:
    """Warn of fail states that no input can exclude (R013)."""
    unseen = [state for state in chain.fail if all(one.state != state for one in found)]
    if not found or not unseen:
        return
    shown = ", ".join(unseen)
    first = min(found, key=lambda one: one.state not in chain.initial)
    input_ = first.input if first.negated else f"not {first.input}"
    entry.problems.append(
        problem(
            "R013.observe",
            entry.place("observe", KEY),
            name=name,
            shown=shown,
            unseen=unseen[0],
            input=input_,
        )
    )


def read_tree(name: str, entry: Values, before: FaultTree | None) -> FaultTree | None:
    """Read a tree; ``before`` is that of the EDDI, of which events may change."""
    errors = entry.errors
    entry.only(_TREE_KEYS)
    is_whole = entry.errors == errors
    gates = dict(before.gates) if before else _gates(entry)
    events = dict(before.events) if before else {}
    given = entry.map("events")
    for one in given.names() if given else ():
        assert given is not None
        if before and one not in before.events:
            given.unknown(one, one, f"event of {name!r}", before.events, is_key=True)
            continue
        event = given.map(one)
        if event is not None:
            events[one] = _event(one, event, events.get(one))
    top = before.top if before else entry.text("top")
    if not is_whole:
        return before  # gates or events may be missing only because their key is misspelt
    if top is None:
        top = _only_top(name, entry, gates)
    if top is None:
        return None
    if not before:
        _declare(entry, gates, events, top)
    tree = before or FaultTree(top, events, gates)
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


def _gates(entry: Values) -> dict[str, Gate]:
    found: dict[str, Gate] = {}
    gates = entry.map("gates")
    for name in gates.names() if gates else ():
        assert gates is not None
        one = gates.map(name)
        if one is None:
            continue
        one.only(("type", "of", "k"))
        given = (one.text("type") or "OR").upper()
        if given not in GATES:
            one.unknown("type", given, "type of gate", GATES)
        k = one.whole("k", -(10**9), 10**9)
        found[name] = Gate(name, given, one.texts("of"), k, one.place())
    return found


def _only_top(name: str, entry: Values, gates: dict[str, Gate]) -> str | None:
    used = {below for gate in gates.values() for below in gate.of}
    tops = [gate for gate in gates if gate not in used]
    if len(tops) == 1:
        return tops[0]
    found = f"several tops: {', '.join(tops)}" if tops else "no gate that no other one uses"
    entry.report("R012.top", name=name, tops=found)
    return None


def _declare(
    entry: Values, gates: dict[str, Gate], events: dict[str, BasicEvent], top: str
) -> None:
    """Report names without a definition."""
    known = [*gates, *events]
    if top not in known:
        entry.unknown("top", top, "gate", known)
    for gate in gates.values():
        for i, below in enumerate(gate.of):
            if below not in gates and below not in events:
                entry.report("R001.unknown_part", "gates", gate.name, "of", i, part=below)
    for both in sorted(set(gates) & set(events)):
        entry.report("R001.gate_and_event", "events", both, KEY, name=both)


def _event(name: str, entry: Values, before: BasicEvent | None) -> BasicEvent:
    entry.only(("rate", "scale", "shape", "p", "model", "observed", "age"))
    law = before.law if before else None
    value = entry.quantity("rate", rate)
    scale = entry.quantity("scale", duration)
    shape = entry.number("shape", 1e-6, 1e6, default=1.0)
    p = entry.number("p", 0.0, 1.0)
    model = entry.text("model")
    ways = [key for key in ("rate", "scale", "p", "model") if entry.has(key)]
    if len(ways) > 1:
        entry.report("R002.several", ways[1], name=name, listed=" and ".join(ways))
    if value is not None:
        law = Law("exponential", (value,))
    elif scale is not None and shape is not None:
        if scale <= 0.0:
            entry.report("R002.scale", "scale")
        law = Law("weibull", (scale, shape))
    elif p is not None:
        law = Law("fixed", (p,))
    elif model is not None:
        law = Law("model", model=model)
    observed = entry.boolean("observed") or bool(
        before and before.observed and not entry.has("observed")
    )
    age = entry.quantity("age", duration)
    if age is not None and law is not None and law.kind in ("fixed", "model"):
        entry.report("R002.age", "age", name=name)
    shown = before.name if before else name
    age = before.age if age is None and before else age
    return BasicEvent(shown, law, observed, age, before.place if before else entry.place())
