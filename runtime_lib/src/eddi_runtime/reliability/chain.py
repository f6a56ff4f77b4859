"""A Markov chain in time: its state belief, what is observed of it, and what lies ahead."""

from __future__ import annotations

import math
from typing import FrozenSet, Iterator, List, NamedTuple, Optional, Sequence, Tuple

import numpy as np

from .estimate import Estimate, Moment, known
from .markov import Arc, generator, mean_times, propagator
from .seen import Observation, Seen

INCONSISTENT = "inconsistent"
_BLOCK = 16
"""Steps of one quantum that are looked at in one product while the observation stays the same."""
_LARGEST = 500
"""States up to which this is done."""
_LARGEST_SEEN = 64
"""The same for a chain whose states are observed: each observation has matrices of its own."""
_LEAST = 1e-8
"""Weight of the belief below which it is brought back to one."""
_LOOK = 5
"""Numbers of a look ahead: failed, alive, mean life, weight of endless states, weight of all."""


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

    The belief has any weight up to one: results are divided by it, and it is seldom brought back.

    Args:
        spec: the chain.
        quantum: hours.
        horizons: where to look ahead.
        age: hours that it had run, unobserved, before the start of the mission.

    Attributes:
        states: how many there are.
        fail: numbers of the fail states.
        tau: mean time to failure in hours from each state.
        everything: no input excludes a state.
    """

    def __init__(
        self, spec: ChainSpec, quantum: float, horizons: Horizons, age: float = 0.0
    ) -> None:
        self.states, self.fail = spec.states, frozenset(spec.fail)
        self._rates = q = generator(spec.states, spec.arcs, spec.fail)
        self._first = propagator(q, age)[spec.initial].copy()
        self.tau = mean_times(q, spec.fail)
        self._step = propagator(q, quantum)
        self._powers = [self._step]
        self._belief, self._spare = np.zeros(spec.states), np.zeros(spec.states)
        self._out = np.zeros(_BLOCK * _LOOK + spec.states)
        self._looking, self._end = self._out[: _BLOCK * _LOOK], self._out[_BLOCK * _LOOK :]
        self._rows: List[List[float]] = []
        self.prepare(horizons)

    def prepare(self, horizons: Horizons) -> None:
        """Prepare other horizons and return to the start; what was ``seen`` before is void."""
        self._ahead, self._alive = _ahead(self._rates, sorted(self.fail), horizons)
        endless = np.isinf(self.tau)
        rest = [np.where(endless, 0.0, self.tau), endless.astype(float), np.ones(self.states)]
        # failed, alive, mean life, weight of endless states and of all: one product with a belief
        self._looks = [np.column_stack([a, b, *rest]) for a, b in zip(self._ahead, self._alive)]
        block = self._block(None, self._powers)
        self.everything = Seen(None, (), (), min(self.fail), self._powers, block)
        self.reset()

    def _block(self, mask: Optional[np.ndarray], powers: List[np.ndarray]) -> Optional[np.ndarray]:
        largest = _LARGEST if mask is None else _LARGEST_SEEN
        if len(self._looks) > 1 or self.states > largest:
            return None
        ahead = [self._looks[0]]
        for _ in range(_BLOCK - 1):
            ahead.append(powers[0] @ ahead[-1])
        while 2 ** (len(powers) - 1) < _BLOCK:
            powers.append(_squared(powers[-1], mask))
        return np.concatenate([*ahead, powers[-1]], axis=1)

    def seen(self, mask: np.ndarray, unknown: Tuple[str, ...] = ()) -> Seen:
        """Return what follows from an observation; to be kept for the steps that see the same.

        Args:
            mask: one 1.0 or 0.0 per state.
            unknown: names of the inputs that are not known.
        """
        inside = np.flatnonzero(mask)
        powers = [self._step * mask]
        block = self._block(mask, powers)
        _, worst, fatal, alive = self.observation(mask)
        if not len(inside):
            bounds = [(1.0, 1.0, 0.0, 0.0)] * len(self._looks)
            return Seen(mask, unknown, bounds, worst, powers, block, fatal, alive)
        ahead = np.minimum(self._ahead[:, inside], 1.0)
        least = [float(self.tau[inside].min())] * len(ahead)
        columns = (ahead.min(axis=1), ahead.max(axis=1), self._alive[:, inside].min(axis=1))
        bounds = list(zip(*(column.tolist() for column in columns), least))
        return Seen(mask, unknown, bounds, worst, powers, block, fatal, alive)

    def observation(self, mask: np.ndarray) -> Observation:
        """Return the observation by known inputs that leave the states of a mask."""
        inside = np.flatnonzero(mask)
        if not len(inside):
            return Observation(mask, min(self.fail), fatal=False, alive=False)
        worst = int(inside[int(np.argmax(self._ahead[-1][inside]))])
        failed = int(mask[sorted(self.fail)].sum())
        return Observation(mask, worst, failed == len(inside), failed == 0)

    def sure(self, at: int) -> List[Estimate]:
        """Return for each state what lies ahead when the chain is known to be in it.

        Args:
            at: position of the horizon among those that were prepared.
        """
        ahead, alive = np.minimum(self._ahead[at], 1.0).tolist(), self._alive[at].tolist()
        lives = self.tau.tolist()
        return [known(*numbers) for numbers in zip(ahead, alive, lives)]

    @property
    def belief(self) -> np.ndarray:
        """The distribution over the states now."""
        self._settle()
        belief: np.ndarray = self._belief / self._belief.sum()
        return belief

    def reset(self) -> None:
        """Return to the start of the mission."""
        self._seen = self.everything
        self._rows, self._at = [], 0
        self._belief[:] = self._first

    def place(self, state: int) -> None:
        """Believe in one state alone."""
        self.believe(self.sure_of(state))

    def believe(self, belief: np.ndarray) -> None:
        """Take another distribution over the states."""
        self._rows, self._at = [], 0
        self._belief[:] = belief

    def sure_of(self, state: int) -> np.ndarray:
        """Return the belief in one state alone."""
        belief = np.zeros(self.states)
        belief[state] = 1.0
        return belief

    def after(self, beliefs: np.ndarray, quanta: int) -> np.ndarray:
        """Return several beliefs, one in each row, when time has passed unobserved."""
        for power in _factors(quanta, self.everything):
            beliefs = beliefs @ power
        return beliefs

    def bounds(self, beliefs: np.ndarray, at: int, reason: str = "") -> Estimate:
        """Return what lies ahead if one of several beliefs is right.

        Args:
            beliefs: one in each row.
            at: position of the horizon among those that were prepared.
            reason: why the result cannot be trusted.
        """
        failed, alive, mean, endless, weight = (beliefs @ self._looks[at]).T
        p = np.minimum(failed / weight, 1.0)
        life = np.where(endless > 0.0, math.inf, mean / weight)
        low, high, least = float(p.min()), float(p.max()), float((alive / weight).min())
        return Estimate(low, high, least, float(life.min()), (), reason)

    def step(self, moment: Moment, seen: Seen) -> Estimate:
        """Let time pass, keep the states that are consistent with the inputs, look ahead."""
        quanta = moment[0]
        at = self._at + quanta
        rows = self._rows
        # between two steps nothing was observed: with a mask, only single quanta are alike
        if seen is self._seen and at < len(rows) and (quanta < 2 or seen.mask is None):
            self._at = at
            failed, alive, mean, endless, weight = rows[at]
        else:
            failed, alive, mean, endless, weight = self._moved(quanta, moment.at, seen)
        reason = ""
        if weight < _LEAST:
            self._settle()
            reason = "" if self._restored(seen.worst) else INCONSISTENT
            look = self._belief.dot(self._looks[moment.at]).tolist()
            failed, alive, mean, endless, weight = look
        if seen.unknown:
            low, high, least, life = seen.bounds[moment.at]
            return Estimate(low, high, least, life, seen.unknown, reason)
        p = failed / weight if failed < weight else 1.0
        return known(p, alive / weight, math.inf if endless else mean / weight, reason)

    def _moved(self, quanta: int, at: int, seen: Seen) -> List[float]:
        """Return the look ahead; the next ones come with it if this step saw what the last did."""
        again = seen is self._seen
        if again and quanta == 1 and self._at == _BLOCK - 1:
            self._belief[:] = self._end
        else:
            self._settle()
            self._propagate(quanta, self.everything)
            if seen.mask is not None:
                self._belief *= seen.mask
        self._seen, self._at = seen, 0
        if again and seen.block is not None:
            self._belief.dot(seen.block, self._out)
            self._rows = self._looking.reshape(_BLOCK, _LOOK).tolist()
            return self._rows[0]
        look: List[float] = self._belief.dot(self._looks[at]).tolist()
        return look

    def _settle(self) -> None:
        """Let the belief be that of now."""
        at, self._at, self._rows = self._at, 0, []
        self._propagate(at, self._seen)

    def _propagate(self, quanta: int, seen: Seen) -> None:
        for power in _factors(quanta, seen):
            self._belief.dot(power, self._spare)
            self._belief, self._spare = self._spare, self._belief

    def _restored(self, worst: int) -> bool:
        """Bring the weight back to one; ``False``: there is none, ``worst`` is believed now."""
        belief = self._belief
        largest = belief.max()
        if largest > 0.0:
            belief /= largest  # a sum of 1e-300 would overflow its reciprocal
            belief /= belief.sum()
            return True
        self.place(worst)
        return False


def _factors(quanta: int, seen: Seen) -> Iterator[np.ndarray]:
    """Yield the powers of one quantum that make up several: as many as binary ones in them."""
    bit = 0
    while quanta:
        if bit == len(seen.powers):
            seen.powers.append(_squared(seen.powers[-1], seen.mask))
        if quanta & 1:
            yield seen.powers[bit]
        quanta >>= 1
        bit += 1


def _squared(power: np.ndarray, mask: Optional[np.ndarray]) -> np.ndarray:
    square: np.ndarray = power @ power
    if mask is None:  # rows of probabilities; with a mask they have less weight
        square /= square.sum(axis=1, keepdims=True)
    return square


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
