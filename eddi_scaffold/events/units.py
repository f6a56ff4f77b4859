"""Units of the event language: dimension and factor to the dimension's base."""

from __future__ import annotations

import math
from fractions import Fraction

_UNITS: dict[str, tuple[str, float, float]] = {
    "ns": ("time", 1, 1e9),
    "us": ("time", 1, 1e6),
    "ms": ("time", 1, 1e3),
    "s": ("time", 1, 1),
    "min": ("time", 60, 1),
    "h": ("time", 3600, 1),
    "mm": ("length", 1, 1000),
    "cm": ("length", 1, 100),
    "m": ("length", 1, 1),
    "km": ("length", 1000, 1),
    "deg": ("angle", math.pi, 180),
    "rad": ("angle", 1, 1),
    "mps": ("speed", 1, 1),
    "kmph": ("speed", 1000, 3600),
    "g": ("mass", 1, 1000),
    "kg": ("mass", 1, 1),
    "N": ("force", 1, 1),
    "V": ("voltage", 1, 1),
    "mV": ("voltage", 1, 1000),
    "A": ("current", 1, 1),
    "mA": ("current", 1, 1000),
    "W": ("power", 1, 1),
    "kW": ("power", 1000, 1),
    "Hz": ("frequency", 1, 1),
    "kHz": ("frequency", 1000, 1),
    "pct": ("share", 1, 1),
    "degC": ("temperature in Celsius", 1, 1),
    "K": ("temperature in Kelvin", 1, 1),
}
UNITS = frozenset(_UNITS)
"""Names of all units; case matters."""

DURATIONS: dict[str, int] = {
    "ns": 1,
    "us": 10**3,
    "ms": 10**6,
    "s": 10**9,
    "min": 60 * 10**9,
    "h": 3600 * 10**9,
}
"""Unit of a duration -> nanoseconds."""


def dimension(unit: str) -> str:
    """Return the dimension of a unit."""
    return _UNITS[unit][0]


def converted(value: float, unit: str, to: str) -> float:
    """Return a value in another unit of the same dimension."""
    if unit == to:
        return value
    _, up, down = _UNITS[unit]
    _, to_up, to_down = _UNITS[to]
    return value * (up * to_down) / (down * to_up)


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


def same_dimension(unit: str | None) -> dict[str, tuple[int, int]] | None:
    """Return unit -> exact factor (numerator, denominator) to a unit; ``None`` without a unit.

    Degrees and radians have no exact factor.
    """
    if unit is None:
        return None
    found = {}
    kind, to_up, to_down = _UNITS[unit]
    for name, (other, up, down) in sorted(_UNITS.items()):
        if other == kind and (name == unit or math.pi not in (up, to_up)):
            factor = Fraction(up * to_down) / Fraction(down * to_up)
            found[name] = (factor.numerator, factor.denominator)
    return found
