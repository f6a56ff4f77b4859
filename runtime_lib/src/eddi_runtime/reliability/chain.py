"""A Markov chain in time: its state belief, what is observed of it, and what lies ahead."""

from __future__ import annotations

import math
from typing import FrozenSet, List, NamedTuple, Optional, Sequence, Tuple

import numpy as np

from .estimate import Estimate, Moment
from .markov import Arc, generator, mean_times, propagator

INCONSISTENT = "inconsistent"


class ChainSpec(NamedTuple):
    """A chain: states by number, arcs with rates in 1/h."""

    states: int
    initial: int
    fail: Tuple[int, ...]
    arcs: Tuple[Arc, ...]


class Horizons(NamedTuple):
    """The horizons that are prepared: ``steps`` steps of ``step`` hours, or one of ``step``.

    Attributes:
        step: hours.
        steps: 1: only ``step`` itself; more: 0, step, 2 step, ... up to ``steps * step``.
    """

    step: float
    steps: int = 1


class Chain:
    """The belief over the states of a chain. What depends on the model only is made here once.

    Attributes:
        states: how many there are.
        fail: numbers of the fail states.
        tau: mean time to failure in hours from each state.
    """

    def __init__(self, spec: ChainSpec, quantum: float, horizons: Horizons) -> None:
        self.states, self.fail = spec.states, frozenset(spec.fail)
        self._initial = spec.initial
        q = generator(spec.states, spec.arcs, spec.fail)
        self._step = propagator(q, quantum)
        self._powers: List[np.ndarray] = [self._step]
        self._ahead, self._alive = _ahead(q, spec.fail, horizons)
        self.tau = mean_times(q, spec.fail)
        self._endless = np.isinf(self.tau)
        self._is_endless = bool(self._endless.any())
        mean = np.where(self._endless, 0.0, self.tau)
        # failed, alive and mean time of a belief in one product
        self._looks = [np.array([a, b, mean]) for a, b in zip(self._ahead, self._alive)]
        self._seen = np.zeros(3)
        self._belief = np.zeros(spec.states)
        self._other = np.zeros(spec.states)
        self.reset()

    @property
    def belief(self) -> np.ndarray:
        """The distribution over the states now (not a copy)."""
        return self._belief

    def reset(self) -> None:
        """Return to the initial state."""
        self._belief[:] = 0.0
        self._belief[self._initial] = 1.0

    def advance(self, quanta: int) -> None:
        """Let time pass; a gap costs as many products as its number of quanta has binary ones."""
        if quanta == 1:
            belief, other = self._belief, self._other
            belief.dot(self._step, other)
            self._belief, self._other = other, belief
            return
        bit = 0
        while quanta:
            if bit == len(self._powers):
                square = self._powers[-1] @ self._powers[-1]
                square /= square.sum(axis=1, keepdims=True)
                self._powers.append(square)
            if quanta & 1:
                np.dot(self._belief, self._powers[bit], out=self._other)
                self._belief, self._other = self._other, self._belief
            quanta >>= 1
            bit += 1

    def observe(self, consistent: Optional[np.ndarray]) -> bool:
        """Keep only the states consistent with the inputs; ``False``: none had any weight.

        Args:
            consistent: one 1.0 or 0.0 per state; None: all.
        """
        if consistent is None:
            return True
        np.multiply(self._belief, consistent, out=self._other)
        largest = self._other.max()
        if largest > 0.0:
            self._other /= largest  # a sum of 1e-300 would overflow its reciprocal
            self._other /= self._other.sum()
            self._belief, self._other = self._other, self._belief
            return True
        states = np.flatnonzero(consistent)
        worst = (
            min(self.fail)
            if not len(states)
            else int(states[int(np.argmax(self._ahead[-1][states]))])
        )
        self._belief[:] = 0.0
        self._belief[worst] = 1.0
        return False

    def estimate(
        self,
        moment: Moment,
        consistent: Optional[np.ndarray] = None,
        unknown: Tuple[str, ...] = (),
        reason: str = "",
    ) -> Estimate:
        """Return what lies ahead of the present belief.

        Args:
            moment: tells the horizon.
            consistent: states that are possible, for bounds when inputs are unknown.
            unknown: names of these inputs.
            reason: why the result cannot be trusted.
        """
        if not unknown:
            p, r, mean = self._looks[moment.at].dot(self._belief, self._seen).tolist()
            if self._is_endless and self._belief[self._endless].any():
                mean = math.inf
            p = min(p, 1.0)
            return Estimate(p, p, r, mean, (), reason)
        at = slice(None) if consistent is None else consistent > 0.0
        ahead, alive = self._ahead[moment.at][at], self._alive[moment.at][at]
        low, high = float(ahead.min(initial=1.0)), float(ahead.max(initial=0.0))
        least = float(self.tau[at].min(initial=math.inf))
        return Estimate(low, high, float(alive.min(initial=1.0)), least, unknown, reason)


def _ahead(q: np.ndarray, fail: Sequence[int], horizons: Horizons) -> Tuple[np.ndarray, np.ndarray]:
    """Return (horizons, states): failed within the horizon, and not failed."""
    step = propagator(q, horizons.step)
    failed: FrozenSet[int] = frozenset(fail)
    is_fail = np.array([float(i in failed) for i in range(len(q))])
    if horizons.steps == 1:
        return (step @ is_fail)[np.newaxis], (step @ (1.0 - is_fail))[np.newaxis]
    rows, alive = [is_fail], [1.0 - is_fail]
    for _ in range(horizons.steps):
        rows.append(step @ rows[-1])
        alive.append(step @ alive[-1])
    return np.array(rows), np.array(alive)
