"""The running window: the ranks of its last m values for every test, kept up to date.

A value is looked up in the reference once, when it comes. All that is kept is whole numbers and
the values themselves, each replaced as a whole: nothing is added up over time, so nothing drifts.
"""

from __future__ import annotations

from bisect import bisect_left, bisect_right
from typing import Callable, List, Optional, Tuple

import numpy as np

from .arrays import Array
from .comparison import Comparison

_MOST_LISTED = 2_000_000
"""Reference values that are kept as lists, in which a look-up is fastest (64 MB)."""

_Ranks = Tuple[Array, Array, int]


class Window:
    """The last ``m`` values of each test.

    Args:
        comparison: what the window is compared with.

    Attributes:
        filled: values that are there, at most m.
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
        """Forget all values."""
        self.filled = 0
        self._at = 0
        self._ties = [0] * self._comparison.m  # with the reference, per column
        self._tied = 0
        self._equal = 0  # pairs of equal values inside the window
        if self._needs_values:
            self._values[:] = float("nan")

    @property
    def is_full(self) -> bool:
        """Whether a statistic exists."""
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
        values = self._values
        old = values[:, at : at + 1]
        # NaN equals nothing, so a column that is still empty counts as 0
        self._equal -= int((values == old).sum()) - int((old == old).sum())  # noqa: PLR0124 - NaN
        values[:, at] = self._comparison.backend.array(sample)
        new = values[:, at : at + 1]
        self._equal += int((values == new).sum()) - int(new.shape[0])

    def statistics(self) -> Array:
        """Return the statistic of each test (numpy); the window is full."""
        comparison = self._comparison
        counts = comparison.counts(self._values) if self._equal else None
        upper = self._upper if self._tied else None
        found = comparison.of_ranks(self._lower, upper, counts)
        return comparison.backend.numpy(found)


def _look_up(comparison: Comparison) -> Callable[[Array], _Ranks]:
    """Return the function that finds (lower, upper, how many differ) of one value per test."""
    backend, reference = comparison.backend, comparison.reference
    if backend.name == "numpy" and comparison.tests * comparison.n <= _MOST_LISTED:
        return _in_lists([row.tolist() for row in reference])

    def in_arrays(sample: Array) -> _Ranks:
        column = backend.array(sample.reshape(-1, 1))
        lower = backend.ranks(reference, column, equal=False)
        upper = backend.ranks(reference, column, equal=True)
        return lower[:, 0], upper[:, 0], int((lower != upper).sum())

    return in_arrays


def _in_lists(rows: List[List[float]]) -> Callable[[Array], _Ranks]:
    n = len(rows[0])

    def look_up(sample: Array) -> _Ranks:
        values = sample.tolist()
        lower = [bisect_left(row, value) for row, value in zip(rows, values)]
        upper: Optional[List[int]] = None
        ties = 0
        for k, place in enumerate(lower):
            if place < n and rows[k][place] == values[k]:
                if upper is None:
                    upper = lower.copy()
                upper[k] = bisect_right(rows[k], values[k], place)
                ties += 1
        return lower, lower if upper is None else upper, ties

    return look_up
