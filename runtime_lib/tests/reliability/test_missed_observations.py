"""What was missed for some steps counts later: a result bounds every completion of it.

A completion gives a value to each input that was unknown. The reference is the monitor itself with
all inputs known, so nothing is asked of the mechanism that bounds them.
"""

import itertools
import random

import numpy as np
import pytest

from eddi_scaffold.kinds.reliability.fault_tree import Gate
from runtime_lib.tests.reliability.reliability_models import chain, event, monitor, series, tree
from runtime_lib.tests.reliability.test_reliability_monitor import step
from runtime_lib.tests.reliability.test_unknown_inputs import KINDS, LEVELS, PARTS

QUANTUM = 360.0
GOAL, LONG_GOAL = 1_000, 50_000
MOST = 16
TRUTHS = (True, False)
SLACK = 1.0 + 1e-9
LAST, FIXED = event("model", model="chain"), event("fixed", 0.3)
TOPS = {
    "alone": [],
    "NOT": [tree([LAST], [Gate("NOT", (0,))])],
    "XOR": [tree([LAST, FIXED], [Gate("XOR", (0, 1))])],
    "2 of 3": [
        tree([LAST, event("exponential", 0.1, input="x"), FIXED], [Gate("VOTE", (0, 1, 2), 2)])
    ],
    "series": [PARTS[0], series("chain", "battery")],
}
FEW, MANY = "abc", "abcdefghijklm"
INPUTS = {
    "2 of 3": {"tree_x": TRUTHS},
    "series": {"battery_level": (90.0,), "battery_temperature": (25.0, 60.0)},
}


def random_chain(chance, names=FEW, idle=0):
    """Return a chain of two to four states of which some are observed.

    Args:
        chance: random numbers.
        names: of its inputs.
        idle: more states, of which nothing is known when `a` is not, and that are none else.
    """
    states = chance.randint(2, 4)
    pairs = [pair for pair in itertools.permutations(range(states), 2) if chance.random() < 0.6]
    arcs = [[a, b, chance.choice((0.02, 0.5, 3.0))] for a, b in pairs]
    fail = [states - 1] if chance.random() < 0.8 else sorted({states - 2, states - 1} - {0})
    several = [state for state in range(states) for _ in names]
    seen = [state for state in several if chance.random() < 0.9 / len(names)]
    observe = [[state, chance.choice(names), chance.random() < 0.5] for state in seen]
    whole = range(states, states + idle)
    observe += [[state, "a", negated] for state in whole for negated in TRUTHS]
    return chain(arcs, states + idle, fail, observe, repair=chance.random() < 0.3)


def life(chance, part, ranges, length):
    """Return values of the inputs in each step, mostly such as a life of the chain may give."""
    of = part.content
    arcs = [(arc.source, arc.target) for arc in of.arcs if arc.source not in of.fail]
    state, told = of.initial[0], []
    for _ in range(length):
        values = {name: chance.choice(several) for name, several in ranges.items()}
        for seen in of.observe:
            if seen.state == state and chance.random() < 0.95:
                values[seen.input] = not seen.negated
        told.append(values)
        after = [b for a, b in arcs if a == state]
        state = chance.choice(after) if after and chance.random() < 0.5 else state
    return told


def silenced(chance, told, ranges):
    """Return the same with inputs that are unknown in some steps, and which these are."""
    given, lost = [dict(values) for values in told], []
    first = chance.randrange(len(told) - 1)
    for at in range(first, min(first + chance.randint(1, 3), len(told))):
        count = chance.choice((1, len(ranges), chance.randint(1, len(ranges))))
        for name in chance.sample(sorted(ranges), count):
            given[at][name] = None
            lost.append((at, name))
    return given, lost


def completions(chance, given, lost, ranges):
    """Return histories in which all is known: all that there are, or some of many."""
    several = [ranges[name] for _, name in lost]
    guesses = itertools.product(*several)
    if np.prod([float(len(values)) for values in several]) > MOST:
        guesses = [[chance.choice(values) for values in several] for _ in range(MOST)]
    for guess in guesses:
        whole = [dict(values) for values in given]
        for (at, name), value in zip(lost, guess):
            whole[at][name] = value
        yield whole


