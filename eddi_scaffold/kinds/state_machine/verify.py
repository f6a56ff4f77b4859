"""Whether the tables of a generated state machine are those of its model."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from pathlib import PurePath
from typing import TYPE_CHECKING, Any

from eddi_scaffold.common.identifiers import attribute, free_name
from eddi_scaffold.evidence.conditions import joined, needs_of, of_inputs
from eddi_scaffold.evidence.emitted import Call, Emitted

if TYPE_CHECKING:
    from eddi_scaffold.kinds.state_machine.machine import Action, StateMachine
    from eddi_scaffold.kinds.state_machine.options import Settings


def verify(machine: StateMachine, settings: Settings, emitted: Emitted) -> Iterator[str]:
    """Compare a text with a machine; yield what is proved."""
    monitor = emitted.monitor("state_machine.StateMachineMonitor")
    number = {state.name: k for k, state in enumerate(machine.states)}
    raised = {t.text: k for k, t in enumerate(machine.triggers) if settings.values[k].is_raised}
    reset = settings.reset
    values = [(of.input, of.condition) for of in settings.values]
    values += [("", condition) for condition in settings.observe.values()]
    values += [(reset.input, reset.condition)] if reset else []
    program = joined([condition for _, condition in values if condition])
    place = {input_.id: k for k, input_ in enumerate(emitted.declared.inputs)}
    of_conditions = iter(needs_of(program, emitted.declared.inputs))
    needs = [
        next(of_conditions) if condition else (place[input_],) if input_ else ()
        for input_, condition in values
    ]
    triggers = [
        _row(
            "Trigger",
            trigger.text,
            needs=needs[k],
            momentary=trigger.is_external or value.is_raised,
            raised=value.is_raised,
            messages=value.input != "",
            persistent=trigger.is_persistent,
            absent=value.is_absent,
        )
        for k, (trigger, value) in enumerate(zip(machine.triggers, settings.values, strict=True))
    ]
    transitions = [
        _row(
            "Transition",
            each.name,
            number[each.source],
            number[each.target],
            triggers=tuple(map(machine.triggers.index, each.triggers)),
            after=None if each.after is None else round(each.after * 1e9),
            place=f"{PurePath(each.place.file or '').name}:{each.place.line}",
        )
        for state in machine.states
        for each in machine.leaving[state.name]
    ]
    gap = max(1.0, 2.5 / settings.rate) if settings.max_gap is None else settings.max_gap
    actions: list[Call] = []
    methods: dict[str, str] = {}

    def numbered(row: Sequence[Action]) -> tuple[int, ...]:
        """Add actions, each as often as it occurs; return their numbers."""
        for of in row:
            target, is_call, _ = of.text.partition("=")
            given: dict[str, Any] = {"target": of.source, "priority": of.priority or None}
            if of.kind == "function":
                id_ = attribute(re.sub(r"[^A-Za-z0-9]+", "_", of.text).strip("_"))
                if of.text not in methods:
                    methods[of.text] = free_name(f"action_{id_}", methods.values())
                given |= {"target": target if is_call else "", "method": methods[of.text]}
            given |= {"raises": raised.get(of.text)} if of.is_event else {}
            actions.append(_row("Action", of.kind, of.text, **given))
        return tuple(range(len(actions) - len(row), len(actions)))

    states = [
        _row(
            "State",
            of.name,
            initial=of.is_initial,
            fail=of.is_fail,
            entry=numbered(of.entry),
            exit=numbered(of.exit),
        )
        for of in machine.states
    ]
    observe = [
        (number[state], _row("Trigger", state, needs=needs[len(triggers) + k]))
        for k, state in enumerate(settings.observe)
    ]
    evidence = [
        _row(
            "Evidence", of.id, tuple(map(number.get, of.states)), hold=round(of.hold * 1e9) or None
        )
        for of in settings.evidence
    ]
    expected = {
        "actions": tuple(actions),
        "states": tuple(states),
        "triggers": tuple(triggers),
        "transitions": tuple(transitions),
        "evidence": tuple(evidence),
        "observe": tuple(observe) or None,
        "reset_by": reset and _row("Trigger", "reset", needs=needs[-1], messages=reset.input != ""),
        "start": settings.start,
        "max_gap": round(gap * 1e9),
    }
    for name, value in expected.items():
        emitted.attribute(monitor, name, value)
    units = {input_.id: input_.unit for input_ in settings.inputs if input_.unit}
    of_inputs(emitted, monitor, program, units, "actions")
    emitted.end(monitor)
    numbers = {"states": states, "transitions": transitions, "triggers": triggers}
    counted = ", ".join(f"{len(of)} {what}" for what, of in numbers.items())
    yield f"{counted} with their conditions, actions, evidence"


def _row(name: str, *first: object, **more: object) -> Call:
    """Return a declaration of the runtime without the fields that have their default."""
    given = {k: of for k, of in more.items() if of is not False and of not in ((), "", None)}
    return Call(f"state_machine.{name}", first, given)
