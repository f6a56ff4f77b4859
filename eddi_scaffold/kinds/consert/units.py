"""Units of numeric dimensions: one table with exact factors to SI.

Source: SESAME D7.2 names no units; the table is that of conserts-rs 0.1.6, whose files we read.
"""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Mapping


@dataclass(frozen=True)
class Unit:
    """A unit of measurement.

    Attributes:
        name: long form (``kilometer_per_hour``).
        symbol: short form (``km/h``).
        quantity: what it measures; only units of one quantity can be compared.
        factor: exact factor to the SI unit of the quantity.
    """

    name: str
    symbol: str
    quantity: str
    factor: Fraction


RATIO = Unit("", "", "ratio", Fraction(1))

UNITS = (
    Unit("kilometer", "km", "length", Fraction(1000)),
    Unit("meter", "m", "length", Fraction(1)),
    Unit("millimeter", "mm", "length", Fraction(1, 1000)),
    Unit("second", "s", "time", Fraction(1)),
    Unit("millisecond", "ms", "time", Fraction(1, 1000)),
    Unit("microsecond", "us", "time", Fraction(1, 10**6)),
    Unit("nanosecond", "ns", "time", Fraction(1, 10**9)),
    Unit("kilometer_per_hour", "km/h", "velocity", Fraction(5, 18)),
    Unit("meter_per_second", "m/s", "velocity", Fraction(1)),
    Unit("newton", "N", "force", Fraction(1)),
    RATIO,
)

_BY_SPELLING = {spelling: unit for unit in UNITS for spelling in (unit.name, unit.symbol)}

ALLOWED = ", ".join(f"{u.name} ({u.symbol})" for u in UNITS if u is not RATIO) + ', "" (ratio)'
"""The table as one line, for messages."""


def find(uom: str | None) -> Unit | None:
    """Return the unit of a spelling, case sensitive; ``None`` for an unknown one.

    Args:
        uom: as written in the model; ``None`` (no unit given) is a ratio like ``""``.
    """
    return RATIO if uom is None else _BY_SPELLING.get(uom)


def spellings() -> list[str]:
    """Return every spelling that is understood."""
    return list(_BY_SPELLING)


def factor(given: str | None, wanted: str | None) -> Fraction | None:
    """Return by what a number in one unit is multiplied to get it in another.

    Returns:
        The exact factor; ``None`` when a unit is unknown or the quantities differ.
    """
    first, second = find(given), find(wanted)
    if first is None or second is None or first.quantity != second.quantity:
        return None
    return first.factor / second.factor


def convertible(uom: str | None) -> Mapping[str, tuple[int, int]]:
    """Return each spelling of the same quantity with its factor (numerator, denominator)."""
    factors = {spelling: factor(spelling, uom) for spelling in _BY_SPELLING}
    return {
        spelling: (exact.numerator, exact.denominator)
        for spelling, exact in factors.items()
        if exact is not None
    }
