"""Windows against a reference, whatever the statistic."""

from __future__ import annotations

from bisect import bisect_left, bisect_right
from typing import Callable, Mapping, Optional, SupportsFloat, Tuple

import numpy as np

from .arrays import NUMPY, Array, Backend
from .statistics import AndersonDarling, CramerVonMises, KolmogorovSmirnov

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


_MOST_LISTED = 64
"""Tests up to which Python's own bisection, one after the other, is faster than all at once."""

_Ranks = Tuple[Array, Array, int]


class Window:
    """The last ``m`` values of each test, as ranks that are kept up to date.

    A value is looked up in the reference once, when it comes. Whole numbers and values are
    replaced as a whole: nothing is added up over time, so nothing drifts.
    """

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
            self._keep(at, sample)
        self._at = at + 1 if at + 1 < m else 0
        self.filled = min(m, self.filled + 1)

    def _keep(self, at: int, sample: Array) -> None:
        values, count = self._values, self._comparison.backend.count
        if self.is_full:  # else the column is NaN, which equals nothing
            self._equal -= count(values == values[:, at : at + 1]) - self._comparison.tests
        values[:, at] = self._comparison.backend.array(sample)
        self._equal += count(values == values[:, at : at + 1]) - self._comparison.tests

    def statistics(self) -> Array:
        comparison = self._comparison
        counts = comparison.counts(self._values) if self._equal else None
        upper = self._upper if self._tied else None
        found = comparison.of_ranks(self._lower, upper, counts)
        return comparison.backend.numpy(found)


def _look_up(comparison: Comparison) -> Callable[[Array], _Ranks]:
    """Return the function that finds (lower, upper, how many differ) of one value per test."""
    backend, reference = comparison.backend, comparison.reference
    if backend.name == "numpy":
        few = comparison.tests <= _MOST_LISTED
        return _in_lists(reference.tolist()) if few else _in_table(reference)

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


def _in_table(rows: Array) -> Callable[[Array], _Ranks]:
    """Bisect in all rows at once; rows of a power of two, filled up with what equals nothing."""
    tests, n = rows.shape
    steps = [1 << k for k in range(n.bit_length() - 1, -1, -1)]
    width = 2 * steps[0]
    table = np.full((tests, width), np.nan)
    table[:, :n] = rows
    flat = table.ravel()
    begin = np.arange(tests) * width

    def look_up(sample: Array) -> _Ranks:
        place = begin.copy()
        for step in steps:
            place += step * (flat.take(place + (step - 1)) < sample)
        lower = place - begin
        ties = int(np.count_nonzero(flat.take(place) == sample))
        if not ties:
            return lower, lower, 0
        for step in steps:  # from the first equal value to behind the last one
            ahead = np.minimum(place + (step - 1), begin + (width - 1))
            place += step * (flat.take(ahead) == sample)
        return lower, place - begin, ties

    return look_up
