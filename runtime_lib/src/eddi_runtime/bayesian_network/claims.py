"""Evidence that a network gives to ConSerts: it holds for every state that is possible."""

from __future__ import annotations

import itertools
import math
from typing import Callable, List, Mapping, NamedTuple, Optional, Sequence, Tuple

from ..thresholds import Evidence, Threshold
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
    """Bounds of some probabilities, each over all combinations that are possible.

    Exact: a posterior under likelihoods is a weighted mean of those under the states.
    """

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


__all__ = ["Claim", "Claims", "StateThreshold", "Threshold"]

INCONSISTENT = "inconsistent"
TOO_MANY = "too many unknown inputs"
UNKNOWN_INPUTS = "unknown inputs"
UNKNOWN = (UNKNOWN_INPUTS, TOO_MANY)
HOLD = "hold"
BETWEEN = "between limits"
NO_TIME = "no time"
ERROR = "error"
REASONS = {
    BETWEEN: "it lies between its limits, and was not known before",
    ERROR: "a hand-written method failed",
    HOLD: "it holds, but not for long enough yet",
    INCONSISTENT: "the evidence has probability zero",
    NO_TIME: "the step has no time",
}


class StateThreshold(NamedTuple):
    """A threshold of the probability of some states of a node."""

    node: int  # number of the node
    states: tuple[int, ...]  # numbers of the states whose probabilities are added up
    at_least: bool  # the probability must not be below; else it must not be above
    limits: Threshold  # where it begins and ends; of the negative probability for ``at_least``


class Claim(NamedTuple):
    """Result of a threshold in the last step."""

    id: str  # of the threshold
    active: bool  # the probability is on the right side for every state that is possible
    low: float  # lower bound of the probability; NaN: not computed
    high: float  # upper bound
    reason: str  # why it is not active; empty when it is, or is known to be on the wrong side

    def bounds(self, form: str) -> str:
        """Return the bounds for people, empty where they were not computed."""
        if math.isnan(self.low):
            return ""
        low, high = format(self.low, form), format(self.high, form)
        return low if self.low == self.high else f"{low} to {high}"

    def text(self) -> str:
        """Return the result for people."""
        active, bounds = "active" if self.active else "not active", self.bounds(".3g")
        reason = f" ({self.reason})" if self.reason else ""
        return f"{self.id}: {active}{', ' if bounds else ''}{bounds}{reason}"


class Claims:
    """The thresholds of a network with their state."""

    def __init__(self, thresholds: Sequence[StateThreshold]) -> None:
        self._thresholds = thresholds
        self._evidence = [Evidence(threshold.limits) for threshold in thresholds]
        self._plan = (
            [threshold.at_least for threshold in thresholds],
            [threshold.limits.hold_ns for threshold in thresholds],
            [one.step for one in self._evidence],
        )
        self.reset()

    def prepare(self, outputs: Sequence[int], infer: Infer) -> None:
        """Take over a compiled engine: the numbers of its outputs, and how posteriors come."""
        picks = [
            pick_of(outputs.index(threshold.node), threshold.states)
            for threshold in self._thresholds
        ]
        self._picks, self._over = picks, Bounds(infer, picks)

    def reset(self) -> None:
        """Return to inactive."""
        for one in self._evidence:
            one.reset()
        self._bounds: Sequence[Pair] | None = None
        self._reason, self._known, self._timely = UNKNOWN_INPUTS, False, True

    def step(
        self,
        now: float,
        rows: Rows | None,
        states: list[int],
        weights: Mapping[int, list[float]],
        opened: Sequence[Open],
    ) -> None:
        """Judge every threshold."""
        self._known = not opened
        if opened and combinations(opened) > COMBINATIONS:
            self.lose(TOO_MANY)
            return
        bounds: Sequence[Pair] | None = None
        if opened:
            bounds = self._over.over(states, weights, opened)
        elif rows is not None:
            bounds = [(pick(rows),) * 2 for pick in self._picks]
        if bounds is None:
            self.lose(INCONSISTENT)
            return
        self._bounds, self._timely = bounds, now == now  # noqa: PLR0124 - the test for NaN
        for at_least, hold_ns, step, (low, high) in zip(*self._plan, bounds):
            usable = self._timely or not hold_ns
            worst, best = (-low, -high) if at_least else (high, low)
            step(now, worst, usable=usable, best=best)

    def lose(self, reason: str) -> None:
        """Let nothing be active, whatever the probabilities are."""
        self._bounds, self._reason = None, reason
        for one in self._evidence:
            one.step(0, math.nan, usable=False)

    def rows(self) -> list[Claim]:
        """Return the result of each threshold in the last step."""
        bounds = self._bounds or [(math.nan, math.nan)] * len(self._thresholds)
        return [
            Claim(
                threshold.limits.id, evidence.active, *pair, self._why(threshold, evidence, pair)
            )
            for threshold, evidence, pair in zip(self._thresholds, self._evidence, bounds)
        ]

    def _why(self, one: StateThreshold, evidence: Evidence, pair: Pair) -> str:
        if evidence.active:
            return ""
        if self._bounds is None:
            return self._reason
        if not evidence.possible:
            return ""
        if (-pair[0] if one.at_least else pair[1]) <= one.limits.activate:
            return HOLD if self._timely else NO_TIME
        return BETWEEN if self._known else UNKNOWN_INPUTS
