"""What lies ahead of each state of a chain for horizons that are known only in the step."""

from __future__ import annotations

import math
from typing import List, Sequence

import numpy as np

from .markov import Arc, generator, jumps, propagator

_PREPARED = 200.0
"""Mean jumps up to which the terms are made in advance; beyond, the propagator is made anew."""


class FreeHorizon:
    """Failed and alive after any time, from each state: uniformisation (Jensen 1953).

    The vectors P^k f are made here once; a step weights them with a Poisson distribution.

    Args:
        states: how many there are.
        arcs: (from, to, rate in 1/h).
        fail: absorbing states.
        longest: hours, the longest time that is usual.
    """

    def __init__(
        self, states: int, arcs: Sequence[Arc], fail: Sequence[int], longest: float
    ) -> None:
        self._q = generator(states, arcs, fail)
        self._fail = tuple(fail)
        self._ends = np.zeros((states, 2))
        self._ends[:, 1] = 1.0
        self._ends[list(fail)] = (1.0, 0.0)
        self._fastest = float(-self._q.diagonal().min(initial=0.0))
        self._limit = min(self._fastest * longest, _PREPARED)
        count = math.ceil(self._limit + 40.0 + 10.0 * math.sqrt(self._limit))
        terms: List[np.ndarray] = [self._ends]
        jump = jumps(self._q, self._fastest) if self._fastest > 0.0 else np.eye(states)
        for _ in range(count):
            terms.append(jump @ terms[-1])
        self._terms = np.array(terms).reshape(count + 1, -1)
        self._k = np.arange(count + 1.0)
        self._log_factorial = np.array([math.lgamma(k + 1.0) for k in self._k])
        self._weights = np.empty(count + 1)
        self._out = np.empty(2 * states)
        self._hours = -1.0
        self._found: List[List[float]] = []

    def at(self, hours: float) -> List[List[float]]:
        """Return for each state how probable it is to have failed, and to be alive, after hours."""
        if hours != self._hours:
            self._hours = hours
            self._look(self._fastest * hours, hours)
            self._found = np.minimum(self._out, 1.0).reshape(-1, 2).tolist()
            for state in self._fail:  # the sum of the weights is one up to rounding only
                self._found[state] = [1.0, 0.0]
        return self._found

    def _look(self, mean: float, hours: float) -> None:
        if mean <= 0.0:
            self._out[:] = self._ends.ravel()
        elif mean > self._limit:
            self._out[:] = (propagator(self._q, hours) @ self._ends).ravel()
        else:
            np.multiply(self._k, math.log(mean), out=self._weights)
            self._weights -= self._log_factorial
            self._weights -= mean
            np.exp(self._weights, out=self._weights)
            np.dot(self._weights, self._terms, out=self._out)
