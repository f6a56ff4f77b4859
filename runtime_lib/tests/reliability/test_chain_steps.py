"""The steps of a chain, taken many at a time, against the same steps taken one by one."""

import math
import random

import numpy as np
import pytest
from eddi_runtime.reliability.battery import FreeHorizon
from eddi_runtime.reliability.component import Moment
from eddi_runtime.reliability.large_chain import propagator

from eddi_scaffold.kinds.reliability import chains
from runtime_lib.tests.reliability.reliability_models import (
    battery,
    but,
    chain,
    compiled,
    heat,
    monitor,
)
from runtime_lib.tests.reliability.test_reliability_monitor import step

QUANTUM = 0.1 / 3600.0


def model_of(spec, observe, horizon):
    part = chain(spec.arcs, len(spec.states), spec.fail, observe)
    return monitor([part], {name for _, name, _ in observe}, horizon=horizon).components["chain"]


def spec_of(states, fail, arcs):
    return chains.Chain(tuple(map(str, range(states))), 0, fail, arcs)


class OneByOne:
    """A belief that is moved, masked and normalised in every step."""

    def __init__(self, spec, horizon):
        rates = np.array(chains.rates_of(spec))
        q = rates - np.diag(rates.sum(axis=1))
        self.step, self.ahead = propagator(q, QUANTUM), propagator(q, horizon)
        self.fail, self.tau = list(spec.fail), np.array(chains.mean_times(spec))
        self.belief = np.eye(len(spec.states))[0]

    def look(self, quanta, mask):
        for _ in range(quanta):
            self.belief = self.belief @ self.step
        self.belief = self.belief * mask
        self.belief = self.belief / self.belief.max()
        self.belief /= self.belief.sum()
        p = self.belief @ self.ahead[:, self.fail].sum(axis=1)
        return p, 1.0 - p, self.belief @ self.tau


def random_chain(seed, states):
    chance = np.random.default_rng(seed)
    rates = 10.0 ** chance.uniform(-9, 3, (states, states))
    rates[chance.random((states, states)) < 0.4] = 0.0
    arcs = [(i, j, float(rates[i, j])) for i in range(states) for j in range(states) if i != j]
    arcs += [(i, i + 1, 1e-6) for i in range(states - 1)]  # every state may fail
    return spec_of(states, (states - 1,), tuple(arcs))


@pytest.mark.parametrize("states", [2, 5, 20, 70])
@pytest.mark.parametrize("observed", [False, True])
def test_steps_equal_those_taken_one_by_one(states, observed):
    spec = random_chain(states, states)
    observe = ((states - 1, "down", False), (0, "worn", True)) if observed else ()
    ours = model_of(spec, observe, 0.5)
    other = OneByOne(spec, 0.5)
    chance = random.Random(states)
    values = {"down": False, "worn": False}
    worst = 0.0
    for i in range(600):
        quanta = 0 if i == 0 else chance.choice((1, 1, 1, 1, 1, 1, 0, 2, 3, 40))
        if i < 300 or chance.random() < 0.9:
            quanta = min(quanta, 1)  # long runs, and runs with jitter
        if chance.random() < 0.05:
            worn = i > 0 and states > 2 and chance.random() < 0.5
            values = {"down": chance.random() < 0.5, "worn": worn}
        mask = np.ones(states)
        if observed:
            mask[0], mask[-1] = float(not values["worn"]), float(values["down"])
        found = ours.step(values, Moment(quanta, quanta * QUANTUM, 0.0, 0.5, 0), {})
        p, alive, life = other.look(quanta, mask)
        assert (found.low, found.unknown, found.reason) == (found.high, (), "")
        assert found.high == pytest.approx(p, rel=1e-10, abs=0.0), i
        assert found.mttf == pytest.approx(life, rel=1e-9), i
        worst = max(worst, abs(found.reliability - alive))
        if chance.random() < 0.03:
            assert ours.chain.belief == pytest.approx(other.belief, rel=1e-9, abs=1e-300)
    assert worst < 1e-9


def test_tiny_probabilities_keep_their_digits_over_many_steps():
    """4e-18 in eight motors, unobserved: 500 steps, an oracle of its own."""
    rate = 1e-9
    spec = spec_of(3, (2,), ((0, 1, 8 * rate), (1, 2, rate)))
    ours = model_of(spec, (), 1e-3)
    for i in range(500):
        found = ours.step({}, Moment(int(i > 0), 0.0, 0.0, 1e-3, 0), {})
    hours = 499 * QUANTUM + 1e-3
    exact = 8 * rate * rate * hours**2 / 2 * (1 - 9 * rate * hours / 3)
    assert found.high < 1e-20
    assert found.high == pytest.approx(exact, rel=1e-10, abs=0.0)


def test_what_is_observed_for_long_leaves_a_sound_belief():
    """The weight of what is consistent falls by 1e-3 each step; p_fail stays that of the state."""
    spec = spec_of(3, (2,), ((0, 1, 7.0 / QUANTUM), (0, 2, 1e-4), (1, 2, 5.0)))
    ours = model_of(spec, ((1, "fresh", True),), 0.5)
    for i in range(300):
        found = ours.step({"fresh": True}, Moment(int(i > 0), 0.0, 0.0, 0.5, 0), {})
        assert found.reason == ""
        assert ours.chain.belief[1] == 0.0
    assert 0.0 < found.high <= 1.0


