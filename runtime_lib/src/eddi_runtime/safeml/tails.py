"""Probability of a statistic or a larger one, when window and reference have the same law."""

from __future__ import annotations

import math
from bisect import bisect_right
from typing import Sequence, Union


class Kolmogorov:
    """The asymptotic law of the Kolmogorov-Smirnov distance D for samples of n and m."""

    def __init__(self, n: int, m: int) -> None:
        self._scale = math.sqrt(n * m / (n + m))

    def __call__(self, value: float) -> float:
        """Return the probability of at least this distance."""
        x = value * self._scale
        if x < 0.2:
            return 1.0  # the series converges slowly there, and is 1 to 12 digits
        series, sign = 0.0, 1.0
        for j in range(1, 101):
            term = math.exp(-2.0 * (j * x) ** 2)
            series, sign = series + sign * term, -sign
            if term < 1e-17:
                break
        return min(1.0, max(0.0, 2.0 * series))


class Interpolated:
    """A law by its critical values: the logarithm of the level is linear between them.

    Args:
        points: (critical value, level), ascending; none: every probability is 1.
        slope: growth of the critical value per unit of -ln(level) beyond the last one.
    """

    def __init__(self, points: Sequence[tuple[float, float]], slope: float) -> None:
        self._values = [value for value, _ in points]
        self._levels = [level for _, level in points]
        self._slope = slope

    def __call__(self, value: float) -> float:
        """Return the probability of at least this statistic, 1 below the first critical value."""
        k = bisect_right(self._values, value)
        if k == 0:
            return 1.0
        low, level = self._values[k - 1], self._levels[k - 1]
        if k == len(self._values):
            return level * math.exp(-(value - low) / self._slope)
        share = (value - low) / (self._values[k] - low)
        return level * math.exp(-share * math.log(level / self._levels[k]))


Tail = Union[Kolmogorov, Interpolated]
