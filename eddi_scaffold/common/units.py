"""Units of measurement: one table (``units.txt``), and quantities as people write them.

Factors are exact, but for those with pi, which is the nearest double. ``degC`` and ``K`` are two
dimensions: a factor cannot distinguish a temperature of 5 K from a difference.
"""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import cache
from pathlib import Path
from typing import NamedTuple

from eddi_scaffold.common.problems import HintedError


@dataclass(frozen=True)
class Unit:
    """A unit of measurement."""

    symbol: str  # what messages print (`km/h`); empty for a plain ratio
    dimension: str  # what it measures; only units of one dimension can be compared
    factor: Fraction = Fraction(1)  # to the first unit of the dimension
    names: tuple[str, ...] = ()  # further spellings (`kilometer_per_hour`, `kmph`)
    root: str = ""  # symbol of the unit of square roots, empty for none


RATIO = Unit("", "ratio", names=("fraction", "ratio"))


def _units() -> Iterator[Unit]:
    yield RATIO
    for line in Path(__file__).with_name("units.txt").read_text("utf-8").splitlines()[1:]:
        dimension, _, rows = line.partition(": ")
        for row in rows.split(", "):
            symbol, factor, *names = row.split()
            exact = Fraction(math.pi) / 180 if factor == "pi/180" else Fraction(factor)
            root = names.pop().removeprefix("sqrt:") if "sqrt:" in row else ""
            yield Unit(symbol, dimension, exact, tuple(names), root)


UNITS = tuple(_units())
_BY_SPELLING = {spelling: unit for unit in UNITS for spelling in (unit.symbol, *unit.names)}


def find(spelling: str | None) -> Unit | None:
    """Return the unit of a spelling, case sensitive; no unit (``None``) is a ratio."""
    return RATIO if spelling is None else _BY_SPELLING.get(spelling)


@cache
def words() -> frozenset[str]:
    """Return the spellings that are names: those of the language of events."""
    return frozenset(spelling for spelling in _BY_SPELLING if spelling.isidentifier())


def one_word(spelling: str) -> str | None:
    """Return the units to write in the language of events for ``m/s``; none for other texts."""
    if not spelling or spelling not in _BY_SPELLING or spelling.isidentifier():
        return None
    of = dimension(spelling)
    others = [
        other for unit in UNITS if unit.dimension == of if (other := word(unit.symbol)) in words()
    ]
    own = word(spelling)
    return own if own in words() else " or ".join(others)


def apart(unit: str, target: str) -> str:
    """Return why a known unit cannot be converted to another of another dimension."""
    if {unit, target} == {"K", "degC"}:
        return f"{unit} and {target} are 273.15 apart, and a unit is only a factor"
    return "they are not of one dimension"


def listed() -> str:
    """Return the table as one line, for messages."""
    shown = (unit.symbol for unit in UNITS if unit is not RATIO)
    return f'{", ".join(shown)}, "" (ratio)'


def factor(unit: str | None, target: str | None) -> Fraction | None:
    """Return by what a number in one unit is multiplied to get it in another.

    Returns:
        The exact factor; ``None`` when a unit is unknown or the dimensions differ.
    """
    first, second = find(unit), find(target)
    if first is None or second is None or first.dimension != second.dimension:
        return None
    return first.factor / second.factor


def convertible(target: str | None) -> Mapping[str, tuple[int, int]]:
    """Return each spelling of the same dimension with its factor (numerator, denominator)."""
    factors = {spelling: factor(spelling, target) for spelling in _BY_SPELLING}
    return {
        spelling: (exact.numerator, exact.denominator)
        for spelling, exact in factors.items()
        if exact is not None
    }


def contradict(units: Sequence[str], target: str) -> bool:
    """Return whether a known unit is none of those that a value has, one of which is right."""
    known = bool(units) and find(target) is not None
    return known and all(factor(unit, target) != 1 for unit in units)


def accepted(unit: str | None) -> Mapping[str, tuple[int, int]] | None:
    """Return in which units a value may be given: an unknown unit only in itself."""
    if not unit:
        return None
    return convertible(unit) if find(unit) is not None else {unit: (1, 1)}


def converted(value: float, unit: str, target: str) -> float:
    """Return a finite number in another unit of its dimension; infinity when it is too large."""
    exact = factor(unit, target)
    assert exact is not None
    try:
        return value if exact == 1 else float(Fraction(value) * exact)
    except OverflowError:
        return math.copysign(math.inf, value)


def word(spelling: str) -> str:
    """Return the spelling that is a name, which an event takes, of a known unit."""
    unit = _BY_SPELLING[spelling]
    every = (spelling, unit.symbol, *reversed(unit.names))
    return next((text for text in every if text.isidentifier()), spelling)


def dimension(spelling: str) -> str:
    """Return what a known unit measures."""
    return _BY_SPELLING[spelling].dimension


def root(spelling: str | None) -> str | None:
    """Return the unit of a square root, ``None`` where it has none."""
    unit = None if spelling is None else find(spelling)
    return (unit.root or None) if unit is not None else None


