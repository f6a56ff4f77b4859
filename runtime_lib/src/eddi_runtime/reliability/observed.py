"""A Markov chain of the user's own, observed through verdicts on its states."""

from __future__ import annotations

from itertools import product, repeat
from operator import mul, sub, truediv
from typing import AbstractSet, Any, Iterable

from .chain import INCONSISTENT, Belief, Chain, Seen
from .component import AGAIN, Component, Estimate, Known, Moment, Values, reader, sure


class Missed:
    """The beliefs that a chain may have since an observation of it was missed.

    Each completion of what was missed gives a belief of its own. Several are followed, of which
    all possible ones are mixtures: a probability of failure given later observations is a ratio
    of two linear functions of the belief, so the largest one is that of one of these.
    """

    def __init__(self, chain: Chain, *, lost: bool, repair: bool) -> None:
        self._chain, self._repair = chain, repair
        self.beliefs: list[Belief] = [chain.belief]  # all that are possible are mixtures of them
        self.lost = lost  # it may have been seen to fail, and not to work again

    def step(self, moment: Moment, seen: Seen) -> Estimate:
        moved = self._chain.after(self.beliefs, moment.quanta)
        kept: list[Belief] = []
        reason = INCONSISTENT
        for completion in seen.completions:
            beliefs = self._left(moved, completion)
            reason = "" if beliefs else reason
            # what is believed after an observation that leaves nothing, too
            kept += hull(beliefs) if beliefs else [self._chain.sure_of(completion.worst)]
        self.beliefs = hull(kept)
        lost = self.lost
        self.lost = any(row.fatal or (lost and not row.alive) for row in seen.completions)
        if seen.unknown:
            return self._chain.bounded(seen, moment.at, reason)
        return self._chain.bounds(self.beliefs, moment.at, reason)

    def _left(self, moved: list[Belief], completion: Seen) -> list[Belief]:
        """Return the beliefs that an observation leaves, each with a weight of one."""
        left: list[Belief] = []
        for belief in moved:
            kept = list(map(mul, belief, completion.mask))
            weight = sum(kept)
            if weight > 0.0:
                left.append(list(map(truediv, kept, repeat(weight))))
        if self.lost and (self._repair or not completion.alive):  # repaired, or still down
            left.append(self._chain.sure_of(completion.worst))
        return left


def hull(beliefs: list[Belief]) -> list[Belief]:
    """Return beliefs of which all of these are mixtures, at most as many as states in them."""
    if len(beliefs) <= sum(map(any, zip(*beliefs))):
        return beliefs
    columns = list(zip(*beliefs))
    least = list(map(min, columns))
    corners = [state for state, most in enumerate(map(max, columns)) if most > least[state]]
    if not corners:
        return beliefs[:1]
    rest = max([sum(map(sub, belief, least)) for belief in beliefs])
    whole = sum(least) + rest
    common = [value / whole for value in least]
    kept: list[Belief] = []
    for corner in corners:
        belief = common[:]
        belief[corner] = (least[corner] + rest) / whole
        kept.append(belief)
    return kept


def independent(possible: Iterable[AbstractSet[int]]) -> list[frozenset[int]]:
    """Return the sets of states that are not made of smaller ones without overlap."""
    parts: list[frozenset[int]] = []
    for whole in sorted(map(frozenset, possible), key=lambda group: (len(group), sorted(group))):
        rest = whole
        for part in parts:
            if part <= rest:
                rest -= part
        if rest or not whole:
            parts.append(whole)
    return parts


KEPT = 64  # how many different observations of a chain are kept
_ALL_VALUES = 10  # unknown inputs of a chain of which all values are tried
_LARGEST = 64
"""States up to which the beliefs are followed that a missed observation may have left."""


