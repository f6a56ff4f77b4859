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

from eddi_scaffold.kinds.safeml.scope import Calibration, Rows

_LARGEST = 1e300
_AT_ONCE = 2_000_000
"""Numbers of the windows that are compared at once: bounds memory, not the result."""


def calibrate(
    comparison: Comparison, series: Rows, *, stride: int, distance: int, level: float
) -> Calibration:
    """Slide windows over series and take the quantile of their largest statistics.

    The series are (K, rows) in time order, at least one window long. There are ``stride`` rows
    between two samples of a window, and ``distance`` rows between two windows; the level is that of
    all tests together.
    """
    maxima = np.sort(largest_statistics(comparison, series, stride=stride, distance=distance))
    # the level as a person wrote it: 1 - 0.1 is not 0.9 in binary
    index = math.ceil((len(maxima) - 1) * (1 - Fraction(repr(level))))
    return Calibration(len(maxima), maxima[index].item(), is_last=index == len(maxima) - 1)


def largest_statistics(
    comparison: Comparison, series: Rows, *, stride: int, distance: int
) -> npt.NDArray[Any]:
    """Return the largest statistic of all tests in each window, in time order."""
    length = (comparison.m - 1) * stride + 1
    starts = np.arange(0, series.shape[1] - length + 1, distance)
    inside = np.arange(comparison.m) * stride
    lower, upper = _ranks(comparison, series)
    is_tied = bool((lower != upper).any())
    count = max(1, _AT_ONCE // (comparison.tests * comparison.m))
    largest = []
    for first in range(0, len(starts), count):
        index = starts[first : first + count, None] + inside
        low, high, values = (part[:, index].swapaxes(0, 1) for part in (lower, upper, series))
        statistics = comparison.of_ranks(low, high if is_tied else None, comparison.counts(values))
        largest.append(statistics.max(axis=1))
    return np.concatenate(largest)


def of_windows(comparison: Comparison, windows: npt.NDArray[np.float64]) -> npt.NDArray[Any]:
    """Return the statistic of each test of many windows: (B, K, m) -> (B, K)."""
    shape = (comparison.tests, len(windows), comparison.m)
    series = windows.swapaxes(0, 1).reshape(comparison.tests, -1)
    lower, upper = (ranks.reshape(shape).swapaxes(0, 1) for ranks in _ranks(comparison, series))
    is_tied = bool((lower != upper).any())
    statistics: npt.NDArray[Any] = comparison.of_ranks(
        lower, upper if is_tied else None, comparison.counts(windows)
    )
    return statistics


def _ranks(comparison: Comparison, series: Rows) -> list[npt.NDArray[np.int64]]:
    """Return how many reference values are below each value, and how many are not above it."""
    ranks, reference = comparison.backend.ranks, comparison.reference
    return [ranks(reference, series, equal=equal) for equal in (False, True)]


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
    index = int(correlations.argmax())
    return float(correlations[index]), index
