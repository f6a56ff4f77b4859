"""Conditions over messages and time: what compiled inputs and events call and inherit.

Numbers are floats, NaN is UNKNOWN; truth values are 0 < 1 < 2 (strong Kleene); values of an ENUM
are the numbers of its literals, -1 is UNKNOWN.
"""

from __future__ import annotations

import math
from typing import Any, Callable, Sequence, Union

from ..plain_values import plain

FORMAT = 3

__all__ = ["FORMAT", "Conditions", "literal", "number", "reduced", "scaled", "stamp", "truth"]

Value = Union[float, int]
_FAR_NS = 2**64  # farther in the future than any sample whose clock is a little ahead


class Conditions:
    """Represents conditions over time; a compiled class adds ``step`` and what it remembers."""

    windows: tuple[Any, ...] = ()  # of all functions
    # time of the last step, None before the first. The same time again: the step is ignored. An
    # earlier one: the clock went back, all is forgotten first.
    last: int | None
    since: int  # time of the first sample that the windows may hold
    outputs: tuple[object, ...]  # of the last step

    def __init__(self) -> None:
        self.restart()

    def restart(self) -> None:
        """Forget everything of former steps."""
        self.last, self.since = None, 0
        for window in self.windows:
            window.reset()


def number(raw: object) -> float:
    """Return a raw value as a number, NaN for UNKNOWN; never raises."""
    value = plain(raw)
    try:
        return float(value) if type(value) is float or type(value) is int else math.nan
    except OverflowError:  # a whole number beyond any double
        return math.nan


def truth(raw: object) -> int:
    """Return a raw value as 0, 1 or 2; never raises."""
    if raw is True:
        return 2
    value = plain(raw)
    return (2 if value else 0) if isinstance(value, bool) else 1


def literal(raw: object, literals: Sequence[str]) -> int:
    """Return the number of a literal, -1 for UNKNOWN; never raises."""
    value = plain(raw)
    return literals.index(value) if isinstance(value, str) and value in literals else -1


def scaled(raw: object, num: int, den: int) -> object:
    """Return a number in another unit, None where no double holds it; what is none as it is."""
    value = plain(raw)
    if type(value) is not float and type(value) is not int:
        return raw
    try:
        return value * num / den
    except OverflowError:
        return None


def stamp(t: int, age: float | None) -> int:
    """Return when a sample of an age was made; one whose age is not known counts as new."""
    if age is None:
        return t
    return t - round(age * 1e9) if math.isfinite(age) else t + _FAR_NS


class Unknown(Exception):  # noqa: N818 - no error: a reason
    """Why a reduction gives nothing."""


def reduced(
    function: Callable[..., float | bool], raws: Sequence[object]
) -> tuple[float | bool | None, str]:
    """Return the value of a reduction, None for UNKNOWN, and why it is not known; never raises."""
    try:
        return function(*raws), ""
    except Unknown as reason:
        return None, str(reason)
    except Exception as problem:  # noqa: BLE001 - messages are what the robot sends
        return None, type(problem).__name__
