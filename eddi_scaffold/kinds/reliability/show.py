"""Text description of a system, for ``show`` and for a package's README; its picture."""

from __future__ import annotations

import math
from collections.abc import Iterator
from types import SimpleNamespace
from typing import Any

from eddi_runtime.reliability import Reliability, ReliabilityResult

from eddi_scaffold.common.escaping import markdown_code, markdown_text
from eddi_scaffold.diagrams import Diagram, DiagramEdge, DiagramNode, LegendEntry, Shape, Tone
from eddi_scaffold.kinds.reliability.compile import compile_system
from eddi_scaffold.kinds.reliability.lowering import lower_tree
from eddi_scaffold.kinds.reliability.system import (
    NAME,
    UNITS,
    BasicEvent,
    Chain,
    ComponentModel,
    FaultTree,
    Gate,
    ReliabilitySystem,
)
from eddi_scaffold.program.input_expressions import BoundInput
from eddi_scaffold.program.monitor_text import Declaration, module_text
from eddi_scaffold.program.running import module_of

_MOST_CUT_SETS = 20


def outline(system: ReliabilitySystem) -> list[str]:
    """Return lines with two blanks per level."""
    until = "mission_end, at most " if system.mission_end else ""
    lines = [f"horizon {until}{_time(system.horizon)}"]
    for component in system.components.values():
        mark = " (top)" if component.name == system.top else ""
        lines.append(f"{component.type} {component.name}{mark}")
        lines += [f"  {line}" for line in _content(component)]
    for threshold in system.thresholds:
        limits = f"p_fail <= {threshold.activate:g}, gone above {threshold.release:g}"
        limits += f", after {threshold.hold:g} s" if threshold.hold else ""
        topic = f", on {threshold.topic}" if threshold.topic else ""
        lines.append(f"threshold {threshold.id}: {limits}{topic}")
    return lines


def _time(hours: float) -> str:
    """Return a time in the largest unit in which it is a whole number, as one would write it."""
    for factor, unit in ((1, "h"), (60, "min"), (3600, "s")):
        if math.isclose(hours * factor, max(1, round(hours * factor)), rel_tol=1e-12):
            return f"{round(hours * factor)} {unit}"
    return f"{hours:g} h"


def _content(component: ComponentModel) -> Iterator[str]:
    content = component.content
    if isinstance(content, FaultTree):
        if content.age:
            yield f"age {content.age:g} h"
        seen: set[str] = set()
        waiting = [(content.top, "")]
        while waiting:
            name, indent = waiting.pop()
            gate = content.gates.get(name)
            if gate is None:
                yield f"{indent}{name}  {law_text(content.events[name])}"
                continue
            is_again = name in seen
            yield f"{indent}{_kind(gate)} {name}{' (see above)' * (is_again and bool(gate.of))}"
            seen.add(name)
            waiting += [] if is_again else [(of, f"{indent}  ") for of in reversed(gate.of)]
    elif isinstance(content, Chain):
        if content.age:
            yield f"age {_time(content.age)}"
        for state in content.states:
            groups = {"initial": content.initial, "fail": content.fail}
            marks = ", ".join(mark for mark, states in groups.items() if state in states)
            yield f"{state} ({marks})" if marks else state
            for arc in content.arcs:
                if arc.source == state:
                    yield f"  -> {arc.target}  {arc.rate:g} 1/h"
    elif component.type == "series":
        yield ", ".join(component.uses)
    else:
        for key, value in component.values.items():
            if value is not None:
                yield f"{key}: {_quantity(key, value)}"


def _quantity(key: str, value: Any) -> str:
    if isinstance(value, tuple | list):
        each = [_quantity(key, item) for item in value]
        is_same = len(set(each)) == 1 and key == "rates"
        return f"{each[0]} for each of {len(each)}" if is_same else ", ".join(each)
    if isinstance(value, bool):
        return "yes" if value else "no"
    shown = f"{value:g}" if isinstance(value, float) else str(value)
    return f"{shown} {UNITS.get(key, '')}".rstrip()


def _kind(gate: Gate) -> str:
    return f"{gate.k}/{len(gate.of)}" if gate.type == "VOTE" else gate.type


def law_text(event: BasicEvent) -> str:
    """Return the law of an event in few words."""
    law = event.law
    if law is None:
        return "no probability"
    form = {
        "exponential": "{0:g} 1/h",
        "weibull": "Weibull {0:g} h, shape {1:g}",
        "fixed": "p {0:g}",
        "model": "model {model}",
    }[law.kind]
    age = "" if event.age is None else f", age {event.age:g} h"
    return form.format(*law.values, model=law.model) + age + (", observed" * event.observed)


def at_start(system: ReliabilitySystem, *, known: bool = True) -> ReliabilityResult:
    """Return the first result of a robot with everything in order, or nothing known."""
    inputs = system.without_unused().inputs()
    declaration = Declaration("m", "", tuple(BoundInput(i.id, i.id) for i in inputs))
    text = module_text(NAME, compile_system(system, declaration), declaration.model_id)
    monitor: Reliability = module_of(text, declaration.model_id).Monitor()
    values: dict[str, Any] = {input_.id: input_.sample for input_ in inputs} if known else {}
    return monitor.execute_step(SimpleNamespace(**values), 0)


