"""Thresholds for dependent samples: how far windows of correct behaviour are from the reference.

Samples of a robot resemble their neighbours, which tests for independent samples take for a
difference. So windows slide over the part of the file that is not the reference, and the largest
statistic of all tests in each of them shows what correct behaviour looks like.
"""

from __future__ import annotations

import math
from fractions import Fraction
from typing import Any

import numpy as np
import numpy.typing as npt
from eddi_runtime.safeml.comparison import Comparison

from eddi_scaffold.kinds.safeml.scope import Calibration, Metric, Rows

_LARGEST = 1e300
_AT_ONCE = 2_000_000
"""Numbers of the windows that are compared at once: bounds memory, not the result."""


def calibrate(
    comparison: Comparison, series: Rows, *, stride: int, distance: int, level: float
) -> Calibration:
    """Slide windows over series and take the quantile of their largest statistics.

    Args:
        comparison: with the reference.
        series: (K, rows), in time order; at least one window long.
        stride: rows between two samples of a window.
        distance: rows between two windows.
        level: significance level over all tests.
    """
    maxima = np.sort(largest_statistics(comparison, series, stride=stride, distance=distance))
    count = len(maxima)
    # the level as a person wrote it: 1 - 0.1 is not 0.9 in binary
    at = math.ceil((count - 1) * (1 - Fraction(repr(level))))
    return Calibration(count, maxima[at].item(), is_last=at == count - 1)


def largest_statistics(
    comparison: Comparison, series: Rows, *, stride: int, distance: int
) -> np.ndarray[tuple[int, ...], np.dtype[np.int64 | np.float64]]:
    """Return the largest statistic of all tests in each window, in time order."""
    length = (comparison.m - 1) * stride + 1
    starts = np.arange(0, series.shape[1] - length + 1, distance)
    inside = np.arange(comparison.m) * stride
    ranks = comparison.backend.ranks
    lower = ranks(comparison.reference, series, equal=False)
    upper = ranks(comparison.reference, series, equal=True)
    tied = bool((lower != upper).any())
    many = max(1, _AT_ONCE // (comparison.tests * comparison.m))
    largest = []
    for first in range(0, len(starts), many):
        index = starts[first : first + many, None] + inside

        low, high, values = (part[:, index].swapaxes(0, 1) for part in (lower, upper, series))
        statistics = comparison.of_ranks(low, high if tied else None, comparison.counts(values))
        largest.append(statistics.max(axis=1))
    return np.concatenate(largest)


def effective(
    metric: Metric, theoretical: float, calibration: Calibration | None, n: int, m: int
) -> float:
    """Return the threshold in use: above the quantile, and never below the theoretical one."""
    if calibration is None:
        return theoretical
    if metric == "ks":
        return max(int(theoretical), int(calibration.quantile) + math.gcd(n, m))
    return max(theoretical, math.nextafter(calibration.quantile, math.inf))


def autocorrelation(series: Rows) -> tuple[float, int]:
    """Return the largest correlation of neighbouring values, and the series it is of."""
    finite = np.clip(series, -_LARGEST, _LARGEST)
    largest = np.abs(finite).max(axis=1, keepdims=True)
    scaled = finite / np.where(largest > 0.0, largest, 1.0)  # squares stay numbers
    centred = scaled - scaled.mean(axis=1, keepdims=True)
    power = (centred * centred).sum(axis=1)
    shifted = (centred[:, :-1] * centred[:, 1:]).sum(axis=1)
    # what never changes has no correlation
    correlations = np.where(power > 0.0, shifted / np.where(power > 0.0, power, 1.0), 0.0)
    at = int(correlations.argmax())
    return float(correlations[at]), at


def of_windows(comparison: Comparison, windows: npt.NDArray[np.float64]) -> npt.NDArray[Any]:
    """Return the statistic of each test of many windows: (B, K, m) -> (B, K)."""
    count = int(windows.shape[0])
    values = windows.swapaxes(0, 1).reshape(comparison.tests, count * comparison.m)

    def ranks(*, equal: bool) -> npt.NDArray[np.int64]:
        flat = comparison.backend.ranks(comparison.reference, values, equal=equal)
        ordered: npt.NDArray[np.int64] = flat.reshape(comparison.tests, count, comparison.m)
        return ordered.swapaxes(0, 1)

    lower, upper = ranks(equal=False), ranks(equal=True)
    some = bool((lower != upper).any())
    statistics: npt.NDArray[Any] = comparison.of_ranks(
        lower, upper if some else None, comparison.counts(windows)
    )
    return statistics
