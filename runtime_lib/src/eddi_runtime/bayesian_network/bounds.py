"""Exact bounds of posteriors over states that are not known.

A posterior under likelihoods is a weighted mean of those under the states, so the states suffice.
"""

from __future__ import annotations

import itertools
import math
from typing import Callable, List, Mapping, Optional, Sequence, Tuple

from .engine import Rows

COMBINATIONS = 1024
"""States of unknown nodes, multiplied, up to which they are all tried in a step."""
_REMEMBERED = 1024

Open = Tuple[int, Tuple[int, ...]]
"""Position of an observable node whose state is not known, and the states it may be in."""
Pick = Callable[[Rows], float]
"""Takes the probability of interest out of posteriors."""
Pair = Tuple[float, float]
Infer = Callable[[List[int], Mapping[int, List[float]]], Optional[Rows]]


class Bounds:
    """Bounds of some probabilities, each over all combinations that are possible."""

    def __init__(self, infer: Infer, picks: Sequence[Pick]) -> None:
        self._infer, self._picks = infer, picks
        self._found: dict[tuple[tuple[int, ...], tuple[Open, ...]], list[Pair] | None] = {}

    def over(
        self, states: list[int], weights: Mapping[int, list[float]], opened: Sequence[Open]
    ) -> list[Pair] | None:
        """Return (lowest, highest) of each probability; None if no combination is possible."""
        if weights:
            return self._tried(states, weights, opened)
        key = tuple(states), tuple(opened)
        if key not in self._found:
            if len(self._found) >= _REMEMBERED:
                self._found.clear()
            self._found[key] = self._tried(states, weights, opened)
        return self._found[key]

    def _tried(
        self, states: list[int], weights: Mapping[int, list[float]], opened: Sequence[Open]
    ) -> list[Pair] | None:
        places = [position for position, _ in opened]
        tried = list(states)
        cases: list[list[float]] = []
        for case in itertools.product(*(possible for _, possible in opened)):
            for position, state in zip(places, case):
                tried[position] = state
            rows = self._infer(tried, weights)
            if rows is not None:
                cases.append([pick(rows) for pick in self._picks])
        return [(min(column), max(column)) for column in zip(*cases)] if cases else None


def combinations(opened: Sequence[Open]) -> int:
    """Return how many combinations of states there are."""
    return math.prod(len(possible) for _, possible in opened)


def pick_of(place: int, states: Sequence[int]) -> Pick:
    """Return what takes the probability of states of the output at a place."""
    if len(states) == 1:
        (state,) = states
        return lambda rows: rows[place][state]

    def added(rows: Rows) -> float:
        row = rows[place]
        return math.fsum([row[state] for state in states])

    return added
