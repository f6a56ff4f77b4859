"""Exact arithmetic of the ranges of a numeric dimension: merging, inclusion, overlap."""

from __future__ import annotations

import math
from dataclasses import dataclass
from fractions import Fraction
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from eddi_scaffold.kinds.consert.model import Bound, Range

Exact = Fraction | float
"""A fraction, or an infinity."""

_MAX_DIGITS = 1000


@dataclass(frozen=True)
class Interval:
    """A range with exact ends; the end lies inside when ``closed``, the start unless ``open``."""

    start: Exact
    end: Exact
    closed: bool
    open: bool = False


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


def span(one: Range, factor: Fraction = Fraction(1)) -> Interval:
    """Return a range with exact ends, multiplied by a positive factor."""
    start, end = (
        value if isinstance(value, float) else value * factor
        for value in (exact(one.start), exact(one.end))
    )
    return Interval(start, end, one.inclusive, not one.start_inclusive)


def is_nan(bound: Bound) -> bool:
    """Return whether a bound is not a number."""
    return math.isnan(bound.value)


def is_empty(one: Range) -> bool:
    """Return whether no double lies in a range."""
    exact_span = span(one)
    if exact_span.closed and not exact_span.open:
        return exact_span.start > exact_span.end
    if exact_span.open and math.nextafter(one.start.value, math.inf) > one.end.value:
        return True
    return exact_span.start >= exact_span.end


def overlap(ranges: Sequence[Range]) -> list[tuple[Range, Range]]:
    """Return pairs of neighbouring ranges that share more than an end, by their starts."""
    found: list[tuple[Range, Range]] = []
    widest: tuple[Interval, Range] | None = None
    for here, one in sorted(((span(r), r) for r in ranges), key=lambda pair: _by_start(pair[0])):
        if widest is not None and _shares(widest[0], here):
            found.append((widest[1], one))
        if widest is None or (here.end, here.closed) > (widest[0].end, widest[0].closed):
            widest = here, one
    return found


def merged(spans: Iterable[Interval]) -> list[Interval]:
    """Return the same numbers in as few spans as possible, by their starts."""
    result: list[Interval] = []
    for here in sorted(spans, key=_by_start):
        if result and _touches(result[-1], here):
            before = result.pop()
            end, closed = max((before.end, before.closed), (here.end, here.closed))
            here = Interval(before.start, end, closed, before.open)  # noqa: PLW2901 - it goes on
        result.append(here)
    return result


def is_inside(inner: Iterable[Interval], outer: Iterable[Interval]) -> bool:
    """Return whether every number of ``inner`` is one of ``outer``."""
    outside = merged(outer)
    return all(any(_contains(o, i) for o in outside) for i in merged(inner))


def common(first: Iterable[Interval], second: Iterable[Interval]) -> bool:
    """Return whether some number lies in both."""
    others = list(second)
    return any(_meet(one, other) for one in first for other in others)


def _meet(first: Interval, second: Interval) -> bool:
    start, is_open = max((first.start, first.open), (second.start, second.open))
    end, is_end_open = min((first.end, not first.closed), (second.end, not second.closed))
    return start < end or (start == end and not is_open and not is_end_open)


def _by_start(one: Interval) -> tuple[Exact, bool, Exact, bool]:
    return one.start, one.open, one.end, one.closed


def _touches(first: Interval, second: Interval) -> bool:
    """Return whether no number lies between two spans, of which the first begins first."""
    if second.start == first.end:
        return first.closed or not second.open
    return second.start < first.end


def _shares(first: Interval, second: Interval) -> bool:
    return second.start < first.end or (
        second.start == first.end and first.closed and first.start == second.start
    )


def _contains(outer: Interval, inner: Interval) -> bool:
    if (inner.start, inner.open) < (outer.start, outer.open):
        return False
    if inner.closed and not outer.closed:
        return inner.end < outer.end
    return inner.end <= outer.end


def range_text(one: Range, unit: str | None = None) -> str:
    """Return a range for people: ``[0, 5] m``, ``[0, 5)``."""
    opening, closing = "[" if one.start_inclusive else "(", "]" if one.inclusive else ")"
    return f"{opening}{one.start.text}, {one.end.text}{closing}" + (f" {unit}" if unit else "")
