"""What a chain may be in after observations were missed, until it is known again.

Each completion of what was missed gives a belief of its own. The mixture of all of them, which is
the belief without that observation, is too optimistic where the worst one is true. So several
beliefs are followed, of which all that are possible are mixtures: a probability of failure given
later observations is a ratio of two linear functions of the belief, so the largest one is that of
one of these.
"""

from __future__ import annotations

from itertools import repeat
from operator import mul, sub, truediv
from typing import AbstractSet, Iterable

from .chain import INCONSISTENT, Belief, Chain, Seen
from .component import Estimate, Moment


class Missed:
    """The beliefs that a chain may have since an observation of it was missed."""

    def __init__(self, chain: Chain, *, lost: bool, repair: bool) -> None:
        self._chain, self._repair = chain, repair
        self.beliefs: list[Belief] = [chain.belief]  # all that are possible are mixtures of them
        self.lost = lost  # it may have been seen to fail, and not to work again

    def step(self, moment: Moment, seen: Seen) -> Estimate:
        """Let time pass, keep what is consistent with each completion, look ahead."""
        moved = self._chain.after(self.beliefs, moment.quanta)
        left = [self._left(moved, completion) for completion in seen.completions]
        reason = "" if any(left) else INCONSISTENT
        # what is believed after an observation that leaves nothing, too
        kept = [
            hull(some) if some else [self._chain.sure_of(one.worst)]
            for some, one in zip(left, seen.completions)
        ]
        self.beliefs = hull([belief for some in kept for belief in some])
        self.lost = any(
            completion.fatal or (self.lost and not completion.alive)
            for completion in seen.completions
        )
        if seen.unknown:
            return self._chain.bounded(seen, moment.at, reason)
        return self._chain.bounds(self.beliefs, moment.at, reason)

    def _left(self, moved: list[Belief], one: Seen) -> list[Belief]:
        """Return the beliefs that an observation leaves, each with a weight of one."""
        left: list[Belief] = []
        for belief in moved:
            kept = list(map(mul, belief, one.mask))
            weight = sum(kept)
            if weight > 0.0:
                left.append(list(map(truediv, kept, repeat(weight))))
        if self.lost and (self._repair or not one.alive):  # it was repaired, or is still down
            left.append(self._chain.sure_of(one.worst))
        return left


def hull(beliefs: list[Belief]) -> list[Belief]:
    """Return beliefs of which all of these are mixtures, not more than there are states in them.

    What all have in common is kept, and the rest of the weight may be in any one state.
    """
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
    found: list[Belief] = []
    for corner in corners:
        belief = common[:]
        belief[corner] = (least[corner] + rest) / whole
        found.append(belief)
    return found


def independent(possible: Iterable[AbstractSet[int]]) -> list[frozenset[int]]:
    """Return the sets of states that are not made of smaller ones without overlap.

    What such a union leaves of a belief is a mixture of what its parts leave.
    """
    found: list[frozenset[int]] = []
    for whole in sorted(map(frozenset, possible), key=lambda one: (len(one), sorted(one))):
        rest = whole
        for part in found:
            if part <= rest:
                rest -= part
        if rest or not whole:
            found.append(whole)
    return found
