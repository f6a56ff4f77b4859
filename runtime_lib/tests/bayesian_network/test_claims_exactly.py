"""Thresholds of random networks against their definition, and against every completion."""

import itertools
import math
import random
from fractions import Fraction

import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from .networks import enumerate_all, give, monitor, nodes_of, random_network, threshold

SECOND = 1_000_000_000
EDGES = (1.0, 2.0, 3.0)
BAND = 0.5
MIDDLES = (0.25, 1.5, 2.5, 3.75)
"""A value of each bin; from one to the next the bin changes, whatever the hysteresis."""
VALUES = (None, 0.25, 0.75, 1.25, 1.5, 1.75, 2.25, 2.75, 3.25, 3.75)
TIE = 1e-9


class World:
    """A random network, some of whose nodes are fed by bins with hysteresis, or by texts."""

    def __init__(self, rng, binned=(True, False)):
        self.net = net = random_network(rng, rng.randint(2, 4), zeros=0.3, most_states=3)
        self.names = net.shape.names
        count = len(self.names)
        self.inputs = sorted(rng.sample(range(count), rng.randint(1, min(count, 3))))
        self.binned = {one for one in self.inputs if rng.choice(binned)}
        self.node = rng.randrange(count)
        states = range(net.shape.cards[self.node])
        self.states = sorted(rng.sample(states, rng.randint(1, len(states) - 1)))
        self.key = rng.choice(("at_most", "at_least"))
        self.activate = round(rng.random(), 3)
        further = round(rng.random() * 0.3, 3)
        sign = 1 if self.key == "at_most" else -1
        self.release = min(1.0, max(0.0, self.activate + sign * further))
        self.hold = rng.choice((0, 0, 1, 2))

    def monitor(self, memory=True):
        net, names = self.net, self.names
        limit = {self.key: self.activate, "release": self.release if memory else self.activate}
        states = [net.states[self.node][one] for one in self.states]
        hold = self.hold if memory else 0.0
        one = threshold("T", names[self.node], states, hold, **limit)
        bins = {
            names[k]: {
                "input": names[k],
                "bins": list(EDGES[: net.shape.cards[k] - 1]),
                "hysteresis": BAND,
            }
            for k in self.binned
        }
        direct = {names[k]: names[k] for k in self.inputs if k not in self.binned}
        return monitor(nodes_of(net), [names[-1]], bins=bins, direct=direct, thresholds=[one])

    def draw(self, rng, known):
        """Return node -> value or None, of an input each."""
        found = {}
        for one in self.inputs:
            states = self.net.states[one]
            usual = VALUES[1:] if one in self.binned else states
            found[one] = rng.choice(usual) if rng.random() < known else None
        return found

    def fill(self, one):
        """Return the values that an unknown input may have: one for each state."""
        card = self.net.shape.cards[one]
        return MIDDLES[:card] if one in self.binned else self.net.states[one]

    def step(self, machine, values, t):
        named = {self.names[one]: value for one, value in values.items()}
        machine.execute_step(give(**named), t * SECOND)
        (claim,) = machine.claims()
        return claim

    def bin_of(self, one, value, previous):
        """Return the bin by the words of the documentation."""
        edges = EDGES[: self.net.shape.cards[one] - 1]
        bare = sum(value > edge for edge in edges)
        if previous is None or previous == bare:
            return bare
        beyond = value - edges[previous] if bare > previous else edges[previous - 1] - value
        return previous if beyond <= BAND else bare

    def bounds(self, possible):
        """Return (lowest, highest) probability over all states that inputs may have, exactly."""
        net, found = self.net, []
        for case in itertools.product(*possible):
            rows = enumerate_all(net, [self.node], self.inputs, case, {}, number=Fraction)
            if rows is not None:
                found.append(sum(rows[0][state] for state in self.states))
        return (min(found), max(found)) if found else None


def places(world, values, before):
    """Return for each input the states that it may be in, by those that it may have been in."""
    now = []
    for one, value in values.items():
        card = world.net.shape.cards[one]
        if value is None:
            before[one] = set(range(card))
        elif one in world.binned:
            before[one] = {world.bin_of(one, value, last) for last in before[one]}
        else:
            before[one] = {world.net.states[one].index(value)}
        now.append(sorted(before[one]))
    return now


def claimed(world, history):
    """Return whether a threshold is active at the end: its definition, read from behind."""
    sign = 1 if world.key == "at_most" else -1

    def within(bounds, limit):
        worst = None if bounds is None else bounds[1] if sign > 0 else bounds[0]
        assume(worst is None or abs(worst - Fraction(limit)) > TIE)
        return worst is not None and sign * worst <= sign * Fraction(limit)

    active, since = False, None
    for t, bounds in enumerate(history):
        good, kept = within(bounds, world.activate), within(bounds, world.release)
        since = (t if since is None else since) if good else None
        active = kept and (active or (good and t - since >= world.hold))
    return active


@given(st.integers(0, 2**32), st.integers(1, 7))
def test_a_threshold_is_what_its_definition_says(seed, length):
    rng = random.Random(seed)
    world = World(rng)
    machine = world.monitor()
    before = {one: set(range(world.net.shape.cards[one])) for one in world.inputs}
    history = []
    for t in range(length):
        values = world.draw(rng, known=0.7)
        claim = world.step(machine, values, t)
        history.append(world.bounds(places(world, values, before)))
        assert claim.active is claimed(world, history)
        if history[-1] is None:
            assert math.isnan(claim.low)
            assert claim.reason == "inconsistent"
        else:
            assert (claim.low, claim.high) == pytest.approx(
                tuple(map(float, history[-1])), abs=1e-12
            )


def completions(world, steps):
    """Yield every history in which each input that was unknown has some value."""
    gaps = [(t, one) for t, values in enumerate(steps) for one, v in values.items() if v is None]
    for filled in itertools.product(*(world.fill(one) for _, one in gaps)):
        whole = [dict(values) for values in steps]
        for (t, one), value in zip(gaps, filled):
            whole[t][one] = value
        yield whole


@given(st.integers(0, 2**32), st.booleans())
def test_what_is_claimed_holds_in_every_completion_that_is_possible(seed, memory):
    rng = random.Random(seed)
    world = World(rng, binned=(False,) if memory else (True,))
    steps = [world.draw(rng, known=0.6) for _ in range(3)]
    if not memory:  # what was before the start is not known either: a first step without values
        steps.insert(0, dict.fromkeys(world.inputs))
    told = world.monitor(memory)
    claims = [world.step(told, values, t).active for t, values in enumerate(steps)]
    complete = world.monitor(memory)
    for whole in completions(world, steps):
        complete.reset()
        found = [world.step(complete, values, t) for t, values in enumerate(whole)]
        if "inconsistent" not in [one.reason for one in found]:
            assert all(one.active for claim, one in zip(claims, found) if claim)
