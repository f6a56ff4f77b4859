"""Windows against a reference: distances from ranks, and their laws.

F (reference, n values) and G (window, m values) count what is <= a point. This holds with ties
too, so that equal samples have distance 0, also where sensors give few different values. For each
value of a window, *lower* is how many reference values are below it and *upper* how many are not
above it. Notation: K tests, N = n + m, b = 1..m. Each statistic is a function of

- lower: whole numbers (..., K, m), in any order along m;
- upper: the same shape; ``None`` when no window value is in the reference;
- counts: (..., K, m), ascending: how many window values are not above each one; ``None`` when all
  values of a window differ.
"""

from __future__ import annotations

import math
from bisect import bisect_left, bisect_right
from typing import Callable, Mapping, Optional, Sequence, SupportsFloat, Tuple, Union

import numpy as np

from .arrays import NUMPY, Array, Backend

_EXACT = 2**61  # sums below this are made of 64-bit integers, larger ones of doubles


class KolmogorovSmirnov:
    """The largest difference of F and G as the whole number n m D: exact, also with ties."""

    def __init__(self, backend: Backend, reference: Array, m: int) -> None:
        self._backend = backend
        self._n, self._m = int(reference.shape[1]), m
        self._ascending = backend.array(self._n * np.arange(1, m + 1, dtype=np.int64))

    def __call__(self, lower: Array, upper: Array | None, counts: Array | None) -> Array:
        backend = self._backend
        gaps = self._ascending - self._m * backend.sort(lower)
        above = gaps if upper is None else self._ascending - self._m * backend.sort(upper)
        return backend.larger(backend.highest(above), self._n - backend.lowest(gaps))


class CramerVonMises:
    """T = n m / N^2 times the sum of (F - G)^2 over the pooled sample (Anderson 1962).

    n m N^2 T is a whole number; it is added up exactly while it fits into 64 bits.
    """

    def __init__(self, backend: Backend, reference: Array, m: int) -> None:
        self._backend = backend
        tests, n = (int(size) for size in reference.shape)
        self._n, self._m = n, m
        self._whole = 2 * m * m * n**3 < _EXACT
        rho = np.stack([np.searchsorted(row, row, side="right") for row in reference])
        rho = rho.astype(np.int64 if self._whole else np.float64)
        sums = np.concatenate([np.zeros((tests, 1), rho.dtype), np.cumsum(rho, axis=1)], axis=1)
        whole = m * m * (rho * rho).sum(axis=1) - 2 * n * m * m * sums[:, -1]
        cube = n * n * n * m * m
        self._constant = backend.array(whole + (cube if self._whole else float(cube)))
        self._sums = backend.array(sums.ravel())
        self._rows = backend.array(np.arange(tests, dtype=np.int64)[:, None] * (n + 1))
        self._b = backend.array(np.arange(1, m + 1, dtype=np.int64))

    def __call__(self, lower: Array, upper: Array | None, counts: Array | None) -> Array:
        n, m = self._n, self._m
        low = self._backend.sort(lower)
        high = low if upper is None else self._backend.sort(upper)
        gaps = self._number(m * high - n * (self._b if counts is None else counts))
        passed = self._sums[low + self._rows]
        scaled = (
            (gaps * gaps).sum(-1)
            + 2 * n * m * passed.sum(-1)
            - n * n * self._number((2 * self._b - 1) * low).sum(-1)
            + self._constant
        )
        return self._backend.doubles(scaled) / float(n * m * (n + m) ** 2)

    def _number(self, values: Array) -> Array:
        return values if self._whole else self._backend.doubles(values)