class MarkovChain(Component):
    """A chain of the user's own; ``observe``: (state, input id, negated), F excludes the state."""

    def __init__(
        self,
        chain: Chain,
        observe: tuple[tuple[int, str, bool], ...] = (),
        *,
        repair: bool = False,
    ) -> None:
        self.chain = chain
        self._observe, self._repair = observe, repair
        self._names = tuple(dict.fromkeys(name for _, name, _ in observe))
        self._verdicts = reader(self._names)
        self._seen: dict[tuple[Any, ...], Seen] = {(): chain.everything}
        self._forget()

    def _forget(self) -> None:
        self._lost = False  # it was seen that it has failed
        self._vague = False  # something was missed that may still matter
        self._missed: Missed | None = None
        self._missing: dict[str, float] = {}  # input -> hours of age when it was missing last
        self._may_have_failed = False  # for all that is seen now

    def step(self, values: Values, moment: Moment, known: Known) -> Estimate:
        verdicts = self._verdicts(values)
        seen = self._seen.get(verdicts)
        if seen is None:
            seen = self._see(verdicts)
        if self._lost:
            return self._again(moment, seen, verdicts)
        if self._vague or seen.unknown:
            return self._bounded(moment, seen)
        self._lost = seen.fatal
        return self.chain.step(moment, seen)

    def _again(self, moment: Moment, seen: Seen, verdicts: tuple[Any, ...]) -> Estimate:
        if self._repair:
            if seen.unknown:
                return self._bounded(moment, seen)
            result = self.chain.step(moment, seen)
            if not seen.alive:
                return result
            self._lost = False  # without weight, but no contradiction: it was repaired
            return result._replace(reason="")
        if not seen.alive:
            return sure(1.0, 0.0, 0.0)
        given = dict(zip(self._names, verdicts))
        for state, name, negated in self._observe:
            if state in self.chain.fail and given[name] is negated:
                self.report_fault(name, AGAIN)
        return sure(1.0, 0.0, 0.0, INCONSISTENT)

    def _bounded(self, moment: Moment, seen: Seen) -> Estimate:
        """Take what is seen while something that was missed may matter."""
        self._missing.update(dict.fromkeys(seen.unknown, moment.age))
        self._may_have_failed = not set(self.chain.fail).isdisjoint(seen.states)
        if self.chain.states > _LARGEST:  # bounded by all that is consistent, until it is in one
            reason = self.chain.step(moment, seen).reason
            self._vague = bool(seen.unknown) or len(seen.states) > 1
            self._lost = seen.fatal
            return self.chain.bounded(seen, moment.at, reason)
        self._vague = True
        missed = self._missed or Missed(self.chain, lost=self._lost, repair=self._repair)
        self._missed = missed
        result = missed.step(moment, seen)
        self._lost = False  # if so, `missed` knows
        if seen.fatal or len(missed.beliefs) == 1:
            self._forget()
            self._lost = seen.fatal or missed.lost
            self.chain.believe(missed.beliefs[0])
        return result

    def _see(self, verdicts: tuple[Any, ...]) -> Seen:
        given = dict(zip(self._names, verdicts))
        unknown = tuple(name for name in self._names if given[name] is None)
        consistent = self._consistent(given)
        # sets of states that make up what is consistent for each value of the unknown
        parts: Iterable[AbstractSet[int]] = [set(), *({state} for state in consistent)]
        if len(unknown) <= _ALL_VALUES:
            values = product((False, True), repeat=len(unknown))
            parts = {self._consistent({**given, **dict(zip(unknown, value))}) for value in values}
        few = self.chain.states <= _LARGEST
        seen = Seen(self.chain, consistent)
        seen.unknown = unknown
        possible = independent(parts)
        seen.completions = tuple(Seen(self.chain, group) for group in possible if few or not group)
        if len(self._seen) >= KEPT:
            self._seen.clear()
        self._seen[verdicts] = seen
        return seen

    def _consistent(self, given: dict[str, Any]) -> frozenset[int]:
        excluded = {state for state, name, negated in self._observe if given[name] is negated}
        return frozenset(range(self.chain.states)) - excluded

    def doubt(self) -> str:
        if not self._vague:
            return ""
        ages = {n: self._missing[n] * 3600.0 for n in self._names if n in self._missing}
        names = [f"{name} was missing {age:g} s" for name, age in ages.items()]
        open_ = "that it has not failed since" if self._may_have_failed else "what it was then"
        return f"{', '.join(names)} after the start, and no input shows {open_}"

    def reset(self) -> None:
        super().reset()
        self._forget()
        self.chain.reset()
