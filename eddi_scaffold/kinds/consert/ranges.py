"""Exact arithmetic of the ranges of a numeric dimension: merging, inclusion, what is common."""

from __future__ import annotations

import math
from collections.abc import Iterable
from fractions import Fraction
from itertools import product
from typing import NamedTuple

from eddi_scaffold.kinds.consert.consert import Bound, Range

Exact = Fraction | float  # A fraction, or an infinity
_MAX_DIGITS = 1000


class Interval(NamedTuple):
    """A range with exact ends; the end lies inside when ``closed``, the start unless ``open``.

    They are ordered by their starts.
    """

    start: Exact
    open: bool
    end: Exact
    closed: bool


def exact(bound: Bound) -> Exact:
    """Return the bound as the exact value of its decimal text; infinities stay floats."""
    if math.isinf(bound.value):
        return bound.value
    if bound.value == 0.0:  # also 1e-999999999, with which exact arithmetic would not end
        return Fraction(0)
    try:
        return Fraction(bound.text if len(bound.text) <= _MAX_DIGITS else bound.value)
    except ValueError:
        return Fraction(bound.value)


def span(covered: Range, factor: Fraction = Fraction(1)) -> Interval:
    """Return a range with exact ends, multiplied by a positive factor."""
    start, end = (
        value if isinstance(value, float) else value * factor
        for value in (exact(covered.start), exact(covered.end))
    )
    return Interval(start, not covered.start_inclusive, end, covered.inclusive)


def is_empty(covered: Range) -> bool:
    """Return whether no double lies in a range."""
    start, is_open, end, is_closed = span(covered)
    if is_closed and not is_open:
        return start > end
    no_double = math.nextafter(covered.start.value, math.inf) > covered.end.value
    return start >= end or (is_open and no_double)


def merged(intervals: Iterable[Interval]) -> list[Interval]:
    """Return the same numbers in as few intervals as possible, by their starts."""
    result: list[Interval] = []
    for interval in sorted(intervals):
        before = result[-1] if result else None
        if before is not None and (
            interval.start < before.end
            or (interval.start == before.end and (before.closed or not interval.open))
        ):
            result[-1] = Interval(*before[:2], *max(before[2:], interval[2:]))
        else:
            result.append(interval)
    return result


def is_inside(inner: Iterable[Interval], outer: Iterable[Interval]) -> bool:
    """Return whether every number of ``inner`` is one of ``outer``."""
    outside = merged(outer)
    return all(any(o[:2] <= i[:2] and i[2:] <= o[2:] for o in outside) for i in merged(inner))


def common(first: Iterable[Interval], second: Iterable[Interval]) -> bool:
    """Return whether some number lies in both."""
    for interval, other in product(first, second):
        start, is_open = max(interval[:2], other[:2])
        end, is_end_open = min((interval.end, not interval.closed), (other.end, not other.closed))
        if start < end or (start == end and not is_open and not is_end_open):
            return True
    return False