class AndersonDarling:
    """A2, in time independent of n but for the values that are repeated in the reference.

    A2 = 1/(n m) x sum over the distinct pooled values but the last of l (N M - n B)^2 /
    (B (N - B)): l values equal it, B are not above it, M of these are in the reference (Scholz
    and Stephens 1987, A2kN, equation 6). While F is passed with u window values behind, N M - n B
    = m B - N u, and the summand is  -m^2 + N (m - u)^2 / (N - B) + N u^2 / B.  So a stretch of
    untied reference values is a difference of harmonic numbers, and a step need not walk over the
    reference.
    """

    def __init__(self, backend: Backend, reference: Array, m: int) -> None:
        self._backend = backend
        self._n, self._m = int(reference.shape[1]), m
        self._total = self._n + m
        harmonic = np.concatenate([[0.0], np.cumsum(1.0 / np.arange(1, self._total + 1))])
        self._harmonic = backend.array(harmonic)
        self._one = backend.array(np.int64(1))
        self._before = float(harmonic[self._total - 1])
        self._all = float(harmonic[self._total])
        self._b = backend.array(np.arange(1, m + 1, dtype=np.int64))
        self._ahead = backend.array(2.0 * np.arange(1, m + 1) - 1.0)
        self._behind = backend.array(2.0 * np.arange(m, 0, -1) - 1.0)
        below, size = _tied_groups(reference)
        self._ties = size.size > 0
        self._below, self._size = backend.array(below), backend.array(size)

    def __call__(self, lower: Array, upper: Array | None, counts: Array | None) -> Array:
        low = self._backend.sort(lower)
        high = low if upper is None else self._backend.sort(upper)
        if upper is None and counts is None:
            scaled = self._without_ties(low)
        else:
            scaled = self._with_ties(low, high, self._b if counts is None else counts)
        if self._ties:
            scaled = scaled + self._corrections(low, high)
        return scaled / float(self._n * self._m)

    def _h(self, index: Array) -> Array:
        return self._harmonic[index]

    def _without_ties(self, low: Array) -> Array:
        """Return n m A2 as Pettitt (1976) writes it."""
        m, total = self._m, self._total
        place = low + self._b
        sums = self._h(place - 1) * self._ahead + self._h(total - place) * self._behind
        constant = 2.0 * m * m * self._before - m * m * (total - 1.0) / total
        return total * (constant - sums.sum(-1))

    def _with_ties(self, low: Array, high: Array, counts: Array) -> Array:
        """Return n m A2: window values, and the stretches of the reference around them."""
        m, total = self._m, self._total
        first, last = low[..., 0], high[..., -1]
        outside = total * m * m * (self._before - self._h(total - 1 - first)) - m * m * first
        outside = outside + total * m * m * (self._all - self._h(last + m))
        outside = outside - m * m * (self._n - last)
        start, u = high[..., :-1], counts[..., :-1]
        # inside a group of equal window values the stretch is empty
        end = self._backend.larger(low[..., 1:], start)
        inside = self._h(end + u) - self._h(start + u)
        inside = inside * (total * u * u) - m * m * (end - start)
        below = self._h(total - 1 - start - u) - self._h(total - 1 - end - u)
        inside = inside + below * (total * (m - u) * (m - u))
        weights = 1 + (high - low) * (counts == self._b)
        points = weights * self._summand(high + counts, counts)
        return outside + inside.sum(-1) + points.sum(-1)

    def _summand(self, passed: Array, u: Array) -> Array:
        m, total, doubles = self._m, self._total, self._backend.doubles
        left = self._backend.larger(total - passed, self._one)  # 0 where u = m
        ahead = doubles(total * (m - u) * (m - u)) / doubles(left)
        return ahead + doubles(total * u * u) / doubles(passed) - m * m

    def _corrections(self, low: Array, high: Array) -> Array:
        """Return what tied reference values add to n m A2 beyond as many untied ones."""
        m, total, doubles, start = self._m, self._total, self._backend.doubles, self._below
        u = self._at_most(low, start)
        between = u == self._at_most(high, start)  # else it equals a window value: a point
        start = start + u
        end = start + self._size
        left, size = self._backend.larger(total - end, self._one), doubles(self._size)
        behind = self._h(total - 1 - start) - self._h(total - 1 - end)
        ahead = self._h(end) - self._h(start)
        more = (size / doubles(left) - behind) * (total * (m - u) * (m - u))
        more = more + (size / doubles(end) - ahead) * (total * u * u)
        return (more * between).sum(-1)

    def _at_most(self, ranks: Array, bounds: Array) -> Array:
        """Count in each row of ascending ranks (..., K, m) what is <= each bound (K, Q)."""
        shape = tuple(ranks.shape[:-1])
        count = int(np.prod(shape))
        rows = self._backend.array(np.arange(count, dtype=np.int64).reshape((*shape, 1)))
        # one ascending sequence of all rows: ranks reach from 0 to n
        apart = rows * (self._n + 2)
        places = self._backend.positions((ranks + apart).reshape(-1), bounds + apart)
        return places - rows * self._m


def _tied_groups(reference: Array) -> tuple[Array, Array]:
    """Return what is below each repeated value of a row, and how often it is there: (K, Q)."""
    groups = []
    for row in reference:
        bounds = np.flatnonzero(np.concatenate([[True], row[1:] != row[:-1], [True]]))
        sizes = np.diff(bounds)
        groups.append((bounds[:-1][sizes > 1], sizes[sizes > 1]))
    longest = max(len(sizes) for _, sizes in groups)
    below = np.zeros((len(groups), longest), dtype=np.int64)
    size = np.ones((len(groups), longest), dtype=np.int64)
    for k, (starts, sizes) in enumerate(groups):
        below[k, : len(starts)] = starts
        size[k, : len(sizes)] = sizes
    return below, size


class Kolmogorov:
    """The asymptotic law of the Kolmogorov-Smirnov distance D for samples of n and m."""

    def __init__(self, n: int, m: int) -> None:
        self._scale = math.sqrt(n * m / (n + m))

    def __call__(self, value: float) -> float:
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

    ``slope``: growth of the critical value per unit of -ln(level) beyond the last of the points.
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
"""Probability of a statistic or a larger one, when window and reference have the same law."""


