"""What a chain may be in after observations were missed, until it is known again.

Each completion of what was missed gives a belief of its own. The mixture of all of them, which is
the belief without that observation, is too optimistic where the worst one is true. So several
beliefs are followed, of which all that are possible are mixtures: a probability of failure given
later observations is a ratio of two linear functions of the belief, so the largest one is that of
one of these.
"""

from __future__ import annotations

from typing import AbstractSet, FrozenSet, Iterable, List

import numpy as np

from .chain import INCONSISTENT, Chain
from .estimate import Estimate, Moment
from .seen import Observation, Seen


class Missed:
    """The beliefs that a chain may have since an observation of it was missed.

    Args:
        chain: as it was before.
        lost: it was seen to have failed.
        repair: after a failure it may work again.

    Attributes:
        beliefs: one in each row; all that are possible are mixtures of them.
        lost: it may have been seen to fail, and not to work again.
    """

    def __init__(self, chain: Chain, *, lost: bool, repair: bool) -> None:
        self._chain, self._repair = chain, repair
        self.beliefs, self.lost = chain.belief[np.newaxis], lost

    def step(self, moment: Moment, seen: Seen) -> Estimate:
        """Let time pass, keep what is consistent with each completion, look ahead."""
        moved = self._chain.after(self.beliefs, moment.quanta)
        left = [self._left(moved, one) for one in seen.completions]
        reason = "" if any(len(rows) for rows in left) else INCONSISTENT
        self.beliefs = hull(np.concatenate(list(map(self._believe, left, seen.completions))))
        self.lost = any(one.fatal or (self.lost and not one.alive) for one in seen.completions)
        if seen.unknown:
            return Estimate(*seen.bounds[moment.at], seen.unknown, reason)
        return self._chain.bounds(self.beliefs, moment.at, reason)

    def _left(self, moved: np.ndarray, one: Observation) -> np.ndarray:
        """Return the beliefs that an observation leaves, each with a weight of one."""
        left: np.ndarray = moved * one.mask
        weights = left.sum(axis=1)
        possible = weights > 0.0
        left = left[possible] / weights[possible, np.newaxis]
        if self.lost and (self._repair or not one.alive):  # it was repaired, or is still down
            return np.vstack([left, self._chain.sure_of(one.worst)])
        return left

    def _believe(self, left: np.ndarray, one: Observation) -> np.ndarray:
        """Return what is believed after an observation, also when it leaves nothing."""
        return hull(left) if len(left) else self._chain.sure_of(one.worst)[np.newaxis]


def hull(beliefs: np.ndarray) -> np.ndarray:
    """Return beliefs of which all of these are mixtures, not more than there are states in them.

    What all have in common is kept, and the rest of the weight may be in any one state.
    """
    if len(beliefs) <= np.count_nonzero(beliefs.any(axis=0)):
        return beliefs
    least = beliefs.min(axis=0)
    rest = beliefs - least
    corners = np.flatnonzero(rest.any(axis=0))
    if not len(corners):
        return beliefs[:1]
    found = np.tile(least, (len(corners), 1))
    found[np.arange(len(corners)), corners] += rest.sum(axis=1).max()
    result: np.ndarray = found / found.sum(axis=1, keepdims=True)
    return result


def independent(possible: Iterable[AbstractSet[int]]) -> List[FrozenSet[int]]:
    """Return the sets of states that are not made of smaller ones without overlap.

    What such a union leaves of a belief is a mixture of what its parts leave.
    """
    found: List[FrozenSet[int]] = []
    for whole in sorted(map(frozenset, possible), key=lambda one: (len(one), sorted(one))):
        rest = whole
        for part in found:
            if part <= rest:
                rest -= part
        if rest or not whole:
            found.append(whole)
    return found