def readme(system: ReliabilitySystem) -> list[str]:
    """Return numbers at the start of the mission, thresholds and minimal cut sets."""
    start = at_start(system)
    until = "the mission's end" if system.mission_end else "the horizon"
    probability = f"{start.p_fail:.6g}"
    if start.p_fail_low < start.p_fail_high:  # bounds by cut sets
        probability = f"from {start.p_fail_low:.6g} to {start.p_fail_high:.6g}"
    numbers = (
        f"`{markdown_code(system.top)}` fails within {system.horizon:g} h ({until}) with "
        f"probability {probability} at mission start, everything in order"
    )
    if not math.isnan(life := start.mttf):
        shown = "infinite" if math.isinf(life) else f"{life:.6g} h"
        numbers += f"; mean time to failure: {shown}"
    lines = [f"{numbers}.", ""]
    if system.thresholds:
        unknown = "its worst case counts" if system.worst_case else "no evidence is active"
        lines += ["| evidence | active at p_fail up to | gone above | hold |", "|---|---|---|---|"]
        lines += [
            f"| {markdown_text(t.id)} | {t.activate:g} | {t.release:g} | {t.hold:g} s |"
            for t in system.thresholds
        ]
        lines += ["", f"While an input is unknown, {unknown}.", ""]
    for name, component in system.components.items():
        if isinstance(component.content, FaultTree):
            sets, shown = cut_sets(name, component.content), f"`{markdown_code(name)}`"
            if sets is None:
                reason = "has NOT or XOR, more than 10,000 minimal cut sets"
                lines += [f"{shown} {reason}, or they take too long to find.", ""]
                continue
            lines += [f"Minimal cut sets of {shown}: {len(sets)}", ""]
            lines += [f"- {markdown_text(', '.join(names))}" for names in sets[:_MOST_CUT_SETS]]
            more = len(sets) - _MOST_CUT_SETS
            lines += [*([f"- and {more} more"] if more > 0 else []), ""]
    lines.append(
        "Assumed: failures of different models and basic events are independent, rates of chains "
        "are constant."
    )
    return lines


def cut_sets(name: str, tree: FaultTree) -> list[list[str]] | None:
    """Return the minimal cut sets, smallest first; None: NOT or XOR, or too many."""
    lowered = lower_tree(name, tree)
    if lowered.cut_sets is None:
        return None
    names = [sorted(lowered.events[i].name for i in cut_set) for cut_set in lowered.cut_sets]
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
        part, content = component.name, component.content
        if isinstance(content, Chain):
            for state in content.states:
                tone: Tone = "warning" if state in content.fail else "neutral"
                marks = ("initial",) if state in content.initial else ()
                nodes.append(DiagramNode(f"{part}:{state}", (state, *marks), "rounded", tone))
            for a in content.arcs:
                rate = f"{a.rate:g}/h"
                edges.append(DiagramEdge(f"{part}:{a.source}", f"{part}:{a.target}", rate))
        elif isinstance(content, FaultTree):
            for key, gate in content.gates.items():
                tone = "warning" if key == content.top else "gate"
                shape = _SHAPES.get(gate.type, "or")
                nodes.append(DiagramNode(f"{part}:{key}", (key, _kind(gate)), shape, tone))
                ends = [(f"{part}:{below}", f"{part}:{key}") for below in gate.of]
                edges += [DiagramEdge(*end, arrow=False) for end in ends]
            for key, event in content.events.items():
                lines = (key, law_text(event))
                nodes.append(DiagramNode(f"{part}:{key}", lines, "ellipse", "input"))
                model = event.law.model if event.law else ""
                if model in system.components:  # `check` says what is missing
                    edges.append(DiagramEdge(_top(system, model), f"{part}:{key}"))
        else:
            nodes.append(DiagramNode(part, (part, component.type), "box", "neutral"))
            models = [model for model in component.uses if model in system.components]
            edges += [DiagramEdge(_top(system, model), part) for model in models]
    for threshold in system.thresholds:
        lines = (threshold.id, f"p_fail <= {threshold.activate:g}")
        nodes.append(DiagramNode(f"evidence:{threshold.id}", lines, "hexagon", "output"))
        edges.append(DiagramEdge(_top(system, system.top), f"evidence:{threshold.id}"))
    shapes = {(node.shape, node.tone) for node in nodes}
    legend = tuple(entry for entry in _LEGEND if (entry.shape, entry.tone) in shapes)
    text = "chains of states and the fault trees that use them"
    return Diagram(f"Reliability {name}", tuple(nodes), tuple(edges), "up", legend, text)


def _top(system: ReliabilitySystem, name: str) -> str:
    content = system.components[name].content
    if isinstance(content, Chain):
        return f"{name}:{content.fail[0]}" if content.fail else name
    return f"{name}:{content.top}" if isinstance(content, FaultTree) else name
