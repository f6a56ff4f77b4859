"""Chains of many states: exponentials of matrices by numpy when the monitor starts.

Without subtractions, so that 1e-18 keeps its digits. Sources: uniformisation (Jensen 1953),
scaling and squaring of non-negative matrices, elimination (Grassmann, Taksar, Heyman 1985).
"""

from __future__ import annotations

import math
from itertools import accumulate
from typing import Sequence

import numpy as np

from .chain import Belief, Chain, Look, Row, Seen

_TERMS = 25


class LargeChain(Chain):
    """The belief over the states of a chain, moved by products with matrices."""

    count: int  # number of states
    initial = 0  # number of the state at the start
    # (from, to, rate in 1/h); parallel ones add up, those of fail states are left out
    arcs: tuple[tuple[int, int, float], ...]
    endless: tuple[int, ...] = ()  # states that may live for ever
    age = 0.0  # hours that it had run, unobserved, before the start of the mission
    hours: float  # of one quantum
    horizon: float  # hours; that of one of ``steps`` steps that are prepared

    def __init__(self) -> None:
        self.states = self.count
        fail = frozenset(self.fail)
        q = np.zeros((self.states, self.states))
        for source, target, rate in self.arcs:
            if source not in fail and source != target:
                q[source, target] += rate
        self._tau = tau = mean_times(q, fail, self.endless)
        np.fill_diagonal(q, -q.sum(axis=1))
        self._now = propagator(q, self.age)[self.initial].copy()
        self.first = tuple(self._now.tolist())
        self._doubled = [propagator(q, self.hours)]  # of one quantum, two, four, ...
        ends = np.zeros((self.states, 2))
        ends[:, 1] = 1.0
        ends[list(self.fail)] = (1.0, 0.0)
        endless = np.isinf(tau)
        rest = [np.where(endless, 0.0, tau), endless.astype(float), np.ones(self.states)]
        step = propagator(q, self.horizon)
        views = [step @ ends]
        if self.steps > 1:
            views = list(accumulate(range(self.steps), lambda view, _: step @ view, initial=ends))
        # failed, alive, mean life, weight of endless states and of all: one product with a belief
        self._looks = [np.column_stack([view, *rest]) for view in views]
        self._found: dict[int, list[Row]] = {}
        self._seen = self.everything = Seen(self, range(self.states))
        self._mask = np.array(self._seen.mask)
        self.reset()

    def rows(self, at: int) -> list[Row]:
        rows_at = self._found.get(at)
        if rows_at is None:
            failed, alive = np.minimum(self._looks[at][:, :2], 1.0).T.tolist()
            rows_at = self._found[at] = list(zip(failed, alive, self._tau.tolist()))
        return rows_at

    def weights(self) -> Belief:
        numbers: list[float] = self._now.tolist()
        return numbers

    def believe(self, belief: Belief) -> None:
        self._now = np.array(belief)

    def look(self, belief: Belief, at: int) -> Look:
        numbers: list[float] = np.dot(belief, self._looks[at]).tolist()
        return numbers

    def after(self, beliefs: list[Belief], quanta: int) -> list[Belief]:
        moved = np.array(beliefs)
        for power in self._factors(quanta):
            moved = moved @ power
        rows: list[Belief] = moved.tolist()
        return rows

    def moved(self, quanta: int, at: int, seen: Seen) -> Look:
        for power in self._factors(quanta):
            self._now = self._now.dot(power)
        if not seen.whole:
            if seen is not self._seen:  # mostly it is that of the step before
                self._seen, self._mask = seen, np.array(seen.mask)
            self._now *= self._mask
        look: list[float] = self._now.dot(self._looks[at]).tolist()
        return look

    def _factors(self, quanta: int) -> list[np.ndarray]:
        """Return the powers of one quantum that make up several."""
        powers = self._doubled
        while len(powers) < quanta.bit_length():
            powers.append(_squared(powers[-1]))
        return [power for bit, power in enumerate(powers) if quanta >> bit & 1]


def _squared(power: np.ndarray) -> np.ndarray:
    square: np.ndarray = power @ power
    square /= square.sum(axis=1, keepdims=True)  # rows of probabilities
    return square


def propagator(q: np.ndarray, hours: float) -> np.ndarray:
    """Return exp(q hours) by Horner and squarings; each entry keeps its relative accuracy."""
    fastest = float(-q.diagonal().min(initial=0.0))
    size = len(q)
    if fastest * hours <= 0.0:
        return np.eye(size)
    squarings = max(0, math.ceil(math.log2(fastest * hours)))
    step = fastest * math.ldexp(hours, -squarings)
    jump = q / fastest
    jump.flat[:: size + 1] += 1.0
    np.maximum(jump, 0.0, out=jump)
    result = np.eye(size)
    for k in range(_TERMS, 0, -1):
        result = (step / k) * (jump @ result)
        result.flat[:: size + 1] += 1.0
    result /= result.sum(axis=1, keepdims=True)
    for _ in range(squarings):
        result = _squared(result)
    return result


def mean_times(rates: np.ndarray, fail: frozenset[int], endless: Sequence[int]) -> np.ndarray:
    """Return the mean hours to failure from each state; ``endless``: failure is not certain."""
    rates = rates.copy()
    tau = np.full(len(rates), math.inf)
    ends = sorted(fail)
    tau[ends] = 0.0
    order = [i for i in range(len(rates)) if i not in fail.union(endless)]
    cost = np.ones(len(rates))
    exits = {}
    for position in range(len(order) - 1, -1, -1):
        state, rest = order[position], order[:position]
        exits[state] = float(rates[state, rest].sum() + rates[state, ends].sum())
        share = rates[rest, state] / exits[state]
        cost[rest] += share * cost[state]
        rates[rest] += np.outer(share, rates[state])
    for position, state in enumerate(order):
        before = order[:position]
        tau[state] = (cost[state] + rates[state, before] @ tau[before]) / exits[state]
    return tau
