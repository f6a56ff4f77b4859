"""Elements of lists: what raw values are, what can be done with one, and with all of them.

Numbers are floats, NaN is UNKNOWN; truth values are 0 < 1 < 2 (strong Kleene). The text below the
imports is copied into generated modules unchanged.
"""

from __future__ import annotations

import math
from typing import Any, Callable, Mapping, Sequence, Union

MAX_TEXT = 100
"""Characters of a number in a text."""
Value = Union[float, int]


def number_of(raw: object) -> float:
    """Return a raw element as a number, NaN for UNKNOWN."""
    if type(raw) is float:
        return raw
    if isinstance(raw, (bool, str, bytes)):
        return math.nan
    try:
        return float(raw)  # type: ignore[arg-type]  # a number of numpy, or what is none
    except (TypeError, ValueError, OverflowError):
        return math.nan


def truth_of(raw: object) -> int:
    """Return a raw element as 0, 1 or 2."""
    try:
        return 1 if raw is None or raw not in (False, True) else 2 if raw else 0
    except (TypeError, ValueError):
        return 1


def number_in(raw: object) -> float:
    """Return the number that a text represents in decimal, NaN for UNKNOWN."""
    text = raw.strip(" \t") if isinstance(raw, str) else ""
    plain = text.lstrip("+-") if len(text) <= MAX_TEXT else ""
    if not plain or not (plain[0].isdigit() or plain[0] == ".") or "_" in plain:
        return math.nan
    if not text.isascii():
        return math.nan
    try:
        value = float(text)
    except ValueError:
        return math.nan
    return value if value - value == 0.0 else math.nan


def finite(value: float) -> float:
    """Return a number, NaN for one that is none."""
    return value if value - value == 0.0 else math.nan


def root(x: float) -> float:
    """Return the square root, NaN below 0."""
    return math.sqrt(x) if 0.0 <= x < math.inf else math.nan


def least(a: float, b: float) -> float:
    """Return the lesser of two numbers; NaN absorbs."""
    return math.nan if math.isnan(a) or math.isnan(b) else min(a, b)


def greatest(a: float, b: float) -> float:
    """Return the greater of two numbers; NaN absorbs."""
    return math.nan if math.isnan(a) or math.isnan(b) else max(a, b)


def _quotient(a: float, b: float) -> float:
    return finite(a / b) if b and b - b == 0.0 else math.nan


def _compared(test: Callable[[Any, Any], bool]) -> Callable[[float, float], int]:
    return lambda a, b: 1 if math.isnan(a) or math.isnan(b) else 2 if test(a, b) else 0


OPERATIONS: Mapping[str, Callable[..., Value]] = {
    "neg": lambda a: finite(-a),
    "abs": abs,
    "sqrt": root,
    "least": least,
    "greatest": greatest,
    "add": lambda a, b: finite(a + b),
    "sub": lambda a, b: finite(a - b),
    "mul": lambda a, b: finite(a * b),
    "div": _quotient,
    "lt": _compared(lambda a, b: a < b),
    "le": _compared(lambda a, b: a <= b),
    "gt": _compared(lambda a, b: a > b),
    "ge": _compared(lambda a, b: a >= b),
    "eq": _compared(lambda a, b: a == b),
    "ne": _compared(lambda a, b: a != b),
    "eq_bool": lambda a, b: 1 if a == 1 or b == 1 else 2 - (a ^ b),
    "ne_bool": lambda a, b: 1 if a == 1 or b == 1 else a ^ b,
    "xor": lambda a, b: 1 if a == 1 or b == 1 else a ^ b,
    "and": min,
    "or": max,
    "not": lambda a: 2 - a,
    "implies": lambda a, b: max(2 - a, b),
    "known": lambda a: 0 if math.isnan(a) else 2,
    "known_bool": lambda a: 0 if a == 1 else 2,
}
"""What can be done with one element and with numbers of its message."""


def _sum(known: Sequence[float]) -> float:
    return math.fsum(known)


def _median(known: Sequence[float]) -> float:
    ordered = sorted(known)
    low, high = ordered[(len(ordered) - 1) // 2], ordered[len(ordered) // 2]
    return low if low == high else low / 2 + high / 2


def _deviation(known: Sequence[float]) -> float:
    if len(known) < 2:
        return math.nan
    mean = math.fsum(known) / len(known)
    return math.sqrt(math.fsum((x - mean) * (x - mean) for x in known) / (len(known) - 1))


AGGREGATES: Mapping[str, Callable[[Sequence[float]], float]] = {
    "list_min": min,
    "list_max": max,
    "list_median": _median,
    "list_sum": lambda known: finite(_sum(known)),
    "list_average": lambda known: finite(_sum(known) / len(known)),
    "list_stddev": lambda known: finite(_deviation(known)),
}
CONVERSIONS: Mapping[str, Callable[[object], Value]] = {
    "number": number_of,
    "bool": truth_of,
    "text": number_in,
}
"""Type of an input -> how a raw value of it is read."""
