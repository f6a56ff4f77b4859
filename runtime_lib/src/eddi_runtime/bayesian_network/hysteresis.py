"""The bin of a value when the bin before counts, and the bins it may be in after a gap."""

from __future__ import annotations

from typing import Optional, Sequence, Tuple


class Hysteresis:
    """Which bin is kept from one value to the next.

    After a gap it is not known which bin was left, so a value near an edge may belong to either
    side, until a value is in one bin whatever was before. The time before the first value is a
    gap, too.

    Args:
        edges: of the bins, ascending.
        band: a value keeps the bin while it is at most so far beyond its near edge.

    Attributes:
        possible: bins of the last value if there are several; the one that was returned is among
            them. Empty when there is no doubt.
    """

    def __init__(self, edges: Sequence[float], band: float) -> None:
        self._edges, self._band = edges, band
        self._all = tuple(range(len(edges) + 1))
        self.lose()

    def lose(self) -> None:
        """Take note of a gap: the next value is in its bare bin or was kept in another one."""
        self._previous: Optional[int] = None
        self._before: Sequence[int] = self._all
        self.possible: Tuple[int, ...] = ()

    def leave(self) -> None:
        """Take note of a value in no bin: the next one is in its bare bin for sure."""
        self._previous, self._before, self.possible = None, (), ()

    def take(self, value: float, bare: int) -> int:
        """Return the bin of a value whose bare bin is known."""
        place, previous = bare, self._previous
        if previous is not None and previous != bare:
            place = self._kept(value, previous, bare)
        if self._before:
            places = {self._kept(value, one, bare) for one in self._before}
            self.possible = self._before = tuple(sorted(places)) if len(places) > 1 else ()
        self._previous = place
        return place

    def _kept(self, value: float, previous: int, bare: int) -> int:
        if previous == bare:
            return bare
        edges = self._edges
        beyond = value - edges[previous] if bare > previous else edges[previous - 1] - value
        return previous if beyond <= self._band else bare
