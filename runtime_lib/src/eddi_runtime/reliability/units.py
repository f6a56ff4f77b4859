"""Parts of which all are needed, and equal units of which some are: cells, satellites."""

from __future__ import annotations

import math

from .component import NAN, Component, Estimate, Known, Moment, Values


class KOutOfN(Component):
    """How many units are available is observed."""

    def __init__(self, k: int, rate: float, largest: int | None, name: str) -> None:
        self._k, self._rate, self._largest, self._name = k, rate, largest, name

    def step(self, values: Values, moment: Moment, known: Known) -> Estimate:
        units = values[self._name]
        if units is not None:
            p, r = self._failure(int(units), moment.horizon)
            steps = range(self._k, int(units) + 1)
            endless = self._rate == 0.0 and units >= self._k
            life = math.inf if endless else math.fsum(1.0 / (i * self._rate) for i in steps)
            return Estimate(p, p, r, life)
        best = 0.0 if self._largest is None else self._failure(self._largest, moment.horizon)[0]
        return Estimate(best, 1.0, 0.0, 0.0, (self._name,))

    def _failure(self, n: int, hours: float) -> tuple[float, float]:
        if n < self._k:
            return 1.0, 0.0
        q, w = -math.expm1(-self._rate * hours), math.exp(-self._rate * hours)
        terms = [_chance(n, i, q, w) for i in range(n + 1)]
        return min(1.0, math.fsum(terms[: self._k])), min(1.0, math.fsum(terms[self._k :]))


def _chance(n: int, i: int, q: float, w: float) -> float:
    """Return the probability that i of n units work, each with w."""
    try:
        return float(math.comb(n, i)) * w**i * q ** (n - i)
    except OverflowError:  # it is of many units
        ways = math.lgamma(n + 1) - math.lgamma(i + 1) - math.lgamma(n - i + 1)
        return math.exp(ways + i * math.log(w) + (n - i) * math.log(q)) if q and w else 0.0


class Series(Component):
    """Fails as soon as one of its parts does."""

    def __init__(self, *parts: str) -> None:
        self._parts = parts

    def step(self, values: Values, moment: Moment, known: Known) -> Estimate:
        parts = [known[name] for name in self._parts]
        low, high = _any_of([p.low for p in parts]), _any_of([p.high for p in parts])
        unknown = tuple(dict.fromkeys(name for part in parts for name in part.unknown))
        reason = next((part.reason for part in parts if part.reason), "")
        alive = math.prod(part.reliability for part in parts)
        mttf = parts[0].mttf if len(parts) == 1 else NAN
        return Estimate(low, high, alive, mttf, unknown, reason)


def _any_of(failures: list[float]) -> float:
    if any(p >= 1.0 for p in failures):
        return 1.0
    return -math.expm1(math.fsum(math.log1p(-p) for p in failures)) + 0.0  # never -0.0
