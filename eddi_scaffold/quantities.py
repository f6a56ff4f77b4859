"""Rates, durations and temperatures as people write them: a number, a blank, a unit."""

from __future__ import annotations

import math
import re
from typing import NamedTuple

from eddi_scaffold.problems import HintedError
from eddi_scaffold.units import factor

_NUMBER = re.compile(
    r"([-+]?(?:[0-9]+(?:\.[0-9]*)?|\.[0-9]+)(?:[eE][-+]?[0-9]{1,4})?)(?:\s+(\S.*))?",
    re.ASCII,
)
_BLANKS = " \t\n\r\f\v"
_COMMA = re.compile(r"\s*[-+]?[0-9]+,[0-9]+\b.*")
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


def rate(given: object, unit: str | None = None) -> Quantity:
    """Read a rate; without a unit it is per hour.

    Args:
        given: text or number.
        unit: a unit that is given elsewhere.

    Raises:
        QuantityError: it is none, negative, or of an unknown unit.
    """
    number, written = _split(given, form="write a rate such as `1e-5 1/h` or `100 FIT`")
    written = written or unit
    if written is None:
        return Quantity(number, has_unit=False)
    per_hour = rate_factor(written)
    if per_hour is None:
        raise UnitError(f"{written!r} is not a unit of a rate", _list(RATE_UNITS))
    up, down = per_hour
    return Quantity(_finite(number * up / down, given), has_unit=True)


def duration(given: object, unit: str | None = None) -> Quantity:
    """Read a duration in hours; without a unit it is in hours.

    Raises:
        QuantityError: it is none, negative, or of an unknown unit.
    """
    number, written = _split(given, form="write a duration such as `2 h` or `30 min`")
    written = written or unit
    if written is None:
        return Quantity(number, has_unit=False)
    hours = factor(_time_unit(written), "h")
    if hours is None:
        raise UnitError(f"{written!r} is not a unit of time", _list(DURATION_UNITS))
    value = number * hours.numerator / hours.denominator
    return Quantity(_finite(value, given), has_unit=True)


def temperature(given: object) -> float:
    """Read a temperature with its unit in degC.

    Raises:
        QuantityError: it is none, has no unit, or lies below absolute zero.
    """
    number, written = _split(given, signed=True, form="write a temperature such as `51 degC`")
    if written not in ("degC", "K"):
        raise UnitError(f"{given!r} has no unit of temperature", "write degC or K")
    value = number - 273.15 if written == "K" else number
    if value <= -273.0 or value > 1e4:
        raise QuantityError(f"{given!r} is out of range, -273 degC to 10000 degC")
    return value


def number(given: object, low: float, high: float) -> float:
    """Read a number between two limits, inclusive.

    Raises:
        QuantityError: it is none, or out of range.
    """
    value, unit = _split(given, signed=True)
    if unit is not None:
        raise UnitError(f"{given!r} has a unit, a number without one is expected")
    if not low <= value <= high:
        raise QuantityError(f"{given!r} is out of range, {low:.15g} to {high:.15g}")
    return value


def rate_factor(unit: str) -> tuple[int, int] | None:
    """Return the factor to 1/h as numerator and denominator, None for no unit of a rate."""
    if unit.casefold() == "fit":
        return 1, 1_000_000_000
    match = re.fullmatch(r"(?:1\s*/|/|per\s+)\s*(\w+)|(\w+)\^-1", unit.strip())
    if match is None:
        return None
    hours = factor(_time_unit(match[1] or match[2]), "h")
    return None if hours is None else (hours.denominator, hours.numerator)


def is_time_unit(unit: str) -> bool:
    """Return whether a text is a unit of time (``h``, ``Hour``)."""
    return factor(_time_unit(unit), "h") is not None


def _time_unit(text: str) -> str:
    word = text.strip()
    if word in DURATION_UNITS:
        return word
    folded = word.casefold()
    folded = folded.removesuffix("s") if len(folded) > 3 else folded
    return _ODE.get(folded, folded if len(folded) > 2 else word)


def _split(
    given: object, *, signed: bool = False, form: str | None = None
) -> tuple[float, str | None]:
    if isinstance(given, bool) or not isinstance(given, int | float | str):
        raise QuantityError(f"{_shown(given)} is not a number", form)
    match = _NUMBER.fullmatch(given.strip(_BLANKS)) if isinstance(given, str) else None
    if isinstance(given, str) and match is None:
        hint = "write a point, not a comma" if _COMMA.fullmatch(given) else form
        raise QuantityError(f"{_shown(given)} is not a number", hint)
    try:
        value = float(match[1]) if match else float(given)
    except OverflowError:
        value = math.inf
    if value < 0 and not signed:
        raise QuantityError(f"{_shown(given)} is negative")
    return _finite(value, given, form), match[2] if match else None


def _finite(value: float, given: object, form: str | None = None) -> float:
    if not math.isfinite(value):
        raise QuantityError(f"{_shown(given)} is not finite", form)
    return value


def _shown(given: object) -> str:
    text = repr(given)
    return text if len(text) <= 60 else f"{text[:57]}..."


def _list(units: tuple[str, ...]) -> str:
    return f"units: {', '.join(units)}"