@pytest.mark.parametrize("moving", [False, True])
def test_sums_that_are_written_out_equal_products_of_matrices(moving):
    chance = random.Random(3)
    for seed in range(20):
        spec = random_chain(seed, chance.randint(2, 8))
        last = len(spec.states) - 1
        observe = [(0, "new", False), (last, "ok", True)]
        age, repair = chance.choice((0.0, 3.0)), seed % 2 == 0
        part = chain(spec.arcs, last + 1, [last], observe, age, repair=repair)
        inputs = ["new", "ok", *(["mission_end"] if moving else [])]
        model = {"horizon": 2.0, "mission_end": moving}
        one, other = monitor([part], inputs, **model), compiled([part], inputs, **model).Monitor()
        for i in range(60):
            values = {name: chance.choice((True, True, True, False, None)) for name in inputs}
            values["mission_end"] = chance.choice((7200.0, 3600.0, 0.0, None))
            t = 0.1 * (i + chance.choice((0, 0, 3)))
            mine, its = step(one, t, **values), step(other, t, **values)
            assert (mine.valid, mine.reason, mine.unknown) == (its.valid, its.reason, its.unknown)
            for name in ("p_fail_low", "p_fail_high", "reliability", "mttf"):
                expected = pytest.approx(getattr(its, name), rel=1e-12, abs=1e-14)
                assert getattr(mine, name) == expected, name


def test_as_many_observations_as_there_may_be_are_kept():
    names = [f"i{k}" for k in range(7)]
    observe = tuple((k, name, False) for k, name in enumerate(names))
    spec = random_chain(1, 9)
    ours = model_of(spec, observe, 0.5)
    other = OneByOne(spec, 0.5)
    for i in range(128):
        values = {name: bool(i & 2**k) for k, name in enumerate(names)}
        mask = np.array([float(values[name]) for name in names] + [1.0, 1.0])
        found = ours.step(values, Moment(1, QUANTUM, 0.0, 0.5, 0), {})
        assert len(ours._seen) <= 64
        if found.reason == "":
            assert found.high == pytest.approx(other.look(1, mask)[0], rel=1e-9, abs=0.0)


COLD, WARM = battery(1e-3), battery(1e-3, **heat(0.5, 25.0, 60.0))


def factor(celsius):
    return math.exp(0.5 / 8.617333262e-5 * (1 / 298.15 - 1 / (celsius + 273.15)))


def p_fail(part, horizon=1.0, **values):
    given = {f"battery_{name}": value for name, value in values.items()}
    return step(monitor([part], given, horizon=horizon), **given)


@pytest.mark.parametrize("level", [90, 60, 30])
@pytest.mark.parametrize("celsius", [-20.0, 25.0, 45.0, 60.0, 75.0])
def test_heat_makes_time_pass_faster(level, celsius):
    for horizon in (0.01, 1.0, 100.0):
        warm = p_fail(but(WARM, t_max=80.0), horizon, level=level, temperature=celsius)
        cold = p_fail(COLD, horizon * factor(celsius), level=level)
        assert warm.valid
        assert warm.p_fail == pytest.approx(cold.p_fail, rel=1e-12, abs=0.0)
        assert warm.mttf == pytest.approx(cold.mttf / factor(celsius), rel=1e-12)
        assert warm.horizon == horizon


def test_an_unknown_temperature_counts_as_the_hottest():
    hottest = p_fail(WARM, level=80, temperature=60.0)
    for value in (None, math.nan, math.inf, "hot"):
        result = p_fail(WARM, level=80, temperature=value)
        assert not result.valid
        assert result.unknown == ("battery_temperature",)
        assert (result.p_fail_low, result.p_fail_high) == (0.0, hottest.p_fail)
    assert p_fail(WARM, level=20, temperature=None).p_fail_low == 1.0
    both = p_fail(WARM, level=None, temperature=None)
    assert both.unknown == ("battery_level", "battery_temperature")
    assert (both.p_fail_low, both.p_fail_high) == (0.0, 1.0)
    only_level = p_fail(WARM, level=None, temperature=60.0)
    assert 0.0 < only_level.p_fail_low < hottest.p_fail  # a recovering battery


def test_no_temperature_stops_a_step():
    hot = but(WARM, **heat(10.0, -200.0, -200.0))
    result = p_fail(hot, level=80, temperature=999.0)
    assert result.p_fail == 1.0
    assert p_fail(hot, level=80, temperature=-200.0).p_fail < 0.01


def test_any_horizon_agrees_with_the_propagator():
    random = np.random.default_rng(7)
    for _ in range(10):
        arcs = [
            (int(a), int(b), float(10.0 ** random.uniform(-6, 1)))
            for a, b in random.integers(0, 8, (24, 2))
            if a != b and a < 6
        ]
        ahead = FreeHorizon(arcs, 20.0)
        rates = chains.rates_of(chains.Chain(("",) * 8, 0, (6, 7), tuple(arcs)))
        for hours in (0.0, 1e-12, 1e-3, 1.0, 19.0, 500.0):
            expected = np.array(chains.propagator(rates, hours))
            found = np.array([ahead.of(state, hours) for state in range(8)])
            failed, alive = expected[:, 6:].sum(axis=1), expected[:, :6].sum(axis=1)
            assert found[:, 0] == pytest.approx(failed, rel=1e-11, abs=0.0)
            assert found[:, 1] == pytest.approx(alive, rel=1e-11, abs=1e-300)