_NUMBER = re.compile(
    r"([-+]?(?:[0-9]+(?:\.[0-9]*)?|\.[0-9]+)(?:[eE][-+]?[0-9]{1,4})?)(?:\s+(\S.*))?",
    re.ASCII,
)
_BLANKS = " \t\n\r\f\v"
_ODE = {"millisecond": "ms", "second": "s", "minute": "min", "hour": "h"}
"""Literals of the metamodel's TimeUnit that are spelt otherwise."""

RATE_UNITS = ("1/h", "1/s", "1/min", "1/day", "1/week", "1/month", "1/year", "FIT")
DURATION_UNITS = ("ns", "us", "ms", "s", "min", "h", "day", "week", "month", "year")


class QuantityError(HintedError):
    """A text is not a quantity; the message explains why, the hint what to write."""


class UnitError(QuantityError):
    """It is a number, but its unit is missing, not known, or one too many."""


class Quantity(NamedTuple):
    """A number in the unit of the product (1/h, h), and whether a unit was written."""

    value: float
    has_unit: bool


def rate(quantity: object, unit: str | None = None) -> Quantity:
    """Read a rate, per hour without a unit (QuantityError: none, negative, of no known unit)."""
    form = "write a rate such as `1e-5 1/h` or `100 FIT`"
    return _quantity(quantity, unit, form, rate_factor, ("unit of a rate", RATE_UNITS))


def duration(quantity: object, unit: str | None = None) -> Quantity:
    """Read a duration in hours, as it is without a unit (QuantityError: as of a rate)."""
    form = "write a duration such as `2 h` or `30 min`"
    return _quantity(quantity, unit, form, hours_factor, ("unit of time", DURATION_UNITS))


def _quantity(
    quantity: object,
    unit: str | None,
    form: str,
    factor_of: Callable[[str], Fraction | None],
    expected: tuple[str, Sequence[str]],
) -> Quantity:
    number, written = _split(quantity, form=form)
    written = written or unit
    if written is None:
        return Quantity(number, has_unit=False)
    exact = factor_of(written)
    if exact is None:
        kind, known = expected
        raise UnitError(f"{written!r} is not a {kind}", f"units: {', '.join(known)}")
    value = number * exact.numerator / exact.denominator
    return Quantity(_finite(value, quantity), has_unit=True)


def seconds(quantity: object) -> float:
    """Read a duration of up to a year in seconds (QuantityError: others); 0 needs no unit."""
    hours, has_unit = duration(quantity)
    if hours > 8760.0 or (hours and not has_unit):
        raise QuantityError(f"{quantity!r} is no time of up to a year", "write a time such as 2 s")
    return round(hours * 3600.0, 9)


def temperature(quantity: object) -> float:
    """Read a temperature in degC (QuantityError: none, without a unit, below absolute zero)."""
    number, written = _split(quantity, signed=True, form="write a temperature such as `51 degC`")
    if written not in ("degC", "K"):
        raise UnitError(f"{quantity!r} has no unit of temperature", "write degC or K")
    value = number - 273.15 if written == "K" else number
    if value <= -273.0 or value > 1e4:
        raise QuantityError(f"{quantity!r} is out of range, -273 degC to 10000 degC")
    return value


def number(quantity: object, low: float, high: float) -> float:
    """Read a number between two limits, inclusive (QuantityError: none, out of range)."""
    value, unit = _split(quantity, signed=True)
    if unit is not None:
        raise UnitError(f"{quantity!r} has a unit, a number without one is expected")
    if not low <= value <= high:
        raise QuantityError(f"{quantity!r} is out of range, {low:.15g} to {high:.15g}")
    return value


def rate_factor(unit: str) -> Fraction | None:
    """Return the factor to 1/h, None for no unit of a rate."""
    if unit.casefold() == "fit":
        return Fraction(1, 1_000_000_000)
    match = re.fullmatch(r"(?:1\s*/|/|per\s+)\s*(\w+)|(\w+)\^-1", unit.strip())
    hours = None if match is None else hours_factor(match[1] or match[2])
    return None if hours is None else 1 / hours


def hours_factor(unit: str) -> Fraction | None:
    """Return the factor to hours, None for no unit of time (``h``, ``Hour``)."""
    return factor(_time_unit(unit), "h")


def _time_unit(text: str) -> str:
    word = text.strip()
    if word in DURATION_UNITS:
        return word
    folded = word.casefold()
    folded = folded.removesuffix("s") if len(folded) > 3 else folded
    return _ODE.get(folded, folded if len(folded) > 2 else word)


def _split(
    quantity: object, *, signed: bool = False, form: str | None = None
) -> tuple[float, str | None]:
    text = quantity if isinstance(quantity, str) else repr(quantity)
    match = _NUMBER.fullmatch(text.strip(_BLANKS))
    if match is None:
        raise QuantityError(f"{_shown(quantity)} is not a number", form)
    value = _finite(float(match[1]), quantity)
    if value < 0 and not signed:
        raise QuantityError(f"{_shown(quantity)} is negative")
    return value, match[2]


def _finite(value: float, quantity: object) -> float:
    if not math.isfinite(value):
        raise QuantityError(f"{_shown(quantity)} is not finite")
    return value


def _shown(quantity: object) -> str:
    text = repr(quantity)
    return text if len(text) <= 60 else f"{text[:57]}..."
