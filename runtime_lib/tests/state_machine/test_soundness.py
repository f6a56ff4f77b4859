"""A hidden run seen through UNKNOWNs, gaps, observations: what is claimed was true in it."""

from __future__ import annotations

from collections import Counter
from random import Random

from eddi_runtime.state_machine import (
    Action,
    Evidence,
    State,
    StateMachine,
    Transition,
    Trigger,
)
from eddi_runtime.state_machine.engine import Engine
from hypothesis import given
from hypothesis import strategies as st

SECOND = 10**9


class Livelock(Exception):  # noqa: N818 - the end of a run
    pass


class Run:
    """One system of which everything is known; numbers of states, seconds."""

    def __init__(self, machine, state, entered, latched):
        self.machine, self.state, self.entered, self.latched = machine, state, entered, latched
        self.raised, self.performed = set(), Counter()

    def step(self, t, truths, reset):
        machine = self.machine
        values = [k in self.raised if one.raised else truths[k] for k, one in pairs(machine)]
        for k, one in pairs(machine):
            if one.persistent:
                self.latched[k] = values[k] or (self.latched[k] and not reset)
                values[k] = self.latched[k]
        self.raised = set()
        if reset:
            self.enter(next(k for k, one in enumerate(machine.states) if one.initial), t)
        passed = [self.state]
        while True:
            taken = self.taken(t, values, is_first=len(passed) == 1)
            if taken is None:
                return
            before, after = machine.states[taken.source], machine.states[taken.target]
            rows = [(before.id, "exit", k) for k in before.exit]
            for row in [*rows, *((after.id, "entry", k) for k in after.entry)]:
                self.performed[row] += 1
            self.enter(taken.target, t)
            if taken.target == taken.source:
                return
            if taken.target in passed:
                raise Livelock
            passed.append(taken.target)

    def enter(self, state, t):
        self.state, self.entered = state, t

    def taken(self, t, values, *, is_first):
        for one in self.machine.transitions:
            triggers = [(k, self.machine.triggers[k]) for k in one.triggers]
            counts = [
                values[k] and (is_first or of.persistent or not (of.momentary or of.raised))
                for k, of in triggers
            ]
            over = one.after is not None and (t - self.entered) * SECOND >= one.after
            fires = any(counts) if one.after is None else over and (any(counts) or not triggers)
            if one.source == self.state and fires:
                return one
        return None


def pairs(machine):
    return enumerate(machine.triggers)


def some_machine(random):
    made, count = StateMachine(), random.randint(2, 5)
    triggers = [Trigger("raised", raised=True)]
    for name in "abcd"[: random.randint(1, 4)]:
        kind = random.choice(["level", "level", "momentary", "persistent"])
        triggers.append(Trigger(name, **({} if kind == "level" else {kind: True})))
    made.triggers = tuple(triggers)
    made.actions = tuple(
        Action("warning", f"w{k}", raises=0)
        if random.random() < 0.2
        else Action("function", f"{k}")
        for k in range(2 * count)
    )
    states = []
    for k in range(count):
        sides = [tuple(n for n in (2 * k, 2 * k + 1) if random.random() < 0.4) for _ in "ab"]
        states.append(State(f"s{k}", k == 0, random.random() < 0.4, *sides))
    made.states = tuple(states)
    transitions = []
    for _ in range(random.randint(1, 8)):
        fired = tuple(
            random.sample(range(len(triggers)), random.choice([0, 1, 1, min(2, len(triggers))]))
        )
        after = random.choice([1, 2, 4]) * SECOND if not fired or random.random() < 0.2 else None
        ends = random.randrange(count), random.randrange(count)
        transitions.append(Transition("", *ends, fired, after))
    made.transitions = tuple(transitions)
    inside = [tuple(k for k in range(count) if random.random() < 0.5) for _ in "ab"]
    made.evidence = (Evidence("now", inside[0]), Evidence("held", inside[1], 2 * SECOND))
    made.start = random.choice(["initial", "unknown"])
    made.max_gap = 5 * SECOND // 2
    return made


def check(machine, engine, output, run, t, inside_since):
    name = machine.states[run.state].id
    assert name in output.possible
    fail = machine.states[run.state].fail
    assert output.failed in (1, 2 if fail else 0)
    assert all(v in (1, 2 if s == name else 0) for s, v in output.in_state.items())
    if output.state:
        assert run.entered * SECOND <= engine.since
    for one in machine.evidence:
        inside = run.state in one.states
        inside_since[one.id] = inside_since.get(one.id, t) if inside else t + 1
        if output.evidence[one.id]:
            assert (t - inside_since[one.id]) * SECOND >= one.hold


@given(st.integers(0, 2**32))
def test_what_is_claimed_was_true(seed):
    random = Random(seed)
    machine, t, inside_since = some_machine(random), 0, {}
    engine, told = Engine(machine), Counter()
    latched = {k: False for k, one in pairs(machine) if one.persistent}
    run = Run(machine, 0, 0, latched)
    if machine.start == "unknown":
        run = Run(machine, random.randrange(len(machine.states)), -random.randint(0, 9), latched)
        latched.update((k, random.random() < 0.5) for k in latched)
    try:
        for _ in range(random.randint(1, 8)):
            for _ in range(random.choice([0, 0, 0, 3]) if t else 0):  # steps that are missed
                run.step(t, [random.random() < 0.3 for _ in machine.triggers], False)
                note_inside(machine, run, t, inside_since)
                t += 1
            truths = [random.random() < 0.4 for _ in machine.triggers]
            reset = random.random() < 0.1
            run.step(t, truths, reset)
            seen = [1 if random.random() < 0.3 else 2 * one for one in truths]
            state = random.randrange(len(machine.states))
            observed = {state: 2 if state == run.state else random.choice([0, 0, 1, 2])}
            observed = observed if random.random() < 0.2 else {}
            given_reset = 1 if random.random() < 0.1 else 2 * reset
            output = engine.step(t * SECOND, seen, given_reset, observed)
            check(machine, engine, output, run, t, inside_since)
            for one in output.raised:
                told[one.state, one.moment, one.text] += one.certain
                if one.certain and one.kind == "warning":
                    run.raised.add(0)  # the monitor gives it, and the next step hears it
            texts = Counter()
            for (name, moment, k), count in run.performed.items():
                texts[name, moment, machine.actions[k].text] += count
            assert not told - texts
            t += 1
    except Livelock:
        return


def note_inside(machine, run, t, inside_since):
    for one in machine.evidence:
        if run.state not in one.states:
            inside_since[one.id] = t + 1