def compare(parts, ranges, told, chance):
    """Compare one history with its completions; return how often."""
    thresholds = [
        {"id": f"p{i}", "activate": p, "release": p * chance.choice((1, 2)), "hold": hold}
        for i, (p, hold) in enumerate(zip(LEVELS[:24], itertools.cycle((0.0, QUANTUM))))
    ]
    more = {"thresholds": thresholds, "quantum": QUANTUM, "max_gap": 1e9}
    rule = chance.choice(("inactive", "worst_case"))
    one = monitor(parts, ranges, on_unknown=rule, **more)
    times = list(itertools.accumulate(chance.choice((0, 1, 1, 1, 3)) * QUANTUM for _ in told))
    given, lost = silenced(chance, told, ranges)
    bounded, latched = [], 0
    for t, values in zip(times, given):
        result = step(one, t, **values)
        latched += ignored(one)
        bounded.append((result, latched))
    compared = 0
    for whole in completions(chance, given, lost, ranges):
        one.reset()
        sane, more_latched = True, 0
        for t, values, (bound, latched) in zip(times, whole, bounded):
            exact = step(one, t, **values)
            more_latched += ignored(one)
            if contradicts(exact, bound) or more_latched > latched:
                break  # the model excludes this completion
            sane = sane and bound.reason != "inconsistent"
            holds(bound, exact, (parts, rule, times, given, whole), sane=sane)
            compared += 1
    return compared


def ignored(one):
    """Return how many inputs claim in a step that what failed works again."""
    return sum("ignored without" in text for text in one.faults().values())


def contradicts(exact, bound):
    """Tell whether a completion is impossible where what is known is not."""
    return exact.reason and (bound.valid or bound.reason == "unknown inputs")


def holds(bound, exact, story, *, sane):
    assert exact.p_fail_high <= bound.p_fail_high * SLACK, (bound, exact, story)
    if sane:  # the best case of what is known to be impossible means nothing
        assert bound.p_fail_low <= exact.p_fail_low * SLACK, (bound, exact, story)
    assert bound.reliability <= exact.reliability * SLACK, (bound, exact, story)
    assert not bound.mttf > exact.mttf * SLACK, (bound, exact, story)
    for name, active in bound.evidence.items():
        assert exact.evidence[name] or not active, (name, bound, exact, story)


def goal(request):
    is_long = request.config.getoption("--hypothesis-profile", default=None) == "long"
    return LONG_GOAL if is_long else GOAL


@pytest.mark.parametrize("top", TOPS)
def test_what_a_chain_missed_counts_later(top, request):
    chance, compared = random.Random(top), 0
    ranges = {**dict.fromkeys(FEW, TRUTHS), **INPUTS.get(top, {})}
    while compared < goal(request):
        part = random_chain(chance)
        told = life(chance, part, ranges, chance.randint(2, 6))
        compared += compare([part, *TOPS[top]], ranges, told, chance)


@pytest.mark.parametrize(("names", "idle"), [(MANY, 0), (FEW, 70)])
def test_what_a_chain_of_many_inputs_or_states_missed_counts_later(names, idle, request):
    chance, compared = random.Random(idle), 0
    ranges = dict.fromkeys(names, TRUTHS)
    while compared < goal(request):
        part = random_chain(chance, names, idle)
        told = life(chance, part, ranges, chance.randint(2, 6))
        compared += compare([part], ranges, told, chance)


@pytest.mark.parametrize("kind", KINDS)
def test_what_other_models_missed_counts_later(kind, request):
    part, ranges = KINDS[kind]
    chance, compared = random.Random(kind), 0
    while compared < goal(request):
        told = [
            {name: chance.choice(values) for name, values in ranges.items()}
            for _ in range(chance.randint(2, 5))
        ]
        compared += compare([part], ranges, told, chance)
