"""A Markov chain in time: its state belief, what is observed of it, and what lies ahead."""

from __future__ import annotations

import math
from operator import mul
from typing import Callable, Collection, Sequence, Tuple

from .component import Estimate, Matrix, Moment, dot, factors, sure

INCONSISTENT = "inconsistent"
_LEAST = 1e-8  # weight of the belief below which it is brought back to one

Belief = Sequence[float]
Row = Tuple[float, float, float]
"""Of a state: failed within the horizon, alive all the time, mean life in hours."""
_LOST: Row = (1.0, 0.0, 0.0)
Look = Sequence[float]
"""Failed, alive, mean life, weight of states that live for ever, weight of all."""


class Seen:
    """What is observed in a step, and what follows from it; kept for steps that see the same."""

    def __init__(self, chain: Chain, states: Collection[int]) -> None:
        self.states = tuple(sorted(states))  # those that are consistent with the inputs
        # one 1.0 or 0.0 per state, whether it is one of them; ``whole``: all are
        self.mask = tuple([float(state in states) for state in range(chain.states)])
        self.whole = len(states) == chain.states
        rows = chain.rows(-1)
        # the state that is taken when the belief gives all consistent ones no weight
        self.worst = max(self.states or chain.fail, key=lambda state: rows[state][0])
        failed = len(set(chain.fail).intersection(states))
        self.fatal, self.alive = 0 < failed == len(states), failed == 0 < len(states)
        self.unknown: tuple[str, ...] = ()  # inputs that are not known
        # possible observations with what is not known; the others are made of these
        self.completions: tuple[Seen, ...] = ()
        # position of a horizon -> failed at least and at most, alive and mean life at least
        self.bounds: dict[int, tuple[float, float, float, float]] = {}


class Chain:
    """The belief over the states of a chain of few states, whose sums are written out.

    It has any weight up to one: results are divided by it, and it is seldom brought back.
    """

    first: tuple[float, ...]  # belief at the start of the mission
    fail: tuple[int, ...]  # numbers of the fail states
    # what lies ahead of each state; with ``grid`` for a horizon of no length
    ahead: tuple[Row, ...]
    # transitions in one of ``steps`` steps to the longest horizon; empty: one horizon
    grid: Matrix = ()
    steps = 1
    quantum: Callable[[Belief], Belief]  # returns a belief one quantum later

    def __init__(self) -> None:
        self.states = len(self.first)
        self._rows: list[Sequence[Row]] = [self.ahead]
        for _ in range(self.steps if self.grid else 0):
            failed, alive, lives = zip(*self._rows[-1])
            after = [(min(dot(row, failed), 1.0), dot(row, alive)) for row in self.grid]
            self._rows.append([(*ends, life) for ends, life in zip(after, lives)])
        self._powers: list[Matrix] = []
        self.everything = Seen(self, range(self.states))  # no input excludes a state
        self.reset()

    def look(self, belief: Belief, at: int) -> Look:
        failed, alive, lives = zip(*self.rows(at))
        mean = sum([w * life for w, life in zip(belief, lives) if life < math.inf])
        endless = sum([w for w, life in zip(belief, lives) if life == math.inf])
        return dot(belief, failed), dot(belief, alive), mean, endless, sum(belief)

    def rows(self, at: int) -> Sequence[Row]:
        """Return what lies ahead of each state for one of the prepared horizons."""
        return self._rows[at]

    @property
    def belief(self) -> list[float]:
        whole = sum(belief := self.weights())
        return [weight / whole for weight in belief]

    def weights(self) -> Belief:
        return self._belief

    def believe(self, belief: Belief) -> None:
        self._belief: Belief = belief

    def sure_of(self, state: int) -> list[float]:
        return [float(k == state) for k in range(self.states)]

    def reset(self) -> None:
        self.believe(self.first)

    def after(self, beliefs: list[Belief], quanta: int) -> list[Belief]:
        if quanta == 1:
            return [self.quantum(belief) for belief in beliefs]
        self._powers = self._powers or [
            [self.quantum(self.sure_of(i)) for i in range(self.states)]
        ]
        for power in factors(self._powers, quanta):
            beliefs = [[dot(belief, column) for column in zip(*power)] for belief in beliefs]
        return beliefs

    def bounds(self, beliefs: list[Belief], at: int, reason: str = "") -> Estimate:
        """Return what lies ahead at a prepared horizon if one of several beliefs is right."""
        rows: list[Row] = []
        for belief in beliefs:
            failing, living, mean, endless, weight = self.look(belief, at)
            life = math.inf if endless > 0.0 else mean / weight
            rows.append((min(failing / weight, 1.0), living / weight, life))
        failed, alive, lives = zip(*rows)
        return Estimate(min(failed), max(failed), min(alive), min(lives), (), reason)

    def bounded(self, seen: Seen, at: int, reason: str = "") -> Estimate:
        """Return what lies ahead if any state that is consistent may be the right one."""
        kept = seen.bounds.get(at)
        if kept is None:
            rows = self.rows(at)
            failed, alive, lives = zip(*([rows[state] for state in seen.states] or [_LOST]))
            # that no state is left is a failure
            lost = seen.alive and not all(completion.states for completion in seen.completions)
            worst = _LOST if lost else (max(failed), min(alive), min(lives))
            kept = seen.bounds[at] = (min(failed), *worst)
        return Estimate(*kept, seen.unknown, reason)

    def step(self, moment: Moment, seen: Seen) -> Estimate:
        at = moment[4]
        failed, alive, mean, endless, weight = self.moved(moment[0], at, seen)
        reason = ""
        if weight < _LEAST:
            reason = "" if self._restored(seen.worst) else INCONSISTENT
            failed, alive, mean, endless, weight = self.look(self.weights(), at)
        p = failed / weight if failed < weight else 1.0
        return sure(p, alive / weight, math.inf if endless else mean / weight, reason)

    def moved(self, quanta: int, at: int, seen: Seen) -> Look:
        """Let time pass, keep the states that are consistent; return the look ahead."""
        belief = self._belief
        if quanta:
            belief = self.quantum(belief) if quanta == 1 else self.after([belief], quanta)[0]
        if not seen.whole:
            belief = tuple(map(mul, belief, seen.mask))
        self._belief = belief
        return self.look(belief, at)

    def _restored(self, worst: int) -> bool:
        """Bring the weight back to one; there is none: ``worst`` is believed, ``False``."""
        belief = self.weights()
        largest = max(belief)
        if largest > 0.0:
            scaled = [weight / largest for weight in belief]  # the sum of 1e-300 is too small
            whole = sum(scaled)
            self.believe([weight / whole for weight in scaled])
            return True
        self.believe(self.sure_of(worst))
        return False
