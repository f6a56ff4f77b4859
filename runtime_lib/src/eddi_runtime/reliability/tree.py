"""Fault trees at run time: probabilities of the events, then one pass through the diagram."""

from __future__ import annotations

import math
from math import expm1
from typing import List, NamedTuple, Optional, Sequence, Tuple

import numpy as np

from . import diagram as bdd
from .chain import Chain, ChainSpec, Horizons
from .component import AGAIN, Component, Known
from .cut_sets import CutSet, CutSetBounds, minimal_cut_sets
from .estimate import Estimate, Moment, Values
from .estimate import known as sure
from .weibull import hazard

_NAN = float("nan")
DYNAMIC = ("PAND", "POR")
_MANY = 20
"""Events from which on numpy is faster than a loop."""


class Event(NamedTuple):
    """A basic event.

    Attributes:
        name: for people.
        law: ``exponential`` (1/h), ``weibull`` (scale in h, shape), ``fixed`` (probability),
            ``model`` (of another model), ``PAND`` or ``POR`` (rates of the inputs, 1/h).
        values: numbers of the law.
        model: name of the model.
        input: id of the input that reports whether it has happened; None: not observed.
        age: hours that it had run before the start of the mission.
    """

    name: str
    law: str
    values: Tuple[float, ...] = ()
    model: str = ""
    input: Optional[str] = None
    age: float = 0.0


class Importance(NamedTuple):
    """How much one event matters for the top event, at present probabilities.

    Attributes:
        event: its name.
        probability: of the event.
        birnbaum: p(top | event) - p(top | not event).
        criticality: share of the top's probability in which the event decides.
        achievement: risk achievement worth: p(top | event) / p(top).
        reduction: risk reduction worth: p(top) / p(top | not event).
    """

    event: str
    probability: float
    birnbaum: float
    criticality: float
    achievement: float
    reduction: float


class FaultTree(Component):
    """A fault tree, compiled once.

    Args:
        events: in the order of their numbers.
        gates: each refers to events and to gates before it.
        top: number of the top event.
        quantum: hours.
        horizons: where to look ahead.
        repair: an event that has happened may be undone.
        limit: nodes of the diagram.
        cut_sets: all minimal cut sets of a coherent tree whose diagram would be too large: its
            probability is then given by bounds.

    Raises:
        TooLargeError: the diagram has more nodes than the limit.
    """

    def __init__(
        self,
        events: Sequence[Event],
        gates: Sequence[bdd.Gate],
        top: int,
        *,
        quantum: float,
        horizons: Horizons,
        repair: bool = False,
        limit: int = bdd.NODE_LIMIT,
        cut_sets: Optional[Sequence[Sequence[int]]] = None,
    ) -> None:
        self.events = tuple(events)
        self._bounded: Optional[CutSetBounds] = None
        self._cut_sets: Optional[Tuple[CutSet, ...]] = None
        if cut_sets is not None:
            self._cut_sets = tuple(frozenset(one) for one in cut_sets)
            self._bounded = bounds = CutSetBounds(cut_sets)
            self._failure: bdd.Evaluate = bounds.upper
            self._survival: bdd.Evaluate = bounds.survival
        else:
            first = frozenset(i for i, e in enumerate(events) if e.input is not None)
            self._diagram = bdd.build(len(events), gates, top, first, limit)
            self._failure = bdd.probability(self._diagram)
            self._survival = bdd.probability(self._diagram, of_failure=False)
        self._repair = repair
        self._static = _Laws(self.events)
        self._chains = [
            (i, Chain(_order(e.law, e.values), quantum, horizons, e.age))
            for i, e in enumerate(events)
            if e.law in DYNAMIC
        ]
        self._inputs = [(i, e.input) for i, e in enumerate(events) if e.input is not None]
        self._models = [(i, e.model) for i, e in enumerate(events) if e.law == "model"]
        self._failed = [False] * len(self.events)
        self._low: List[float] = []
        self._high: List[float] = []

    @property
    def grows(self) -> bool:
        """Return whether the tree is coherent."""
        return self._bounded is not None or self._diagram.coherent

    def step(self, values: Values, moment: Moment, known: Known) -> Estimate:
        """Find the probabilities of all events and of the top event."""
        low = self._static.at(moment.age, moment.horizon)
        reason = ""
        unknown: List[str] = []
        for i, chain in self._chains:
            low[i] = chain.step(moment, chain.everything).high
        high = low
        intervals = False
        for i, name in self._models:
            best, worst, _, _, missing, why = known[name]
            if best != worst:
                high = list(low) if high is low else high
                intervals = True
            low[i], high[i] = best, worst
            if missing:
                unknown += missing
            reason = reason or why
        failed = self._failed
        for i, name in self._inputs:
            value = values[name]
            happened = value if value is False and not failed[i] else self._status(i, value)
            if happened is None:
                unknown.append(name)
                high = list(low) if high is low else high
                intervals = True
                high[i] = 1.0
            elif happened:
                low[i] = high[i] = 1.0
        self._low, self._high = low, high
        if self._bounded is not None:
            best, worst = self._bounded.lower(low), min(self._failure(high), 1.0)
            alive = self._survival(high)
        elif not intervals:
            p = self._failure(low)
            alive = 1.0 - p if p <= 0.5 else self._survival(low)
            if not unknown:
                return sure(min(p, 1.0), alive, _NAN, reason)
            best = worst = min(p, 1.0)
        else:
            best, worst = self._bounds(low, high)
            best, worst = min(best, 1.0), min(worst, 1.0)
            alive = 1.0 - worst
        return Estimate(best, worst, alive, _NAN, tuple(dict.fromkeys(unknown)), reason)

    def _bounds(self, low: List[float], high: List[float]) -> Tuple[float, float]:
        if self._diagram.coherent:  # monotone: the corners are the bounds
            return self._failure(low), self._failure(high)
        return bdd.interval(self._diagram, low, high)

    def _status(self, i: int, value: Optional[bool]) -> Optional[bool]:
        if self._failed[i] and value is not True and not self._repair:
            name = self.events[i].input
            if value is False and name is not None:
                self.latched += 1
                self._report_fault(name, AGAIN)
            return True
        self._failed[i] = value is True
        return value

    def prepare(self, horizons: Horizons) -> None:
        """Prepare other horizons."""
        for _, chain in self._chains:
            chain.prepare(horizons)
        self.reset()

    def reset(self) -> None:
        """Forget what has happened."""
        super().reset()
        self._failed = [False] * len(self.events)
        for _, chain in self._chains:
            chain.reset()

    def importances(self) -> Tuple[Importance, ...]:
        """Return how much each event matters in the worst case of the last step, most first."""
        q = list(self._high)
        if not q:
            return ()
        total = self._failure(q)
        found = [self._importance(i, q, total) for i in range(len(self.events))]
        return tuple(sorted(found, key=lambda one: (-one.criticality, one.event)))

    def _importance(self, i: int, q: List[float], total: float) -> Importance:
        p = q[i]
        q[i] = 1.0
        sure = self._failure(q)
        q[i] = 0.0
        never = self._failure(q)
        q[i] = p
        birnbaum = sure - never
        share = birnbaum * p / total if total else _NAN
        return Importance(
            self.events[i].name,
            p,
            birnbaum,
            share,
            sure / total if total else _NAN,
            total / never if never else math.inf,
        )

    def cut_sets(self) -> Optional[Tuple[CutSet, ...]]:
        """Return the minimal cut sets as sets of event numbers; None: too many, or too much work.

        Raises:
            ValueError: the tree is not coherent.
        """
        return minimal_cut_sets(self._diagram) if self._cut_sets is None else self._cut_sets


