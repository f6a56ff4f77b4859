"""Text description of a system, for ``show`` and for a package's README; its picture."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from typing import Any

from eddi_scaffold.common.escaping import markdown_code, markdown_text
from eddi_scaffold.diagrams import Diagram, DiagramEdge, DiagramNode, LegendEntry
from eddi_scaffold.diagrams.diagram import Shape, Tone
from eddi_scaffold.kinds.reliability.cut_sets import minimal_cut_sets
from eddi_scaffold.kinds.reliability.lowering import lower_tree
from eddi_scaffold.kinds.reliability.system import (
    BasicEvent,
    Chain,
    ComponentModel,
    FaultTree,
    Gate,
    ReliabilitySystem,
)
from eddi_scaffold.kinds.reliability.trial import at_start, mean_life

_SHOWN = 20
_UNITS = {
    **dict.fromkeys(("rate", "rates", "failure_rate", "alpha", "beta", "degradation"), "1/h"),
    **dict.fromkeys(("mttf_ref", "age"), "h"),
    **dict.fromkeys(("t_ref", "t_max"), "degC"),
    "activation_energy": "eV",
}
"""Units of the numbers of ready-made models, as they are kept."""


def counts(system: ReliabilitySystem) -> Mapping[str, int]:
    """Return how many models, states, gates and events there are."""
    states = gates = events = 0
    for component in system.components.values():
        if isinstance(component.content, Chain):
            states += len(component.content.states)
        elif isinstance(component.content, FaultTree):
            gates += len(component.content.gates)
            events += len(component.content.events)
    found = {"models": len(system.components), "states": states, "gates": gates, "events": events}
    return {key: value for key, value in found.items() if value}


def outline(system: ReliabilitySystem) -> list[str]:
    """Return lines with two blanks per level."""
    until = "mission_end, at most " if system.mission_end else ""
    lines = [f"horizon {until}{_time(system.horizon)}"]
    for component in system.components.values():
        mark = " (top)" if component.name == system.top else ""
        lines.append(f"{component.type} {component.name}{mark}")
        lines += [f"  {line}" for line in _content(component)]
    for threshold in system.thresholds:
        on = f", on {threshold.topic}" if threshold.topic else ""
        limits = f"p_fail <= {threshold.activate:g}, gone above {threshold.release:g}"
        limits += f", after {threshold.hold:g} s" if threshold.hold else ""
        lines.append(f"threshold {threshold.id}: {limits}{on}")
    return lines


def _time(hours: float) -> str:
    """Return a time in the largest unit in which it is a whole number, as one would write it."""
    for factor, unit in ((1, "h"), (60, "min"), (3600, "s")):
        if math.isclose(hours * factor, max(1, round(hours * factor)), rel_tol=1e-12):
            return f"{round(hours * factor)} {unit}"
    return f"{hours:g} h"


def _content(component: ComponentModel) -> Iterator[str]:
    content = component.content
    if isinstance(content, Chain):
        if content.age:
            yield f"age {_time(content.age)}"
        for state in content.states:
            marks = [
                m for m, of in (("initial", content.initial), ("fail", content.fail)) if state in of
            ]
            yield state + (f" ({', '.join(marks)})" if marks else "")
            for arc in content.arcs:
                if arc.source == state:
                    yield f"  -> {arc.target}  {arc.rate:g} 1/h"
    elif isinstance(content, FaultTree):
        yield from _tree(content)
    elif component.type == "series":
        yield ", ".join(component.uses)
    else:
        for key, value in component.values.items():
            if value is not None:
                yield f"{key}: {_quantity(key, value)}"


def _quantity(key: str, value: Any) -> str:
    """Return a value of a ready-made model with its unit; equal rates once."""
    if isinstance(value, tuple | list):
        each = [_quantity(key, one) for one in value]
        same = len(set(each)) == 1 and key == "rates"
        return f"{each[0]} for each of {len(each)}" if same else ", ".join(each)
    if isinstance(value, bool):
        return "yes" if value else "no"
    shown = f"{value:g}" if isinstance(value, float) else str(value)
    return f"{shown} {_UNITS[key]}" if key in _UNITS else shown


def _tree(tree: FaultTree) -> Iterator[str]:
    if tree.age:
        yield f"age {tree.age:g} h"
    seen: set[str] = set()
    waiting = [(tree.top, 0)]
    while waiting:
        name, depth = waiting.pop()
        gate = tree.gates.get(name)
        if gate is None:
            yield "  " * depth + f"{name}  {law_text(tree.events[name])}"
            continue
        kind = f"{gate.k}/{len(gate.of)}" if gate.type == "VOTE" else gate.type
        again = name in seen
        yield "  " * depth + f"{kind} {name}" + (" (see above)" if again and gate.of else "")
        seen.add(name)
        if not again:
            waiting += [(below, depth + 1) for below in reversed(gate.of)]


def law_text(event: BasicEvent) -> str:
    """Return the law of an event in few words."""
    law = event.law
    if law is None:
        return "no probability"
    text = {
        "exponential": lambda: f"{law.values[0]:g} 1/h",
        "weibull": lambda: f"Weibull {law.values[0]:g} h, shape {law.values[1]:g}",
        "fixed": lambda: f"p {law.values[0]:g}",
        "model": lambda: f"model {law.model}",
    }[law.kind]()
    if event.age is not None:
        text += f", age {event.age:g} h"
    return f"{text}, observed" if event.observed else text


def readme(system: ReliabilitySystem) -> list[str]:
    """Return numbers at the start of the mission, thresholds and minimal cut sets."""
    start = at_start(system)
    life = mean_life(system)
    shown = "not computed" if life is None else "infinite" if math.isinf(life) else f"{life:.6g} h"
    until = "the mission's end" if system.mission_end else "the horizon"
    probability = f"{start.p_fail:.6g}"
    if start.p_fail_low < start.p_fail_high:  # bounds by cut sets: reliability is the least one
        probability = f"from {start.p_fail_low:.6g} to {start.p_fail_high:.6g}"
        shown = f"at least {shown}" if life is not None else shown
    first = (
        f"`{markdown_code(system.top)}` fails within {system.horizon:g} h ({until}) with "
        f"probability {probability} at mission start, everything in order; mean time to failure: "
        f"{shown}."
    )
    lines = [first, ""]
    if system.thresholds:
        lines += ["| evidence | active at p_fail up to | gone above | hold |", "|---|---|---|---|"]
        lines += [
            f"| {markdown_text(t.id)} | {t.activate:g} | {t.release:g} | {t.hold:g} s |"
            for t in system.thresholds
        ]
        unknown = "its worst case counts" if system.worst_case else "no evidence is active"
        lines += ["", f"While an input is unknown, {unknown}.", ""]
    for name, component in system.components.items():
        if isinstance(component.content, FaultTree):
            lines += _cut_sets(name, component.content)
    lines.append(
        "Assumed: failures of different models and basic events are independent, rates of chains "
        "are constant."
    )
    return lines


def _cut_sets(name: str, tree: FaultTree) -> list[str]:
    sets, shown = cut_sets(name, tree), f"`{markdown_code(name)}`"
    if sets is None:
        reason = "has NOT or XOR, more than 10,000 minimal cut sets, or they take too long to find"
        return [f"{shown} {reason}.", ""]
    lines = [f"Minimal cut sets of {shown}: {len(sets)}", ""]
    lines += [f"- {markdown_text(', '.join(cut_set))}" for cut_set in sets[:_SHOWN]]
    if len(sets) > _SHOWN:
        lines.append(f"- and {len(sets) - _SHOWN} more")
    return [*lines, ""]


def cut_sets(name: str, tree: FaultTree) -> list[list[str]] | None:
    """Return the minimal cut sets of a fault tree, smallest first; None: none, or too many.

    A tree with NOT or XOR has none.
    """
    lowered = lower_tree(name, tree)
    sets = lowered.cut_sets
    if sets is None and lowered.diagram is not None and lowered.diagram.coherent:
        sets = minimal_cut_sets(lowered.diagram)
    if sets is None:
        return None
    names = [sorted(lowered.events[i].name for i in cut_set) for cut_set in sets]
    return sorted(names, key=lambda events: (len(events), events))


_LEGEND = (
    LegendEntry("gate", "or", "gate"),
    LegendEntry("basic event", "ellipse", "input"),
    LegendEntry("state", "rounded", "neutral"),
    LegendEntry("failure", "rounded", "warning"),
    LegendEntry("evidence", "hexagon", "output"),
)
_SHAPES: dict[str, Shape] = {"AND": "and", "PAND": "and", "SAND": "and", "NOT": "not"}


def picture(name: str, system: ReliabilitySystem) -> Diagram:
    """Return what a picture of the chains and trees shows."""
    nodes: list[DiagramNode] = []
    edges: list[DiagramEdge] = []
    for component in system.components.values():
        content = component.content
        if isinstance(content, Chain):
            nodes += _states(component.name, content)
            edges += [
                DiagramEdge(
                    f"{component.name}:{a.source}", f"{component.name}:{a.target}", f"{a.rate:g}/h"
                )
                for a in content.arcs
            ]
        elif isinstance(content, FaultTree):
            nodes += _tree_nodes(component.name, content)
            edges += _tree_edges(system, component.name, content)
        else:
            nodes.append(_box(component))
            edges += [
                DiagramEdge(_top(system, below), component.name)
                for below in component.uses
                if below in system.components  # `check` says what is missing
            ]
    for threshold in system.thresholds:
        lines = (threshold.id, f"p_fail <= {threshold.activate:g}")
        nodes.append(DiagramNode(f"evidence:{threshold.id}", lines, "hexagon", "output"))
        edges.append(DiagramEdge(_top(system, system.top), f"evidence:{threshold.id}"))
    shapes = {(node.shape, node.tone) for node in nodes}
    legend = tuple(one for one in _LEGEND if (one.shape, one.tone) in shapes)
    text = "chains of states and the fault trees that use them"
    return Diagram(f"Reliability {name}", tuple(nodes), tuple(edges), "up", legend, text)


def _top(system: ReliabilitySystem, name: str) -> str:
    """Return the node that represents the failure of a model."""
    content = system.components[name].content
    if isinstance(content, Chain):
        return f"{name}:{content.fail[0]}" if content.fail else name
    return f"{name}:{content.top}" if isinstance(content, FaultTree) else name


def _states(name: str, chain: Chain) -> Iterator[DiagramNode]:
    for state in chain.states:
        tone: Tone = "warning" if state in chain.fail else "neutral"
        marks = ("initial",) if state in chain.initial else ()
        yield DiagramNode(f"{name}:{state}", (state, *marks), "rounded", tone)


def _tree_nodes(name: str, tree: FaultTree) -> Iterator[DiagramNode]:
    for key, gate in tree.gates.items():
        tone: Tone = "warning" if key == tree.top else "gate"
        yield DiagramNode(f"{name}:{key}", (key, _label(gate)), _SHAPES.get(gate.type, "or"), tone)
    for key, event in tree.events.items():
        yield DiagramNode(f"{name}:{key}", (key, law_text(event)), "ellipse", "input")


def _label(gate: Gate) -> str:
    return f"{gate.k}/{len(gate.of)}" if gate.type == "VOTE" else gate.type


def _tree_edges(system: ReliabilitySystem, name: str, tree: FaultTree) -> Iterator[DiagramEdge]:
    for key, gate in tree.gates.items():
        for below in gate.of:
            yield DiagramEdge(f"{name}:{below}", f"{name}:{key}", arrow=False)
    for key, event in tree.events.items():
        if event.law is not None and event.law.model in system.components:
            yield DiagramEdge(_top(system, event.law.model), f"{name}:{key}")


def _box(component: ComponentModel) -> DiagramNode:
    return DiagramNode(component.name, (component.name, component.type), "box", "neutral")
