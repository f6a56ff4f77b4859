"""What is wrong with a state machine, or has a meaning that is easily overlooked."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator

from eddi_scaffold.common.graphs import cycles, reached
from eddi_scaffold.common.problems import Place, Problem, problem
from eddi_scaffold.kinds.state_machine.machine import StateMachine, Transition, Trigger
from eddi_scaffold.kinds.state_machine.options import Settings


def check_machine(machine: StateMachine) -> list[Problem]:
    """Return the errors of a machine; without one, what to look at."""
    errors = []
    for name, number in Counter(state.name for state in machine.states).items():
        if number > 1:
            place = [state.place for state in machine.states if state.name == name][1]
            errors.append(problem("P002.state_twice", place, state=name))
    initial = [state.name for state in machine.states if state.is_initial]
    if not initial:
        errors.append(problem("P002.no_initial", machine.place, machine=machine.name))
    return errors or [*_states(machine, initial), *_transitions(machine), *_circles(machine)]


def _states(machine: StateMachine, initial: list[str]) -> Iterator[Problem]:
    if len(initial) > 1:
        yield problem("P004.several_initial", machine.place, states=", ".join(initial))
    taken = [each for each in machine.transitions if each.triggers or each.after is not None]
    following = {
        name: [each.target for each in taken if each.source == name] for name in machine.state
    }
    can_be = reached(following, initial)
    if not can_be.intersection(machine.fail):
        case = "P004.fail_unreached" if machine.fail else "P004.no_fail"
        yield problem(case, machine.place, machine=machine.name)
    for state in machine.states:
        if state.name not in can_be:
            yield problem("P004.unreached", state.place, state=state.name)
        if state.is_fail and following[state.name]:
            yield problem("P004.fail_left", state.place, state=state.name)
        elif not state.is_fail and not following[state.name]:
            yield problem("P004.dead_end", state.place, state=state.name)
    for action in machine.actions():
        if action.kind == "function" and action.text.count("=") > 1:
            yield problem("P004.function", action.place, text=action.text)


def _transitions(machine: StateMachine) -> Iterator[Problem]:
    for each in machine.transitions:
        name = machine.called[each]
        if not each.triggers and each.after is None:
            yield problem("P004.never", each.place, transition=name)
        elif each.source == each.target and each.after is None and _levels(machine, each):
            yield problem("P004.itself", each.place, transition=name)
    for name, leaving in machine.leaving.items():
        taken: dict[Trigger, Transition] = {}  # what takes another transition before
        same: dict[tuple[int, bool], Transition] = {}  # rank -> the first transition of it
        for each in (each for each in leaving if each.triggers):
            rank = each.priority, each.target in machine.fail
            first, second = same.setdefault(rank, each), machine.called[each]
            if all(trigger in taken for trigger in each.triggers):
                first = taken[each.triggers[0]]
                fields = {"first": machine.called[first], "second": second}
                yield problem("P004.shadowed", each.place, **fields)
            elif first.target != each.target:
                fields = {"first": machine.called[first], "second": second}
                yield problem("P004.which_first", each.place, state=name, **fields)
            for trigger in each.triggers if each.after is None else ():
                taken.setdefault(trigger, each)


def _levels(machine: StateMachine, transition: Transition) -> list[Trigger]:
    """Return the triggers of a transition that count as long as they are true."""
    raised = machine.raised - machine.causes.keys()
    return [
        trigger
        for trigger in transition.triggers
        if trigger.is_persistent or not (trigger.is_external or trigger.text in raised)
    ]


def _circles(machine: StateMachine) -> Iterator[Problem]:
    hops = {
        (each.source, each.target): each
        for each in machine.transitions
        if each.source != each.target and each.after is None and _levels(machine, each)
    }
    graph = {name: [a for a, b in hops if b == name] for name in machine.state}
    for circle in cycles(graph):
        taken = [hops[pair] for pair in zip(circle, [*circle[1:], circle[0]], strict=True)]
        same = frozenset.intersection(*(frozenset(_levels(machine, each)) for each in taken))
        shown = " -> ".join([*circle, circle[0]])
        case = "P004.livelock" if same else "P004.circle"
        yield problem(case, taken[0].place, circle=shown)


def check_settings(machine: StateMachine, settings: Settings, place: Place) -> Iterator[Problem]:
    """Yield what a configuration makes of a machine that is easily overlooked."""
    if settings.reset is None and not settings.observe:
        yield problem("P004.no_return", place)
    for evidence in settings.evidence:
        if len(evidence.states) in (0, len(machine.states)):
            states = "every state" if evidence.states else "no state"
            yield problem("P004.constant", evidence.place, evidence=evidence.id, states=states)