class _Laws:
    """Probabilities of all events with a formula."""

    def __init__(self, events: Sequence[Event]) -> None:
        laws = [(i, e) for i, e in enumerate(events) if e.law == "exponential"]
        self._ageing = [(i, -e.values[0], e.age) for i, e in laws if e.input is None]
        self._seen = [(i, -e.values[0]) for i, e in laws if e.input is not None]
        self._rates = np.array([rate for _, rate, _ in self._ageing])
        self._ages = np.array([age for _, _, age in self._ageing])
        self._weibull = [(i, e) for i, e in enumerate(events) if e.law == "weibull"]
        self._fixed = [e.values[0] if e.law == "fixed" else 0.0 for e in events]
        self._horizon = -1.0
        self._base = self._fixed

    def at(self, age: float, horizon: float) -> List[float]:
        """Return the probability of each event, those without a formula being 0.

        An event that is observed not to have happened counts from now on only.
        """
        if horizon != self._horizon:
            self._horizon, self._base = horizon, list(self._fixed)
            for i, rate in self._seen:
                self._base[i] = -expm1(rate * horizon)
        q = self._base.copy()
        until = age + horizon
        if len(self._ageing) < _MANY:
            for i, rate, before in self._ageing:
                q[i] = -expm1(rate * (before + until))
        else:
            values = np.expm1(self._rates * (self._ages + until)).tolist()
            for (i, _, _), value in zip(self._ageing, values):
                q[i] = -value
        for i, event in self._weibull:
            scale, shape = event.values
            whole = event.age + age
            if event.input is None:
                q[i] = -expm1(-hazard(0.0, whole + horizon, scale, shape))
            else:
                q[i] = -expm1(-hazard(whole, horizon, scale, shape))
        return q


def _order(law: str, rates: Sequence[float]) -> ChainSpec:
    """Return the chain over orders of occurrence of a dynamic gate."""
    count = len(rates)
    if law == "POR":  # 0: nothing yet, 1: the first came first, 2: another one did
        return ChainSpec(3, 0, (1,), ((0, 1, rates[0]), (0, 2, math.fsum(rates[1:]))))
    lost = count + 1
    arcs = []
    for done in range(count):
        arcs.append((done, done + 1, rates[done]))
        arcs += [(done, lost, rate) for rate in rates[done + 1 :]]
    return ChainSpec(count + 2, 0, (count,), tuple(arcs))
