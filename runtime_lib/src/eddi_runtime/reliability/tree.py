"""Fault trees at run time: probabilities of the events, then one pass through the diagram."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Callable, List, Sequence

from .component import NAN, Component, Estimate, Importance, Known, Moment, Values, hazard, sure

if TYPE_CHECKING:  # a tree without dynamic gates has no chain
    from .chain import Chain

expm1 = math.expm1


def weibull(age: float, ahead: float, scale: float, shape: float) -> float:
    """Return the probability that what works at an age fails within the time ahead."""
    return -expm1(-hazard(age, ahead, scale, shape))


class FaultTree(Component):
    """What a compiled fault tree inherits; its events have numbers from 0 on."""

    names: tuple[str, ...]  # of the events
    # (event, id of the input that reports whether it has happened)
    observed: tuple[tuple[int, str], ...] = ()
    models: tuple[tuple[int, str], ...] = ()  # (event, model whose failure it is)
    # (event that stands for a dynamic gate, chain over the orders of occurrence)
    orders: tuple[tuple[int, type[Chain]], ...] = ()
    repair = False  # an event that has happened may be undone
    # (event, high, low) of the diagram, lower ones first; 0 and 1 are the leaves false and true,
    # node ``i`` has the number ``i + 2``; empty where sums that are written out are enough
    nodes: tuple[tuple[int, int, int], ...] = ()
    # (age, horizon) -> the probability of each event, those without a formula being 0. An event
    # that is observed not to have happened counts from now on only.
    laws: Callable[[float, float], List[float]]
    # probabilities of all events -> that of the top event, and of its opposite: sums of products
    # of what is not negative
    failure: Callable[[Sequence[float]], float]
    survival: Callable[[Sequence[float]], float]
    _high: Sequence[float] = ()

    def __init__(self) -> None:
        self._chains = [(i, make()) for i, make in self.orders]
        self.reset()

    def interval(self, low: Sequence[float], high: Sequence[float]) -> tuple[float, float]:
        """Return bounds of the top event's probability for events in [low, high].

        Exact for coherent trees, and where only the first events in the order are [0, 1].
        """
        if self.grows:  # monotone: the corners are the bounds
            return self.failure(low), self.failure(high)
        values: list[tuple[float, float]] = [(0.0, 0.0), (1.0, 1.0)]
        for event, up, down in self.nodes:
            (up_low, up_high), (down_low, down_high) = values[up], values[down]
            chances = low[event], high[event]
            least = min([p * up_low + (1.0 - p) * down_low for p in chances])
            most = max([p * up_high + (1.0 - p) * down_high for p in chances])
            values.append((least, most))
        return values[-1]

    def step(self, values: Values, moment: Moment, known: Known) -> Estimate:
        low = self.laws(moment.age, moment.horizon)
        reason = ""
        unknown: list[str] = []
        for i, chain in self._chains:
            low[i] = chain.step(moment, chain.everything).high
        high = low
        for i, name in self.models:
            best, worst, _, _, missing, why = known[name]
            if best != worst and high is low:
                high = list(low)
            low[i], high[i] = best, worst
            if missing:
                unknown += missing
            reason = reason or why
        happened = self._happened
        for i, name in self.observed:
            value = values[name]
            if value is not False or happened[i]:
                value = self.has_failed(name, value, before=happened[i], repair=self.repair)
                happened[i] = value is True
            if value is None:
                unknown.append(name)
                high = list(low) if high is low else high
                high[i] = 1.0
            elif value:
                low[i] = high[i] = 1.0
        self._high = high
        best, worst, alive = self.probability(low, high)
        if best == worst and not unknown:
            return sure(best, alive, NAN, reason)
        return Estimate(best, worst, alive, NAN, tuple(dict.fromkeys(unknown)), reason)

    def probability(self, low: list[float], high: list[float]) -> tuple[float, float, float]:
        if high is low:
            p = self.failure(low)
            alive = 1.0 - p if p <= 0.5 else self.survival(low)
            p = min(p, 1.0)
            return p, p, alive
        best, worst = self.interval(low, high)
        worst = min(worst, 1.0)
        return min(best, 1.0), worst, 1.0 - worst

    def reset(self) -> None:
        super().reset()
        self._happened = {i: False for i, _ in self.observed}
        for _, chain in self._chains:
            chain.reset()

    def importances(self) -> tuple[Importance, ...]:
        q = list(self._high)
        if not q:
            return ()
        total = self.failure(q)
        rows = [self._importance(i, q, total) for i in range(len(self.names))]
        return tuple(sorted(rows, key=lambda row: (-row.criticality, row.event)))

    def _importance(self, i: int, q: list[float], total: float) -> Importance:
        p = q[i]
        sure = self.failure([*q[:i], 1.0, *q[i + 1 :]])
        never = self.failure([*q[:i], 0.0, *q[i + 1 :]])
        birnbaum = sure - never
        share = birnbaum * p / total if total else NAN
        reduction = total / never if never else math.inf
        achievement = sure / total if total else NAN
        return Importance(self.names[i], p, birnbaum, share, achievement, reduction)
