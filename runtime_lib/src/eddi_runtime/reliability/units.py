"""Equal units, of which some are needed: satellites, cells, redundant sensors."""

from __future__ import annotations

import math

from .component import Component, Estimate, Known, Moment, Values


class KOutOfN(Component):
    """How many units are available is observed."""

    def __init__(self, k: int, rate: float, largest: int | None, name: str) -> None:
        self._k, self._rate, self._largest, self._name = k, rate, largest, name

    def step(self, values: Values, moment: Moment, known: Known) -> Estimate:
        del known
        units = values[self._name]
        if units is not None:
            p, r = self._failure(int(units), moment.horizon)
            return Estimate(p, p, r, self._life(int(units)))
        best = 0.0 if self._largest is None else self._failure(self._largest, moment.horizon)[0]
        return Estimate(best, 1.0, 0.0, 0.0, (self._name,))

    def _failure(self, n: int, hours: float) -> tuple[float, float]:
        if n < self._k:
            return 1.0, 0.0
        q, w = -math.expm1(-self._rate * hours), math.exp(-self._rate * hours)
        terms = [_chance(n, i, q, w) for i in range(n + 1)]
        return min(1.0, math.fsum(terms[: self._k])), min(1.0, math.fsum(terms[self._k :]))

    def _life(self, n: int) -> float:
        if self._rate == 0.0 and n >= self._k:
            return math.inf
        return math.fsum(1.0 / (i * self._rate) for i in range(self._k, n + 1))


def _chance(n: int, i: int, q: float, w: float) -> float:
    """Return the probability that i of n units work, each with w."""
    try:
        return float(math.comb(n, i)) * w**i * q ** (n - i)
    except OverflowError:  # it is of many units
        ways = math.lgamma(n + 1) - math.lgamma(i + 1) - math.lgamma(n - i + 1)
        return math.exp(ways + i * math.log(w) + (n - i) * math.log(q)) if q and w else 0.0
