"""Chains against exponentials of matrices, closed forms and long arithmetic."""

import itertools
import math

import numpy as np
import pytest
from eddi_runtime.reliability import large_chain

from eddi_scaffold.kinds.reliability import chains
from eddi_scaffold.kinds.reliability.chains import (
    FATAL,
    rotors_chain,
)


def propagator(chain, hours):
    """Return the exponential of plain loops, which numpy's must equal."""
    rates = np.array(chains.rates_of(chain))
    plain = np.array(chains.propagator(rates.tolist(), hours))
    assert large_chain.propagator(generator(chain), hours) == pytest.approx(
        plain, rel=1e-13, abs=0.0
    )
    return plain


def generator(chain):
    rates = np.array(chains.rates_of(chain))
    return rates - np.diag(rates.sum(axis=1))


def mean_times(chain):
    plain = chains.mean_times(chain)
    fail = frozenset(chain.fail)
    endless = [state for state, life in enumerate(plain) if life == math.inf]
    rates = np.array(chains.rates_of(chain))
    assert large_chain.mean_times(rates, fail, endless) == pytest.approx(np.array(plain), rel=1e-13)
    return np.array(plain)


def chain_of(states, arcs, fail):
    return chains.Chain(tuple(map(str, range(states))), 0, tuple(fail), tuple(arcs))


def random_chain(states, seed):
    chance = np.random.default_rng(seed)
    q = 10.0 ** chance.uniform(-3, 1, (states, states))
    q[chance.random((states, states)) < 0.5] = 0.0
    arcs = [(i, j, float(q[i, j])) for i in range(states) for j in range(states)]
    return chain_of(states, arcs, [states - 1])


@pytest.mark.parametrize("states", [2, 5, 50])
@pytest.mark.parametrize("hours", [1e-3, 1.0, 30.0])
def test_agrees_with_scipy(states, hours):
    linalg = pytest.importorskip("scipy.linalg", reason="scipy is a peer, not a dependency")
    chain = random_chain(states, states)
    expected = linalg.expm(generator(chain) * hours)
    assert np.abs(propagator(chain, hours) - expected).max() < 1e-12


def test_stiff_chains_keep_their_digits():
    """Rates from 1e-9 to 1e3 1/h, against 60 digits."""
    mpmath = pytest.importorskip("mpmath", reason="mpmath is a peer, not a dependency")
    arcs = [(0, 1, 1e3), (1, 0, 4e2), (1, 2, 1e-9), (2, 1, 7.0), (2, 3, 1e-7), (0, 3, 3e-9)]
    chain = chain_of(4, arcs, [3])
    for hours in (1e-6, 1e-2, 1.0, 1e3, 1e6):
        with mpmath.workdps(60):
            exact = mpmath.matrix(4, 4)
            for i, j, rate in arcs:
                exact[i, j] += mpmath.mpf(rate)
                exact[i, i] -= mpmath.mpf(rate)
            result = mpmath.expm(exact * mpmath.mpf(hours), method="taylor")
            expected = [float(result[i, 3]) for i in range(3)]
        got = propagator(chain, hours)[:3, 3]
        assert got == pytest.approx(expected, rel=1e-10, abs=0.0), hours


def test_mean_times_against_a_solver_and_closed_forms():
    chain = random_chain(20, 8)
    transient = generator(chain)[:-1, :-1]
    expected = np.linalg.solve(-transient, np.ones(19))
    assert mean_times(chain)[:-1] == pytest.approx(expected, rel=1e-10)
    tau = mean_times(rotors_chain("PNPNPN", [0.001] * 6))
    assert tau[0] == pytest.approx(550.0, rel=1e-13)
    assert tau[-1] == 0.0


def test_mean_times_of_stiff_chains():
    """A fast repair in front of a rare failure: the solution is known in closed form."""
    up, down, fail = 1e-9, 1e3, 1e-9
    chain = chain_of(3, [(0, 1, up), (1, 0, down), (1, 2, fail)], [2])
    expected = (up + down + fail) / (up * fail)
    assert mean_times(chain)[0] == pytest.approx(expected, rel=1e-14)


def test_what_may_never_fail_has_an_infinite_mean_time():
    chain = chain_of(4, [(0, 1, 1.0), (0, 2, 1.0), (1, 3, 1.0)], [3])
    assert mean_times(chain).tolist() == [math.inf, 1.0, math.inf, 0.0]


CLOSED = {
    "PNPN": lambda x: x**4,
    "PNPNPN": lambda x: 2 * x**3 + 3 * x**4 - 6 * x**5 + 2 * x**6,
    "PPNNPN": lambda x: 4 * x**4 - 4 * x**5 + x**6,
    "PPNNPPNN": lambda x: (2 * x - x * x) ** 4,
}


@pytest.mark.parametrize("name", CLOSED)
def test_rotors_of_different_rates_equal_the_sum_over_all_sets(name):
    motors = len(name)
    rates = [0.001 * (i + 1) for i in range(motors)]
    rotors = rotors_chain(name, rates)
    alive = 0.0
    for failed in itertools.chain.from_iterable(
        itertools.combinations(range(motors), n) for n in range(motors + 1)
    ):
        if not any(fatal <= {*failed} for fatal in FATAL[name]):
            alive += math.prod(
                -math.expm1(-10 * r) if i in failed else math.exp(-10 * r)
                for i, r in enumerate(rates)
            )
    got = propagator(rotors, 10.0)[0, :-1].sum()
    # a frame that failed on the way may look operational again in no structure of rotors
    assert got == pytest.approx(alive, rel=1e-12)
    assert len(rotors.states) == {"PNPN": 2, "PNPNPN": 19, "PPNNPN": 10, "PPNNPPNN": 82}[name]
