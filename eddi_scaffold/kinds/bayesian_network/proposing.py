"""Edges of bins that the names of states suggest: shown as a comment, never used by themselves."""

from __future__ import annotations

import re
from collections.abc import Sequence
from itertools import pairwise

_NUMBER = r"(\d+(?:[._]\d+)?)"
_BETWEEN = re.compile(rf"(?:\D*_)?{_NUMBER}_?(?:to|-|_)_?{_NUMBER}(?:_\D*)?")
_ABOVE = re.compile(rf"(?:more_than|above|over|gt|greater_than|ge|>=?)_?{_NUMBER}(?:_\D*)?")
_BELOW = re.compile(rf"(?:less_than|below|under|lt|le|<=?)_?{_NUMBER}(?:_\D*)?")


def proposed_bins(states: Sequence[str]) -> list[float] | None:
    """Return the edges between states such as ``range_0_to_1_m`` and ``more_than_2_m``.

    ``None`` when the names do not give one ascending series over all states, with at most one
    state in front that names no number.
    """
    spans = [_span(state) for state in states]
    if spans and spans[0] is None and len(states) > 2:
        spans = [(None, spans[1][0] if spans[1] else None), *spans[1:]]
    if not spans or any(span is None for span in spans):
        return None
    known = [span for span in spans if span is not None]
    edges = []
    for (_, high), (low, _) in pairwise(known):
        edge = high if high is not None else low
        if edge is None or (low is not None and low != edge):
            return None
        edges.append(edge)
    rising = all(a < b for a, b in pairwise(edges))
    return edges if edges and rising else None


def _span(state: str) -> tuple[float | None, float | None] | None:
    """Return the numbers between which a state lies, by its name."""
    name = state.casefold()
    between = _BETWEEN.fullmatch(name)
    if between:
        return _value(between[1]), _value(between[2])
    above = _ABOVE.fullmatch(name)
    if above:
        return _value(above[1]), None
    below = _BELOW.fullmatch(name)
    return (None, _value(below[1])) if below else None


def _value(text: str) -> float:
    return float(text.replace("_", "."))
