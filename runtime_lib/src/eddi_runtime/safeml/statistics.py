"""Kolmogorov-Smirnov and Cramer-von Mises distances of windows to a reference, from ranks.

F (reference, n values) and G (window, m values) count what is <= a point. This holds with ties
too, so that equal samples have distance 0, also where sensors give few different values. For each
value of a window, *lower* is how many reference values are below it and *upper* how many are not
above it. Nothing here looks at the reference itself: a step costs the same for a long one.
Notation: K tests, N = n + m, b = 1..m. Each statistic is a function of

- lower: whole numbers (..., K, m), in any order along m;
- upper: the same shape; ``None`` when no window value is in the reference;
- counts: (..., K, m), ascending: how many window values are not above each one; ``None`` when all
  values of a window differ.
"""

from __future__ import annotations

import numpy as np

from .arrays import Array, Backend

_EXACT = 2**61
"""Sums below this are made of 64-bit integers, larger ones of doubles."""


class KolmogorovSmirnov:
    """The largest difference of F and G as the whole number n m D: exact, also with ties."""

    def __init__(self, backend: Backend, reference: Array, m: int) -> None:
        self._backend = backend
        self._n, self._m = int(reference.shape[1]), m
        self._ascending = backend.array(self._n * np.arange(1, m + 1, dtype=np.int64))

    def __call__(self, lower: Array, upper: Array | None, counts: Array | None) -> Array:
        """Return n m D (..., K)."""
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
        """Return T (..., K) in float64."""
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
