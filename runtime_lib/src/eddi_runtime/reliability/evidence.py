"""Evidence for ConSerts: thresholds of the probability of failure with hysteresis."""

from __future__ import annotations

from typing import NamedTuple, Optional


class Threshold(NamedTuple):
    """One threshold.

    Attributes:
        id: of the evidence.
        activate: active once p_fail is not above this during ``hold_ns``.
        release: inactive as soon as p_fail is above this.
        hold_ns: nanoseconds.
    """

    id: str
    activate: float
    release: float
    hold_ns: int


class Evidence:
    """The state of one threshold; at first it is inactive."""

    def __init__(self, threshold: Threshold) -> None:
        self.threshold, self.id = threshold, threshold.id
        self.active = False
        self._since: Optional[int] = None

    def step(self, now: int, p_fail: float, *, usable: bool) -> bool:
        """Return whether the evidence is active.

        Args:
            now: nanoseconds.
            p_fail: in the worst case; NaN never satisfies a comparison.
            usable: the number may be trusted.
        """
        _, activate, release, hold_ns = self.threshold
        if not usable or not p_fail <= release:
            self.active, self._since = False, None
        elif not p_fail <= activate:
            self._since = None
        elif self._since is None:
            self._since = now
            self.active = self.active or hold_ns <= 0
        elif not self.active:
            self.active = now - self._since >= hold_ns
        return self.active

    def reset(self) -> None:
        """Return to inactive."""
        self.active, self._since = False, None
