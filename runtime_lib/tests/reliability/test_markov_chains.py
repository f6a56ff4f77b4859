"""Chains against exponentials of matrices, closed forms and long arithmetic."""

import itertools
import math

import pytest

np = pytest.importorskip("numpy", reason="reliability needs numpy")

from eddi_runtime.reliability import markov  # noqa: E402 - numpy comes first
from eddi_runtime.reliability.structures import CONFIGURATIONS, Rotors, operational  # noqa: E402 - numpy comes first


def random_generator(states, seed, exponents=(-3, 1)):
    chance = np.random.default_rng(seed)
    q = 10.0 ** chance.uniform(*exponents, (states, states))
    q[chance.random((states, states)) < 0.5] = 0.0
    arcs = [(i, j, q[i, j]) for i in range(states) for j in range(states)]
    return markov.generator(states, arcs, [states - 1])


@pytest.mark.parametrize("states", [2, 5, 50])
@pytest.mark.parametrize("hours", [1e-3, 1.0, 30.0])
def test_agrees_with_scipy(states, hours):
    linalg = pytest.importorskip("scipy.linalg", reason="scipy is a peer, not a dependency")
    q = random_generator(states, states)
    expected = linalg.expm(q * hours)
    assert np.abs(markov.propagator(q, hours) - expected).max() < 1e-12
    p = np.zeros(states)
    p[0] = 1.0
    assert np.abs(markov.uniformised(p, q, hours) - expected[0]).max() < 1e-12


def test_stiff_chains_keep_their_digits():
    """Rates from 1e-9 to 1e3 1/h, against 60 digits."""
    mpmath = pytest.importorskip("mpmath", reason="mpmath is a peer, not a dependency")
    arcs = [(0, 1, 1e3), (1, 0, 4e2), (1, 2, 1e-9), (2, 1, 7.0), (2, 3, 1e-7), (0, 3, 3e-9)]
    q = markov.generator(4, arcs, [3])
    for hours in (1e-6, 1e-2, 1.0, 1e3, 1e6):
        with mpmath.workdps(60):
            exact = mpmath.matrix(4, 4)
            for i, j, rate in arcs:
                exact[i, j] += mpmath.mpf(rate)
                exact[i, i] -= mpmath.mpf(rate)
            result = mpmath.expm(exact * mpmath.mpf(hours), method="taylor")
            expected = [float(result[i, 3]) for i in range(3)]
        got = markov.propagator(q, hours)[:3, 3]
        assert got == pytest.approx(expected, rel=1e-10, abs=0.0), hours


def test_eight_motors_fail_with_probability_4e_18():
    rate = 1e-9
    rotors = Rotors("PPNNPPNN", [rate] * 8)
    q = markov.generator(rotors.spec.states, rotors.spec.arcs, rotors.spec.fail)
    # both motors of one pair: 4 q^2 to leading order, the next terms are 1e-18 of it
    q1 = -math.expm1(-rate)
    expected = -math.expm1(4.0 * math.log1p(-q1 * q1))
    assert markov.propagator(q, 1.0)[0, -1] == pytest.approx(expected, rel=1e-12, abs=0.0)
    start = np.eye(rotors.spec.states)[0]
    assert markov.uniformised(start, q, 1.0)[-1] == pytest.approx(expected, rel=1e-12, abs=0.0)


def test_a_long_free_step_uses_the_propagator():
    q = random_generator(5, 3)
    p = np.full(5, 0.2)
    fastest = -q.diagonal().min()
    free = markov.uniformised(p, q, 2e4 / fastest)
    assert free == pytest.approx(p @ markov.propagator(q, 2e4 / fastest), rel=1e-12)
    assert (markov.uniformised(p, q, 0.0) == p).all()


def test_nothing_happens_without_rates_or_time():
    assert (markov.propagator(np.zeros((3, 3)), 5.0) == np.eye(3)).all()
    assert (markov.propagator(random_generator(3, 1), 0.0) == np.eye(3)).all()


def test_mean_times_against_a_solver_and_closed_forms():
    q = random_generator(20, 8)
    transient = q[:-1, :-1]
    expected = np.linalg.solve(-transient, np.ones(19))
    assert markov.mean_times(q, [19])[:-1] == pytest.approx(expected, rel=1e-10)
    rotors = Rotors("PNPNPN", [0.001] * 6)
    tau = markov.mean_times(
        markov.generator(rotors.spec.states, rotors.spec.arcs, rotors.spec.fail), rotors.spec.fail
    )
    assert tau[0] == pytest.approx(550.0, rel=1e-13)
    assert tau[-1] == 0.0


def test_mean_times_of_stiff_chains():
    """A fast repair in front of a rare failure: the solution is known in closed form."""
    up, down, fail = 1e-9, 1e3, 1e-9
    q = markov.generator(3, [(0, 1, up), (1, 0, down), (1, 2, fail)], [2])
    expected = (up + down + fail) / (up * fail)
    assert markov.mean_times(q, [2])[0] == pytest.approx(expected, rel=1e-14)


def test_what_may_never_fail_has_an_infinite_mean_time():
    q = markov.generator(4, [(0, 1, 1.0), (0, 2, 1.0), (1, 3, 1.0)], [3])
    assert markov.mean_times(q, [3]).tolist() == [math.inf, 1.0, math.inf, 0.0]


CLOSED = {
    "PNPN": lambda x: x**4,
    "PNPNPN": lambda x: 2 * x**3 + 3 * x**4 - 6 * x**5 + 2 * x**6,
    "PPNNPN": lambda x: 4 * x**4 - 4 * x**5 + x**6,
    "PPNNPPNN": lambda x: (2 * x - x * x) ** 4,
}


@pytest.mark.parametrize("name", CLOSED)
def test_rotors_equal_their_closed_form(name):
    motors = CONFIGURATIONS[name]
    rotors = Rotors(name, [0.01] * motors)
    q = markov.generator(rotors.spec.states, rotors.spec.arcs, rotors.spec.fail)
    for hours in (1.0, 30.0, 200.0):
        alive = 1.0 - markov.propagator(q, hours)[0, -1]
        assert alive == pytest.approx(CLOSED[name](math.exp(-0.01 * hours)), rel=1e-12)


@pytest.mark.parametrize("name", CLOSED)
def test_rotors_of_different_rates_equal_the_sum_over_all_sets(name):
    motors = CONFIGURATIONS[name]
    rates = [0.001 * (i + 1) for i in range(motors)]
    rotors = Rotors(name, rates)
    q = markov.generator(rotors.spec.states, rotors.spec.arcs, rotors.spec.fail)
    alive = 0.0
    for failed in itertools.chain.from_iterable(
        itertools.combinations(range(motors), n) for n in range(motors + 1)
    ):
        if operational(name, frozenset(failed)):
            alive += math.prod(
                -math.expm1(-10 * r) if i in failed else math.exp(-10 * r)
                for i, r in enumerate(rates)
            )
    got = markov.propagator(q, 10.0)[0, :-1].sum()
    # a frame that failed on the way may look operational again in no structure of rotors
    assert got == pytest.approx(alive, rel=1e-12)
    assert rotors.spec.states == {"PNPN": 2, "PNPNPN": 19, "PPNNPN": 10, "PPNNPPNN": 82}[name]
