"""Windows against a reference, whatever the statistic."""

from __future__ import annotations

from typing import Callable, Mapping, Optional, SupportsFloat

from .anderson_darling import AndersonDarling
from .arrays import NUMPY, Array, Backend
from .statistics import CramerVonMises, KolmogorovSmirnov

_Statistic = Callable[[Array, Optional[Array], Optional[Array]], Array]
_STATISTICS: Mapping[str, Callable[[Backend, Array, int], _Statistic]] = {
    "ks": KolmogorovSmirnov,
    "cvm": CramerVonMises,
    "ad": AndersonDarling,
}


class Comparison:
    """Statistics of windows of ``m`` values against fixed references, one per test.

    Args:
        metric: ``ks``, ``cvm`` or ``ad``.
        reference: (K, n) of numpy, float64, each row ascending.
        m: values of a window.
        backend: of all arrays.

    Attributes:
        tests: K.
        n: reference values of each test.
        m: values of a window.
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
