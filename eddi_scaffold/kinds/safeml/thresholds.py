"""From which distance on a window differs significantly, when its samples are independent.

Laws of the statistics when window and reference have the same distribution. Quantiles of the limits
of Cramer-von Mises and Anderson-Darling are a table with linear interpolation in the logarithm of
the level: never below the exact value, at most 0.25 % above it. The statistics of finite samples
are brought to the mean and variance of the limit (Anderson 1962; Scholz and Stephens 1987).
"""

from __future__ import annotations

import math
from fractions import Fraction
from functools import lru_cache
from itertools import accumulate
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
from eddi_runtime.safeml.comparison import Comparison

from eddi_scaffold.kinds.safeml.scope import Calibration, Metric, Rows

_AT_ONCE = 2_000_000
"""Numbers of the windows that are compared at once: bounds memory, not the result."""


def calibrate(
    comparison: Comparison, series: Rows, *, stride: int, distance: int, level: float
) -> Calibration:
    """Slide windows over series and take the quantile of their largest statistics.

    The series are (K, rows) in time order, at least one window long; ``stride`` is in rows between
    samples, ``distance`` between windows; the level is that of all tests together.
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
    # how many reference values are below each value, and how many are not above it
    ranks, reference = comparison.backend.ranks, comparison.reference
    lower, upper = (ranks(reference, series, equal=equal) for equal in (False, True))
    is_tied = bool((lower != upper).any())
    count = max(1, _AT_ONCE // (comparison.tests * comparison.m))
    largest = []
    for first in range(0, len(starts), count):
        index = starts[first : first + count, None] + inside
        low, high, values = (part[:, index].swapaxes(0, 1) for part in (lower, upper, series))
        statistics = comparison.of_ranks(low, high if is_tied else None, comparison.counts(values))
        largest.append(statistics.max(axis=1))
    return np.concatenate(largest)


def autocorrelation(series: Rows) -> tuple[float, int]:
    """Return the largest correlation of neighbouring values, and the series it is of."""
    largest = np.abs(series).max(axis=1, keepdims=True)
    scaled = series / np.where(largest > 0.0, largest, 1.0)  # squares stay numbers
    centred = scaled - scaled.mean(axis=1, keepdims=True)
    power = (centred * centred).sum(axis=1)
    shifted = (centred[:, :-1] * centred[:, 1:]).sum(axis=1)
    # what never changes has no correlation
    correlations = np.where(power > 0.0, shifted / np.where(power > 0.0, power, 1.0), 0.0)
    index = int(correlations.argmax())
    return float(correlations[index]), index


MOST_EXACT = 20_000_000
"""Product of sample sizes up to which Kolmogorov-Smirnov is computed exactly."""

_LARGE, _SMALL = 1e250, 1e-250


def theoretical(metric: Metric, n: int, m: int, level: float) -> tuple[float, str]:
    """Return the critical value of one test, of KS as n m D, and how it was found."""
    if metric != "ks":
        return critical_value(metric, level, n, m), "limit"
    if n * m > MOST_EXACT:
        return ks_asymptotic(n, m, level), "asymptotic"
    return _ks_exact(n, m, level), "exact"


def ks_asymptotic(n: int, m: int, level: float) -> int:
    """Return Smirnov's asymptotic critical value as n m D, rounded up to a value that occurs."""
    step = math.gcd(n, m)
    critical = math.sqrt(-math.log(level / 2.0) / 2.0) * math.sqrt((n + m) * n * m)
    return math.ceil(critical / step) * step


@lru_cache(maxsize=64)
def _ks_exact(n: int, m: int, level: float) -> int:
    """Return the smallest n m D whose probability is at most ``level``, by bisection."""
    step = math.gcd(n, m)
    low, high = 0, n * m // step + 1  # n m / step itself may still be too probable
    while high - low > 1:
        middle = (low + high) // 2
        low, high = (low, middle) if ks_tail(n, m, middle * step) <= level else (middle, high)
    return high * step


