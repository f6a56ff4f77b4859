"""Text and picture of a state machine."""

from __future__ import annotations

from collections.abc import Iterator

from eddi_scaffold.common.escaping import markdown_text
from eddi_scaffold.diagrams import Diagram, DiagramEdge, DiagramNode, LegendEntry, Tone
from eddi_scaffold.kinds.state_machine.machine import StateMachine, Transition
from eddi_scaffold.kinds.state_machine.options import Settings

_LEGEND = (
    LegendEntry("state", "rounded", "neutral"),
    LegendEntry("initial state", "rounded", "input"),
    LegendEntry("fail state", "rounded", "warning"),
)


def outline(machine: StateMachine, settings: Settings) -> Iterator[str]:
    """Yield the states with their transitions, what the triggers are, and what is claimed."""
    for state in machine.states:
        marks = ", ".join(["initial"] * state.is_initial + ["fail"] * state.is_fail)
        yield f"{state.name} ({marks})" if marks else state.name
        yield from (
            f"  {moment}: {action.kind} {action.text}" for moment, action in state.actions()
        )
        for each in machine.leaving[state.name]:
            yield f"  -> {each.target}: {_condition(each)}"
    for trigger, value in zip(machine.triggers, settings.values, strict=True):
        words = [value.how, *(["persistent"] if trigger.is_persistent else [])]
        words += ["unknown counts as false"] if value.is_absent else []
        yield f"trigger {trigger.text}: {', '.join(filter(None, words))}"
    yield f"start {settings.start}"
    for evidence in settings.evidence:
        yield f"evidence {evidence.id}: {evidence.text}"


def _condition(transition: Transition) -> str:
    texts = " or ".join(trigger.text for trigger in transition.triggers)
    after = "" if transition.after is None else f"after {transition.after:g} s"
    return f"{texts}, {after}" if texts and after else texts or after or "never"


def readme(machine: StateMachine, settings: Settings) -> list[str]:
    """Return the transitions in the order in which they count, and what is claimed."""
    ordered = [each for state in machine.state for each in machine.leaving[state]]
    rows = [(each.source, each.target, _condition(each)) for each in ordered]
    claims = [(evidence.id, evidence.text) for evidence in settings.evidence]
    lines = _table(("from", "to", "when"), *rows)
    heads = ("evidence", "active while each possible state is")
    return [*lines, "", *_table(heads, *claims)] if claims else lines


def _table(*rows: tuple[str, ...]) -> list[str]:
    lines = [f"| {' | '.join(map(markdown_text, row))} |" for row in rows]
    return [lines[0], "|---" * len(rows[0]) + "|", *lines[1:]]


def picture(machine: StateMachine) -> Diagram:
    """Return what a picture shows."""
    nodes = []
    for state in machine.states:
        tone: Tone = "warning" if state.is_fail else "input" if state.is_initial else "neutral"
        actions = [f"{moment}: {action.text}" for moment, action in state.actions()]
        nodes.append(DiagramNode(state.name, (state.name, *actions), "rounded", tone))
    edges = [DiagramEdge(t.source, t.target, _condition(t)) for t in machine.transitions]
    tones = {node.tone for node in nodes}
    legend = tuple(entry for entry in _LEGEND if entry.tone in tones)
    text = f"{len(nodes)} states, {len(edges)} transitions"
    title = f"State machine {machine.name}"
    return Diagram(title, tuple(nodes), tuple(edges), "down", legend, text)
