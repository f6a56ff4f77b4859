"""Evidence for ConSerts: thresholds of a probability with hysteresis and a time to hold."""

from __future__ import annotations

import math
from typing import NamedTuple


class Threshold(NamedTuple):
    """One upper threshold; a lower one is that of the negative value."""

    id: str  # of the evidence
    activate: float  # active once the value is not above this during ``hold_ns``
    release: float  # inactive as soon as the value is above this
    hold_ns: int  # nanoseconds


class Evidence:
    """The state of one threshold: is it active, and might it be, for all that is known?"""

    def __init__(self, threshold: Threshold) -> None:
        self.threshold, self.id = threshold, threshold.id
        self.active, self.possible = False, True
        self.since: float | None = None  # from when on it has been good, None while it is not
        self.lost: float | None = None  # when it became known not to hold
        self.reset()

    def step(self, now: float, value: float, *, usable: bool, best: float = -math.inf) -> bool:
        """Return whether the evidence is active; ``best``: the value in the best case.

        After a jump back of ``now`` (nanoseconds) the time to hold begins anew; NaN is no time.
        """
        _, activate, release, hold_ns = self.threshold
        if best > release:
            self.lost = now if self.possible else self.lost
            self.possible = False
        elif not best > activate:
            self.possible = True
        if not usable or not value <= release:
            self.active, self.since = False, None
        elif not value <= activate:
            self.since = None
        elif self.since is None or now < self.since:
            self.since = now
            self.active = self.active or hold_ns <= 0
        elif not self.active:
            self.active = now - self.since >= hold_ns
        return self.active

    def reset(self) -> None:
        """Return to inactive; what was before is not known."""
        self.active, self.possible, self.since, self.lost = False, True, None, None