def ks_tail(n: int, m: int, scaled: int) -> float:
    """Return the exact probability that n m D is at least ``scaled``, for untied samples.

    All C(n + m, n) paths from (0, 0) to (n, m) are equally probable; those that stay closer to the
    diagonal than ``scaled`` everywhere are counted row by row (Hodges 1957).
    """
    if scaled <= 0:
        return 1.0
    if scaled > n * m:
        return 0.0
    n, m = max(n, m), min(n, m)  # it is the same either way, and rows are the slower direction
    paths = np.zeros(n + 1)
    paths[: min(n, (scaled - 1) // m) + 1] = 1.0
    exponent = 0
    for j in range(1, m + 1):
        first = max(0, -((scaled - 1 - j * n) // m))
        last = min(n, (j * n + scaled - 1) // m)
        paths[:first] = 0.0
        np.cumsum(paths[first : last + 1], out=paths[first : last + 1])
        peak = float(paths[last])
        if not _SMALL < peak < _LARGE:
            if peak == 0.0:
                return 1.0
            shift = math.frexp(peak)[1]
            paths[first : last + 1] = np.ldexp(paths[first : last + 1], -shift)
            exponent += shift
    if paths[n] == 0.0:
        return 1.0
    # log(paths 2^exponent / total) without losing digits to large logarithms
    total = math.comb(n + m, n)
    shift = max(0, total.bit_length() - 64)
    fraction, more = math.frexp(float(paths[n]) / float(total >> shift))
    log_inside = math.log(fraction) + (exponent - shift + more) * math.log(2.0)
    return -math.expm1(min(0.0, log_inside))


def largest_possible(metric: Metric, n: int, m: int) -> float:
    """Return the statistic of a window that is wholly beyond the reference."""
    comparison = Comparison(metric, np.arange(n, dtype=np.float64)[None], m)
    beyond = np.arange(n, n + m, dtype=np.float64)[None]
    return float(largest_statistics(comparison, beyond, stride=1, distance=1)[0])


_TABLE = Path(__file__).with_name("quantiles.txt").read_text("utf-8").splitlines()[1:]
_ROWS = [[float(cell) for cell in row.split()] for row in _TABLE]
_LEVELS = [level for level, *_ in _ROWS]
_QUANTILES = {metric: [row[k] for row in _ROWS] for k, metric in enumerate(("cvm", "ad"), 1)}
_SLOPES = {"cvm": 2.0 / math.pi**2, "ad": 1.0}
"""Growth of the quantile per unit of -ln(level) beyond the table, on the safe side."""

_LIMIT_MEAN = {"cvm": 1.0 / 6.0, "ad": 1.0}
_LIMIT_VARIANCE = {"cvm": 1.0 / 45.0, "ad": 2.0 * (math.pi**2 - 9.0) / 3.0}


def limit_quantile(metric: str, level: float) -> float:
    """Return the upper quantile of the limiting law of ``cvm`` or ``ad``; above 0.5 that of 0.5."""
    if level < _LEVELS[-1]:
        return _QUANTILES[metric][-1] + _SLOPES[metric] * math.log(_LEVELS[-1] / level)
    return float(np.interp(-np.log(level), -np.log(_LEVELS), _QUANTILES[metric]))


def moments(metric: str, n: int, m: int) -> tuple[float, float]:
    """Return mean and variance of ``cvm`` or ``ad`` for samples of n and m, without ties.

    Anderson-Darling: Scholz and Stephens (1987), section 2; the variance is 0 for n + m < 4.
    """
    total = n + m
    if metric == "cvm":
        spread = 4.0 * n * m * total - 3.0 * (n * n + m * m) - 2.0 * n * m
        variance = (total + 1.0) * spread / (180.0 * n * m * float(total) ** 2)
        return (1.0 + 1.0 / total) / 6.0, variance
    if total < 4:
        return 1.0, 0.0
    harmonic = list(accumulate(1.0 / i for i in range(1, total)))
    h = harmonic[-1]
    g = math.fsum((h - harmonic[i - 1]) / (total - i) for i in range(1, total - 1))
    ratio = 1.0 / n + 1.0 / m
    a = (4 * g - 6) + (10 - 6 * g) * ratio
    b = 4 * (2 * g - 4) + 16 * h + (2 * g - 14 * h - 4) * ratio - 8 * h + 4 * g - 6
    c = 4 * (6 * h + 2 * g - 2) + 2 * (4 * h - 4 * g + 6) + (2 * h - 6) * ratio + 4 * h
    d = 4 * (2 * h + 6) - 8 * h
    n3 = float(total)
    return 1.0, (a * n3**3 + b * n3**2 + c * n3 + d) / ((n3 - 1) * (n3 - 2) * (n3 - 3))


def critical_value(metric: str, level: float, n: int, m: int) -> float:
    """Return the value that ``cvm`` or ``ad`` reaches with a probability of ``level``."""
    mean, variance = moments(metric, n, m)
    excess = limit_quantile(metric, level) - _LIMIT_MEAN[metric]
    return mean + excess * math.sqrt(variance / _LIMIT_VARIANCE[metric])


def critical_values(metric: str, n: int, m: int) -> tuple[list[tuple[float, float]], float]:
    """Return ascending critical values of ``cvm`` or ``ad`` with levels, and the slope beyond.

    The slope is per unit of -ln(level); there are no values where the statistic has no variance.
    """
    _, variance = moments(metric, n, m)
    if variance <= 0.0:
        return [], 0.0
    points = [(critical_value(metric, level, n, m), level) for level in _LEVELS]
    return points, _SLOPES[metric] * math.sqrt(variance / _LIMIT_VARIANCE[metric])
