"""Durations of windows and timeouts, in whole nanoseconds."""

from __future__ import annotations

from fractions import Fraction

DURATIONS: dict[str, int] = {
    "ns": 1,
    "us": 10**3,
    "ms": 10**6,
    "s": 10**9,
    "min": 60 * 10**9,
    "h": 3600 * 10**9,
}
"""Unit of a duration -> nanoseconds."""


def nanoseconds(number: str, unit: str) -> int:
    """Return a duration in nanoseconds, rounded to nearest; the number's text is exact.

    Raises:
        OverflowError: the duration does not fit into 62 bits.
    """
    if not 0 <= float(number) < 2.0**62 or float(number) * DURATIONS[unit] >= 2.0**62:
        raise OverflowError
    if float(number) < 1e-12:  # the exact fraction of 1e-999999 would fill the memory
        return 0
    return round(Fraction(number) * DURATIONS[unit])
