"""Continuous-time Markov chains without subtractions, so that 1e-18 keeps its digits.

Rows of a generator ``q``: ``q[i, j]`` is the rate from i to j in 1/h, each row sums to zero.
Sources: uniformisation (Jensen 1953), scaling and squaring of non-negative matrices, and the
elimination of Grassmann, Taksar and Heyman (1985).
"""

from __future__ import annotations

import math
from typing import List, Sequence, Tuple

import numpy as np

Arc = Tuple[int, int, float]
_TERMS = 25
_FREE_STEP_LIMIT = 1e4


def generator(states: int, arcs: Sequence[Arc], fail: Sequence[int]) -> np.ndarray:
    """Return the generator (states, states) in 1/h; fail states are made absorbing.

    Args:
        states: how many there are.
        arcs: (from, to, rate in 1/h); parallel ones add up.
        fail: states whose arcs are left out, since failure is first passage.
    """
    q = np.zeros((states, states))
    absorbing = frozenset(fail)
    for source, target, rate in arcs:
        if source not in absorbing and source != target:
            q[source, target] += rate
    np.fill_diagonal(q, -q.sum(axis=1))
    return q


def propagator(q: np.ndarray, hours: float) -> np.ndarray:
    """Return exp(q hours) by Horner in a non-negative matrix and squarings.

    Entries are non-negative and rows sum to one by construction; each entry keeps its relative
    accuracy, however small it is.
    """
    fastest = float(-q.diagonal().min(initial=0.0))
    size = len(q)
    if fastest * hours <= 0.0:
        return np.eye(size)
    squarings = max(0, math.ceil(math.log2(fastest * hours)))
    step = fastest * math.ldexp(hours, -squarings)
    jump = jumps(q, fastest)
    result = np.eye(size)
    for k in range(_TERMS, 0, -1):
        result = (step / k) * (jump @ result)
        result.flat[:: size + 1] += 1.0
    result *= math.exp(-step)
    _normalise(result)
    for _ in range(squarings):
        result = result @ result
        _normalise(result)
    return result


def uniformised(p: np.ndarray, q: np.ndarray, hours: float) -> np.ndarray:
    """Return p exp(q hours) for a step of any length: a Poisson mixture of jumps.

    Args:
        p: distribution over the states.
        q: generator.
        hours: length of the step; above 1e4 mean jumps the propagator is used.
    """
    fastest = float(-q.diagonal().min(initial=0.0))
    mean = fastest * hours
    if mean <= 0.0:
        return p.copy()
    if mean > _FREE_STEP_LIMIT:
        result: np.ndarray = p @ propagator(q, hours)
        return result
    weights = _poisson(mean)
    jump = jumps(q, fastest)
    total = weights[0] * p
    moved = p
    for weight in weights[1:]:
        moved = moved @ jump
        total += weight * moved
    return total


def mean_times(q: np.ndarray, fail: Sequence[int]) -> np.ndarray:
    """Return the mean time to failure in hours from each state; 0 in a fail state.

    ``inf`` where failure is not certain: some reachable state cannot fail. Without subtractions,
    so that rates of any ratio lose nothing.
    """
    rates = q.copy()
    np.fill_diagonal(rates, 0.0)
    tau = np.full(len(q), math.inf)
    tau[list(fail)] = 0.0
    order = [int(i) for i in np.flatnonzero(certain(rates, fail)) if i not in set(fail)]
    cost = np.ones(len(q))
    exits = {}
    for position in range(len(order) - 1, -1, -1):
        state = order[position]
        rest = order[:position]
        exits[state] = float(rates[state, rest].sum() + rates[state, list(fail)].sum())
        share = rates[rest, state] / exits[state]
        cost[rest] += share * cost[state]
        rates[rest] += np.outer(share, rates[state])
    for position, state in enumerate(order):
        before = order[:position]
        tau[state] = (cost[state] + rates[state, before] @ tau[before]) / exits[state]
    return tau


def certain(rates: np.ndarray, fail: Sequence[int]) -> np.ndarray:
    """Return for each state whether failure is certain in the long run (booleans)."""
    can = reaching(rates, fail)
    return ~reaching(rates, [int(i) for i in np.flatnonzero(~can)])


def reaching(rates: np.ndarray, targets: Sequence[int]) -> np.ndarray:
    """Return for each state whether one of the targets can be reached from it (booleans)."""
    found = np.zeros(len(rates), dtype=bool)
    waiting: List[int] = list(targets)
    found[waiting] = True
    while waiting:
        new = (rates[:, waiting.pop()] > 0.0) & ~found
        found |= new
        waiting += [int(i) for i in np.flatnonzero(new)]
    return found


def jumps(q: np.ndarray, fastest: float) -> np.ndarray:
    """Return the matrix of one jump of the uniformised chain, without negative entries."""
    jump = q / fastest
    jump.flat[:: len(q) + 1] += 1.0
    np.maximum(jump, 0.0, out=jump)
    return jump


def _normalise(matrix: np.ndarray) -> None:
    matrix /= matrix.sum(axis=1, keepdims=True)


def _poisson(mean: float) -> List[float]:
    """Return the weights from 0 on, made from the mode so that none is lost in a difference."""
    mode = int(mean)
    last = mode + 40 + math.ceil(math.sqrt(100.0 * mode))
    weights = [1.0] * (last + 1)
    for k in range(mode, 0, -1):
        weights[k - 1] = weights[k] * (k / mean)
    for k in range(mode, last):
        weights[k + 1] = weights[k] * (mean / (k + 1))
    total = math.fsum(weights)
    return [weight / total for weight in weights]
