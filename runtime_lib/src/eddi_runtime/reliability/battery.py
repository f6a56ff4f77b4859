"""A battery in bands of charge, in use and in recovery (SafeDrones, Aslansefat et al. 2022)."""

from __future__ import annotations

import math
from itertools import accumulate, repeat
from operator import mul
from typing import Sequence

from .component import Component, Estimate, Known, Matrix, Moment, Values, dot, factors, sure
from .laws import Arrhenius

_BANDS = {4: 0, 3: 2, 2: 4}
_EMPTY = 6
_STATES = 8
_FAILED: Sequence[float] = (1.0, 0.0)
_PREPARED = 200.0
"""Mean jumps up to which terms are made in advance; a longer time is made of several such ones."""


class Battery(Component):
    """The level selects a band; heat makes the chain run faster (accelerated life).

    Its memory is the band: a known level leaves one state possible, an unknown one all from the
    last band down, until a level comes that is not ignored.

    ``level`` and ``temperature`` are ids of inputs (percent, degC); ``arcs`` those of the chain
    B4, C4, B3, C3, B2, C2, Empty, F with rates in 1/h; ``lives``, ``longest`` (horizon) in hours.
    """

    def __init__(
        self,
        level: str,
        arcs: tuple[tuple[int, int, float], ...],
        lives: tuple[float, ...],
        longest: float,
        *,
        repair: bool = False,
        heat: Arrhenius | None = None,
        temperature: str = "",
    ) -> None:
        self._level, self._repair, self._lives = level, repair, lives
        self._heat, self._hot = heat, None if heat is None else heat.limit(temperature)
        worst = 1.0 if heat is None else heat.factor(heat.hottest)
        self._ahead = FreeHorizon(arcs, longest * worst)
        self._band, self._missed = 4, False

    def step(self, values: Values, moment: Moment, known: Known) -> Estimate:
        level = self._believed(values[self._level])
        factor, colder = 1.0, False
        if self._heat is not None and self._hot is not None:
            hot, is_known = self._hot.most(values, self)
            colder = not is_known  # it may be so cold that nothing ages
            factor = self._heat.factor(hot)
        first = _BANDS.get(self._band, _EMPTY)
        hours = factor * moment.horizon
        if level is not None and not colder:
            fails, works = self._ahead.of(first, hours)
            return sure(fails, works, self._life(first, factor))
        possible = range(first, first + 1)
        if level is None:  # with repair it may have been charged
            possible = range(0 if self._repair else first, _STATES)
        failed, working = zip(*[self._ahead.of(state, hours) for state in possible])
        low = float(possible[0] >= _EMPTY) if colder else min(failed)
        missing = [self._level] if level is None else []
        missing += [self._hot.name] if colder and self._hot is not None else []
        life = min([self._life(state, factor) for state in possible])
        return Estimate(low, max(failed), min(working), life, tuple(missing))

    def _life(self, state: int, factor: float) -> float:
        life = self._lives[state]
        return life / factor if factor > 0.0 and life > 0.0 else life

    def _believed(self, level: float | None) -> float | None:
        """Return the level, None where the band is not known either."""
        if level is None:
            self._missed = self._band in _BANDS  # what is empty cannot sink
            return None
        band = 4 if level > 75 else 3 if level > 50 else 2 if level > 25 else 1
        if band > self._band and not self._repair:
            self.report_fault(
                self._level, "it rises to a higher band; ignored without `repair: true`"
            )
            return None if self._missed else level
        self._band, self._missed = band, False
        return level

    def reset(self) -> None:
        super().reset()
        self._band, self._missed = 4, False
        if self._hot is not None:
            self._hot.reset()


class FreeHorizon:
    """Failed and alive after a time that only the step knows: uniformisation (Jensen 1953).

    What happens in so many jumps is found once; a step weights it. ``longest``: hours, as usual.
    """

    def __init__(self, arcs: Sequence[tuple[int, int, float]], longest: float) -> None:
        exits = [math.fsum(rate for a, _, rate in arcs if a == i) for i in range(_STATES)]
        self._fastest, whole = max(exits), max(exits) or 1.0
        self._jump = [[0.0] * _STATES for _ in exits]
        for source, target, rate in arcs:
            self._jump[source][target] += rate / whole
        for state, rate in enumerate(exits):
            self._jump[state][state] += max(1.0 - rate / whole, 0.0)
        self._limit = min(max(self._fastest * longest, 0.01), _PREPARED)
        # beside the tail of the distribution: as many jumps as lead to F, with all their digits
        self._count = math.ceil(self._limit + 28.0 + 10.0 * math.sqrt(self._limit))
        self._shares = [1.0 / k for k in range(1, self._count + 1)]
        alive = [float(state < _EMPTY) for state in range(_STATES)]
        failed = [1.0 - chance for chance in alive]
        self._terms = list(zip(self._moved(failed), self._moved(alive)))
        self._powers: list[Matrix] = []
        self._hours = -1.0

    def _moved(self, column: list[float]) -> list[tuple[float, ...]]:
        """Return for each state the entries of a vector after 0, 1, 2, ... jumps."""
        columns = [column]
        for _ in range(self._count):
            columns.append([dot(row, columns[-1]) for row in self._jump])
        return list(zip(*columns))

    def of(self, state: int, hours: float) -> Sequence[float]:
        """Return how probable it is to have failed, and to be alive, after hours from a state."""
        if hours != self._hours:
            self._hours = hours
            whole, mean = divmod(min(self._fastest * hours, 1e300), self._limit)
            self._whole, self._weights = int(whole), self._poisson(mean)
            self._found = dict.fromkeys(range(_EMPTY, _STATES), _FAILED)
        if state not in self._found:
            ends = self._ends(state)
            self._found[state] = [end / sum(ends) for end in ends]
        return self._found[state]

    def _ends(self, state: int) -> list[float]:
        if not self._whole:
            return [dot(self._weights, terms) for terms in self._terms[state]]
        row: Sequence[float] = [float(part == state) for part in range(_STATES)]
        if not self._powers:  # the transitions in the longest time for which terms were made
            weights = self._poisson(self._limit)
            units = ([float(i == j) for i in range(_STATES)] for j in range(_STATES))
            columns = [[dot(weights, part) for part in self._moved(unit)] for unit in units]
            self._powers = [[[part / sum(row) for part in row] for row in zip(*columns)]]
        for power in factors(self._powers, self._whole):
            row = [dot(row, column) for column in zip(*power)]
        ends = [[dot(self._weights, term) for term in terms] for terms in self._terms]
        return [dot(row, column) for column in zip(*ends)]

    def _poisson(self, mean: float) -> list[float]:
        grows = map(mul, self._shares, repeat(mean))
        return list(accumulate(grows, mul, initial=math.exp(-mean)))
