"""What is wrong with a state machine, or has a meaning that is easily overlooked."""

from __future__ import annotations

from collections.abc import Iterator

from eddi_scaffold.common.graphs import cycles, reached
from eddi_scaffold.common.problems import Place, Problem, problem
from eddi_scaffold.kinds.state_machine.machine import StateMachine, Transition, Trigger
from eddi_scaffold.kinds.state_machine.options import Settings


def check_machine(machine: StateMachine) -> list[Problem]:
    """Return the errors of a machine; without one, what to look at."""
    errors = []
    seen = set[str]()
    for state in machine.states:
        if state.name in seen:
            errors.append(problem("P002.state_twice", state.place, state=state.name))
        seen.add(state.name)
    initial = [state.name for state in machine.states if state.is_initial]
    if not initial:
        errors.append(problem("P002.no_initial", machine.place, machine=machine.name))
    return errors or [*_states(machine, initial), *_transitions(machine), *_circles(machine)]


def _states(machine: StateMachine, initial: list[str]) -> Iterator[Problem]:
    if len(initial) > 1:
        yield problem("P004.several_initial", machine.place, states=", ".join(initial))
    following = {
        name: [each.target for each in leaving if each.triggers or each.after is not None]
        for name, leaving in machine.leaving.items()
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
            first = same.setdefault((each.priority, each.target in machine.fail), each)
            is_shadowed = all(trigger in taken for trigger in each.triggers)
            first = taken[each.triggers[0]] if is_shadowed else first
            fields = {"first": machine.called[first], "second": machine.called[each]}
            if is_shadowed:
                yield problem("P004.shadowed", each.place, **fields)
            elif first.target != each.target:
                yield problem("P004.which_first", each.place, state=name, **fields)
            for trigger in each.triggers if each.after is None else ():
                taken.setdefault(trigger, each)


def _levels(machine: StateMachine, transition: Transition) -> list[Trigger]:
    """Return the triggers of a transition that count as long as they are true."""
    raised = machine.raised - machine.causes.keys()
    once = {t for t in transition.triggers if t.is_external or t.text in raised}
    return [t for t in transition.triggers if t.is_persistent or t not in once]


def _circles(machine: StateMachine) -> Iterator[Problem]:
    hops = {
        (each.target, each.source): each
        for each in machine.transitions
        if each.source != each.target and each.after is None and _levels(machine, each)
    }
    graph: dict[str, list[str]] = {name: [] for name in machine.state}
    for target, source in hops:
        graph[target].append(source)
    for circle in cycles(graph):
        taken = [hops[pair] for pair in zip([*circle[1:], circle[0]], circle, strict=True)]
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
