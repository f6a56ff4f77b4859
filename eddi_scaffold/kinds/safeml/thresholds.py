"""From which distance on a window differs significantly, when its samples are independent."""

from __future__ import annotations

import math
from functools import lru_cache

import numpy as np
from eddi_runtime.safeml.comparison import Comparison

from eddi_scaffold.compiling.safeml.limits import critical_value
from eddi_scaffold.kinds.safeml.calibration import of_windows
from eddi_scaffold.kinds.safeml.scope import Metric

MOST_EXACT = 20_000_000
"""Product of sample sizes up to which Kolmogorov-Smirnov is computed exactly."""

_LARGE, _SMALL = 1e250, 1e-250


def theoretical(metric: Metric, n: int, m: int, level: float) -> tuple[float, str]:
    """Return the critical value of one test and how it was found.

    Returns:
        Kolmogorov-Smirnov: the whole number n m D, ``exact`` or ``asymptotic``. The others: the
        statistic, ``limit``.
    """
    if metric != "ks":
        return critical_value(metric, level, n, m), "limit"
    return (
        (_ks_exact(n, m, level), "exact")
        if n * m <= MOST_EXACT
        else (ks_asymptotic(n, m, level), "asymptotic")
    )


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
    inside = _log_ratio(float(paths[n]), exponent, math.comb(n + m, n))
    return -math.expm1(inside)


def _log_ratio(mantissa: float, exponent: int, total: int) -> float:
    """Return log(mantissa 2^exponent / total) without losing digits to large logarithms."""
    if mantissa == 0.0:
        return -math.inf
    bits = total.bit_length()
    share = total >> max(0, bits - 64)
    shift = exponent - max(0, bits - 64)
    fraction, more = math.frexp(mantissa / float(share))
    return min(0.0, math.log(fraction) + (shift + more) * math.log(2.0))


def can_fire(metric: Metric, n: int, m: int, level: float) -> bool:
    """Return whether a window that is wholly beyond the reference would be a violation."""
    if metric == "ks":
        # both complete separations together: 2 / C(n + m, m)
        log_total = math.lgamma(n + m + 1) - math.lgamma(n + 1) - math.lgamma(m + 1)
        return math.log(2.0) - log_total <= math.log(level) + 1e-12
    return largest_possible(metric, n, m) >= critical_value(metric, level, n, m)


def largest_possible(metric: Metric, n: int, m: int) -> float:
    """Return the statistic of a window that is wholly beyond the reference."""
    reference = np.arange(n, dtype=np.float64)[None, :]
    beyond = n + np.arange(m, dtype=np.float64)[None, None, :]
    return float(of_windows(Comparison(metric, reference, m), beyond)[0, 0])


def smallest_window(metric: Metric, n: int, level: float, most: int = 2000) -> int | None:
    """Return the smallest window with which the monitor can fire, ``None`` up to ``most``."""
    return next((m for m in range(1, most + 1) if can_fire(metric, n, m, level)), None)