_Statistic = Callable[[Array, Optional[Array], Optional[Array]], Array]
_STATISTICS: Mapping[str, Callable[[Backend, Array, int], _Statistic]] = {
    "ks": KolmogorovSmirnov,
    "cvm": CramerVonMises,
    "ad": AndersonDarling,
}


class Comparison:
    """Statistics of windows of ``m`` values against fixed references, one per test.

    ``reference``: (K, n) of numpy, float64, each row ascending; all arrays are of ``backend``.
    """

    def __init__(self, metric: str, reference: Array, m: int, backend: Backend = NUMPY) -> None:
        self.metric, self.backend, self.m = metric, backend, m
        self.tests, self.n = (int(size) for size in reference.shape)
        self.reference = backend.array(reference)
        # (lower, upper, counts) -> the statistics (..., K); see ``statistics``
        self.of_ranks: _Statistic = _STATISTICS[metric](backend, reference, m)

    def counts(self, windows: Array) -> Array | None:
        """Return how many values of a window are <= each one, ascending; None if all differ."""
        if self.metric == "ks":
            return None  # not asked for
        rows = self.backend.sort(windows)
        if not bool((rows[..., 1:] == rows[..., :-1]).any()):
            return None
        flat = rows.reshape(-1, self.m)
        return self.backend.ranks(flat, flat, equal=True).reshape(rows.shape)

    def value(self, statistic: SupportsFloat) -> float:
        """Return a statistic on its usual scale: D = n m D / (n m) for Kolmogorov-Smirnov."""
        return float(statistic) / (self.n * self.m) if self.metric == "ks" else float(statistic)


_Ranks = Tuple[Array, Array, int]


class Window:
    """The last ``m`` values of each test, as ranks; nothing is added up, so nothing drifts."""

    def __init__(self, comparison: Comparison) -> None:
        self._comparison = comparison
        backend, shape = comparison.backend, (comparison.tests, comparison.m)
        self._lower = backend.array(np.zeros(shape, dtype=np.int64))
        self._upper = backend.array(np.zeros(shape, dtype=np.int64))
        self._values = backend.array(np.full(shape, np.nan))
        self._ranks = _look_up(comparison)
        self._needs_values = comparison.metric != "ks"
        self.clear()

    def clear(self) -> None:
        self.filled = 0
        self._at = 0
        self._ties = [0] * self._comparison.m  # with the reference, per column
        self._tied = 0
        self._equal = 0  # pairs of equal values inside the window
        self._values[:] = float("nan")

    @property
    def is_full(self) -> bool:
        return self.filled == self._comparison.m

    def push(self, sample: Array) -> None:
        """Take over one value per test (numpy, float64, finite); the oldest one goes."""
        at, m = self._at, self._comparison.m
        lower, upper, ties = self._ranks(sample)
        self._lower[:, at] = lower
        self._upper[:, at] = upper
        self._tied += ties - self._ties[at]
        self._ties[at] = ties
        if self._needs_values:
            values, count = self._values, self._comparison.backend.count
            if self.is_full:  # else the column is NaN, which equals nothing
                self._equal -= count(values == values[:, at : at + 1]) - self._comparison.tests
            values[:, at] = self._comparison.backend.array(sample)
            self._equal += count(values == values[:, at : at + 1]) - self._comparison.tests
        self._at = at + 1 if at + 1 < m else 0
        self.filled = min(m, self.filled + 1)

    def statistics(self) -> Array:
        comparison = self._comparison
        counts = comparison.counts(self._values) if self._equal else None
        upper = self._upper if self._tied else None
        numbers = comparison.of_ranks(self._lower, upper, counts)
        return comparison.backend.numpy(numbers)


def _look_up(comparison: Comparison) -> Callable[[Array], _Ranks]:
    """Return the function that finds (lower, upper, how many differ) of one value per test."""
    backend, reference = comparison.backend, comparison.reference
    if backend.name == "numpy":
        return _in_lists(reference.tolist())

    def in_arrays(sample: Array) -> _Ranks:
        column = backend.array(sample.reshape(-1, 1))
        lower = backend.ranks(reference, column, equal=False)
        upper = backend.ranks(reference, column, equal=True)
        return lower[:, 0], upper[:, 0], backend.count(lower != upper)

    return in_arrays


def _in_lists(rows: list[list[float]]) -> Callable[[Array], _Ranks]:
    n = len(rows[0])

    def look_up(sample: Array) -> _Ranks:
        values = sample.tolist()
        lower = upper = [bisect_left(row, value) for row, value in zip(rows, values)]
        ties = 0
        for k, place in enumerate(lower):
            if place < n and rows[k][place] == values[k]:
                upper = upper if ties else lower.copy()
                upper[k] = bisect_right(rows[k], values[k], place)
                ties += 1
        return lower, upper, ties

    return look_up
