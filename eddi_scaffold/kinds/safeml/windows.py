"""Statistics of many windows at once."""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt
from eddi_runtime.safeml.comparison import Comparison


def of_windows(comparison: Comparison, windows: npt.NDArray[np.float64]) -> npt.NDArray[Any]:
    """Return the statistic of each test of many windows: (B, K, m) -> (B, K)."""
    count = int(windows.shape[0])
    values = windows.swapaxes(0, 1).reshape(comparison.tests, count * comparison.m)

    def ranks(*, equal: bool) -> npt.NDArray[np.int64]:
        found = comparison.backend.ranks(comparison.reference, values, equal=equal)
        ordered: npt.NDArray[np.int64] = found.reshape(comparison.tests, count, comparison.m)
        return ordered.swapaxes(0, 1)

    lower, upper = ranks(equal=False), ranks(equal=True)
    some = bool((lower != upper).any())
    found: npt.NDArray[Any] = comparison.of_ranks(
        lower, upper if some else None, comparison.counts(windows)
    )
    return found
