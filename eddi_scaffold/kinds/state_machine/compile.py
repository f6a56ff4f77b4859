"""State machines compiled: tables of states and transitions, a step that gives the triggers."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import PurePath
from typing import Any

from eddi_runtime.state_machine import machine as runtime

from eddi_scaffold.common.escaping import python_comment
from eddi_scaffold.common.identifiers import free_name
from eddi_scaffold.kinds import EditableMethod, EditableModule
from eddi_scaffold.kinds.state_machine.machine import Action, StateMachine
from eddi_scaffold.kinds.state_machine.options import Settings, Value, input_id
from eddi_scaffold.program import python_text as py
from eddi_scaffold.program.condition_step import ConditionStep
from eddi_scaffold.program.instructions import Program, joined
from eddi_scaffold.program.monitor_text import CompiledMonitor, Declaration, head_lines

FORMAT = 1


def methods_of(machine: StateMachine) -> dict[str, str]:
    """Return text of a function action -> name of the method that performs it."""
    names: dict[str, str] = {}
    for action in machine.actions():
        if action.kind == "function" and action.text not in names:
            names[action.text] = free_name(f"action_{input_id(action.text)}", names.values())
    return names


def actions_module(machine: StateMachine) -> Sequence[EditableModule]:
    """Return the module with a method for each function; none where there is no function."""
    methods = tuple(
        EditableMethod(name, text, ("pass",), ("call",), comments=(python_comment(text),))
        for text, name in methods_of(machine).items()
    )
    docstring = "What is done when the state machine enters and leaves its states."
    about = "Each is called once, when it is certain to be due, after the result was published."
    return [EditableModule("actions.py", docstring, "Actions", about, methods)] if methods else []


def compile_machine(
    machine: StateMachine, settings: Settings, declaration: Declaration
) -> CompiledMonitor:
    """Compile a configured machine."""
    values = [*settings.values, *(Value(condition) for condition in settings.observe.values())]
    values += [settings.reset] if settings.reset is not None else []
    conditions = [value.condition for value in values if value.condition is not None]
    empty = Program(round(1e9 / settings.rate), (), (), ())
    units = {input_.id: input_.unit for input_ in settings.inputs if input_.unit}
    program = joined(conditions) if conditions else empty
    step = ConditionStep(program, declaration.inputs, units, "actions")
    numbers = {input_.id: (k,) for k, input_ in enumerate(declaration.inputs)}
    needs = iter(step.needs())
    needed = [next(needs) if v.condition is not None else numbers.get(v.input, ()) for v in values]
    messages = [bool(value.input) for value in values]
    triggers = [
        runtime.Trigger(
            trigger.text,
            needed[k],
            momentary=trigger.is_external or value.is_raised,
            raised=value.is_raised,
            messages=messages[k],
            persistent=trigger.is_persistent,
            absent=value.is_absent,
        )
        for k, (trigger, value) in enumerate(zip(machine.triggers, settings.values, strict=True))
    ]
    states = {state.name: k for k, state in enumerate(machine.states)}
    observe = [
        py.tuple_of([str(states[state]), _printed(runtime.Trigger(state, needs))])
        for state, needs in zip(settings.observe, needed[len(triggers) :], strict=False)
    ]
    evidence = [
        runtime.Evidence(of.id, tuple(states[name] for name in of.states), _ns(of.hold))
        for of in settings.evidence
    ]
    gap = max(1.0, 2.5 / settings.rate) if settings.max_gap is None else settings.max_gap
    lines = [
        *head_lines("state_machine.StateMachineMonitor", declaration, {}),
        *step.tables(),
        *_states(machine, {of.text: k for k, of in enumerate(triggers) if of.raised}),
        *_assigned("triggers", triggers),
        *_assigned("transitions", _transitions(machine, states)),
        *_assigned("evidence", evidence),
        *(py.assignment("observe", py.tuple_of(observe), 4) if observe else ()),
    ]
    if settings.reset is not None:
        reset = runtime.Trigger("reset", needed[-1], messages=messages[-1])
        lines += py.assignment("reset_by", _printed(reset), 4)
    lines += [f'    start = "{settings.start}"', f"    max_gap = {_ns(gap)}"]
    return CompiledMonitor(FORMAT, [*lines, *step.methods()])


def _states(machine: StateMachine, raised: Mapping[str, int]) -> list[str]:
    """Return the lines of the actions, each as often as it occurs, and of the states."""
    methods, actions = methods_of(machine), list[runtime.Action]()

    def numbered(of: Sequence[Action]) -> tuple[int, ...]:
        first = len(actions)
        for action in of:
            target, is_call, _ = action.text.partition("=")
            is_function = action.kind == "function"
            actions.append(
                runtime.Action(
                    action.kind,
                    action.text,
                    (target if is_call else "") if is_function else action.source,
                    action.priority,
                    raised.get(action.text, -1) if action.is_event else -1,
                    methods[action.text] if is_function else "",
                )
            )
        return tuple(range(first, len(actions)))

    states = [
        runtime.State(of.name, of.is_initial, of.is_fail, numbered(of.entry), numbered(of.exit))
        for of in machine.states
    ]
    return [*_assigned("actions", actions), *_assigned("states", states)]


def _transitions(machine: StateMachine, states: Mapping[str, int]) -> list[runtime.Transition]:
    numbers = {trigger: k for k, trigger in enumerate(machine.triggers)}
    return [
        runtime.Transition(
            each.name,
            states[each.source],
            states[each.target],
            tuple(numbers[trigger] for trigger in each.triggers),
            None if each.after is None else _ns(each.after),
            f"{PurePath(each.place.file or '').name}:{each.place.line}",
        )
        for state in machine.states
        for each in machine.leaving[state.name]
    ]


def _assigned(name: str, rows: Sequence[Any]) -> list[str]:
    return py.assignment(name, py.tuple_of(map(_printed, rows)), 4)


def _printed(row: Any) -> py.Part:
    """Return a declaration of the runtime without the fields that have their default."""
    usual, given = row._field_defaults, row._asdict()
    first = [py.literal(value) for key, value in given.items() if key not in usual]
    chosen = {key: of for key, of in given.items() if key in usual and of != usual[key]}
    more = {key: py.literal(value) for key, value in chosen.items()}
    return py.call(f"state_machine.{type(row).__name__}", first, **more)


def _ns(seconds: float) -> int:
    return round(seconds * 1e9)
