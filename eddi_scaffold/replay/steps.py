"""When a node steps while a recording is played. Times are nanoseconds."""

from __future__ import annotations

import math
from collections.abc import Collection, Mapping
from dataclasses import dataclass


@dataclass(frozen=True)
class Rhythm:
    """How a node steps.

    Attributes:
        period: between two steps, ``None``: there are none but those at changes.
        on_change: it also steps when something comes, or becomes too old; the period counts from
            the last step then.
    """

    period: float | None
    on_change: bool


ROWS = Rhythm(None, on_change=True)
"""One step for each row, or message, and no other."""


def rhythm_of(frequency: float, mode: str) -> Rhythm:
    """Return the rhythm of a configuration."""
    return Rhythm(1e9 / frequency, mode == "on_change")


class Steps:
    """The steps of one node: from the start to the first one that has seen the end.

    Args:
        rhythm: how it steps.
        limits: source -> ages at which something that was made of it becomes too old.
        start: of the recording.
        end: of the recording; of a node that steps by period only, the step behind it is the last.
    """

    def __init__(
        self, rhythm: Rhythm, limits: Mapping[str, Collection[int]], start: int, end: int
    ) -> None:
        self._rhythm, self._limits, self._start, self._end = rhythm, limits, start, end
        self._next: float = math.inf if rhythm.period is None else start
        self._count = 0
        self._last: float = -math.inf
        self._expiries: dict[tuple[str, int], int] = {}

    def due(self) -> int | None:
        """Return when the next step is if nothing comes before, ``None`` when there is none."""
        if not self._rhythm.on_change:
            return int(self._next) if self._last < self._end else None
        due = min([self._next, *self._expiries.values()])
        return int(due) if due <= self._end else None

    def changed(self, t: int) -> None:
        """Note that something came which the node may step for."""
        if self._rhythm.on_change:
            self._next = min(self._next, t)

    def received(self, t: int, source: str) -> None:
        """Note a message: from when on it is too old."""
        if self._rhythm.on_change and self._rhythm.period is not None:
            for limit in self._limits.get(source, ()):
                self._expiries[source, limit] = t + limit + 1

    def stepped(self, t: int) -> None:
        """Note a step."""
        self._last = t
        self._count += 1
        self._expiries = {key: at for key, at in self._expiries.items() if at > t}
        period = self._rhythm.period
        if period is None:
            self._next = math.inf
        elif self._rhythm.on_change:
            self._next = t + max(1, round(period))
        else:  # the start is a whole number that a float may not hold
            self._next = self._start + round(self._count * period)
