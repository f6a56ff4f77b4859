"""Lists of a message: read as columns, brought to one value; compiled reductions call this.

Numbers are floats, NaN is UNKNOWN; truth values are 0 < 1 < 2 (strong Kleene). ``Unknown`` is
raised where a list has no value. The text below the imports is copied into generated modules.
"""

from __future__ import annotations

import math
from typing import Any, Callable, Sequence

from . import Unknown

MAX_ELEMENTS = 100_000  # a longer list is UNKNOWN, so that one message cannot stop a monitor
MAX_TEXT = 100  # characters of a number in a text


def number_of(raw: object) -> float:
    """Return a raw element as a number, NaN for UNKNOWN."""
    if type(raw) is float:
        return raw
    if type(raw) is bytes and len(raw) == 1:  # a ``byte`` in rclpy
        return float(raw[0])
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
    try:
        return finite(float(text)) if text.isascii() else math.nan
    except ValueError:
        return math.nan


def finite(value: float) -> float:
    """Return a number, NaN for one that is none."""
    return value if value - value == 0.0 else math.nan


def quotient(a: float, b: float) -> float:
    """Return a / b, NaN where that is no number."""
    return finite(a / b) if b and b - b == 0.0 else math.nan


def root(x: float) -> float:
    """Return the square root, NaN below 0."""
    return math.sqrt(x) if 0.0 <= x < math.inf else math.nan


def column(raw: object, name: str, convert: Callable[[object], float] = number_of) -> list[float]:
    """Return a list as a column of floats or truth values."""
    if raw is None:
        raise Unknown(f"no {name}")
    items: Any = raw.tolist() if hasattr(raw, "tolist") else raw
    if isinstance(items, str) or not hasattr(items, "__len__"):
        raise Unknown(f"{name} is no list")
    if len(items) > MAX_ELEMENTS:
        raise Unknown(f"{len(items)} elements are more than {MAX_ELEMENTS}")
    if convert is number_of:  # most are floats: no call for them
        return [x if type(x) is float else number_of(x) for x in items]
    return list(map(convert, items))


def known(values: Sequence[float], *ranges: tuple[float, float], infinite: bool) -> list[float]:
    """Return a column with NaN for what does not count."""
    numbers = values if infinite else [x if x - x == 0.0 else math.nan for x in values]
    for low, high in ranges:
        numbers = [x if low <= x <= high or x - x != 0.0 else math.nan for x in numbers]
    return list(numbers)


def limited(values: Sequence[float], low: float, high: float) -> list[float]:
    """Return a column with NaN for finite numbers outside of limits of its message."""
    if math.isnan(low) or math.isnan(high):
        raise Unknown("the limits are not known")
    return known(values, (low, high), infinite=True)


def length_of(columns: Sequence[Sequence[object]], wanted: tuple[int, int] | None = None) -> int:
    """Return how many elements parallel lists have."""
    lengths = {len(column) for column in columns}
    if len(lengths) > 1:
        raise Unknown(f"lists of different lengths: {sorted(lengths)}")
    (count,) = lengths
    if wanted is not None and not wanted[0] <= count <= wanted[1]:
        raise Unknown(f"{count} elements instead of {'..'.join(map(str, dict.fromkeys(wanted)))}")
    return count


def sector(
    count: int, start: float, end: float, step: float, low: float, high: float
) -> tuple[int, int]:
    """Return the first element of a scan in the sector, and the one behind the last."""
    if count == 0:
        return 0, 0
    half = abs(step) / 2
    last = start + (count - 1) * step
    if not (half > 0.0 and finite(half) == half and abs(last - end) <= 3 * half):
        raise Unknown("the angles of the scan contradict its length")
    if not (min(start, last) - half <= low and high <= max(start, last) + half):
        raise Unknown("the sector is not wholly within the scan")
    ends = sorted(int((angle - start) / step) for angle in (low - half, high + half))
    near = range(max(0, ends[0] - 1), min(count, ends[1] + 2))
    inside = [k for k in near if low - half <= start + k * step <= high + half]
    return (inside[0], inside[-1] + 1) if inside else (0, 0)


def aggregate(
    how: Callable[[list[float]], float], values: Sequence[float], coverage: float | None = None
) -> float:
    """Return one number for a column."""
    there = [x for x in values if not math.isnan(x)]
    _enough(len(there), len(values), coverage)
    try:
        result = float(how(there))
    except (OverflowError, ValueError):  # sums of infinities, or beyond doubles
        result = math.nan
    if math.isnan(result):
        raise Unknown("the value is not finite")
    return result


def count(values: Sequence[int], coverage: float | None = None) -> float:
    """Return how many truth values are true."""
    _enough(len(values) - values.count(1), len(values), coverage)
    return float(values.count(2))


def decided(values: Sequence[int], decisive: int, coverage: float | None = None) -> bool:
    """Return ANY (decided by 2) or ALL (decided by 0) of truth values."""
    if decisive in values:
        return decisive == 2
    _enough(len(values) - values.count(1), len(values), coverage)
    return decisive == 0


def _enough(there: int, of: int, coverage: float | None) -> None:
    if there < of if coverage is None else not there or there / of < coverage:
        raise Unknown(f"{of - there} of {of} elements are not known")


def median(there: list[float]) -> float:
    """Return the value in the middle, or the mean of the two there."""
    ordered = sorted(there)
    low, high = ordered[(len(ordered) - 1) // 2], ordered[len(ordered) // 2]
    return low if low == high else low / 2 + high / 2


def total(there: list[float]) -> float:
    """Return the sum, rounded once."""
    return finite(math.fsum(there))


def average(there: list[float]) -> float:
    """Return the mean."""
    return finite(math.fsum(there) / len(there))


def deviation(there: list[float]) -> float:
    """Return the sample standard deviation, NaN for less than two numbers."""
    if len(there) < 2:
        return math.nan
    mean = math.fsum(there) / len(there)
    return finite(math.sqrt(math.fsum((x - mean) * (x - mean) for x in there) / (len(there) - 1)))
