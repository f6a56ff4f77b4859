"""Bins and maps that remember: the bin before (``hysteresis``), or the last state (``hold``)."""

from __future__ import annotations

from typing import Callable, Sequence

from ..inputs import InputSpec
from .readers import ABSENT, Declaration, Discretiser


class Hysteresis:
    """Which bin is kept from one value to the next.

    A value keeps the bin while it is at most ``band`` beyond its near edge. After a gap, as before
    the first value, one near an edge may belong to either side.
    """

    def __init__(self, edges: Sequence[float], band: float) -> None:
        self._edges, self._band = edges, band
        self._all = tuple(range(len(edges) + 1))
        self.lose()

    def lose(self) -> None:
        """Take note of a gap: the next value is in its bare bin or was kept in another one."""
        self._previous: int | None = None
        self._before: Sequence[int] = self._all
        self.possible: tuple[int, ...] = ()

    def leave(self) -> None:
        """Take note of a value in no bin: the next one is in its bare bin for sure."""
        self._previous, self._before, self.possible = None, (), ()

    def take(self, value: float, bare: int) -> int:
        place, previous = bare, self._previous
        if previous is not None and previous != bare:
            place = self._kept(value, previous, bare)
        if self._before:
            places = {self._kept(value, before, bare) for before in self._before}
            self.possible = self._before = tuple(sorted(places)) if len(places) > 1 else ()
        self._previous = place
        return place

    def _kept(self, value: float, previous: int, bare: int) -> int:
        if previous == bare:
            return bare
        edges = self._edges
        beyond = value - edges[previous] if bare > previous else edges[previous - 1] - value
        return previous if beyond <= self._band else bare


class Remembering(Discretiser):
    """A discretisation with ``hysteresis``, behind the search of the bin, or ``missing: hold``."""

    def __init__(self, declaration: Declaration, spec: InputSpec) -> None:
        super().__init__(declaration, spec)
        self._bands = None
        if declaration.edges and declaration.hysteresis:
            self._bands = Hysteresis(declaration.edges, declaration.hysteresis)
        self.doubtful = self._bands is not None
        self.timed = declaration.policy == "hold"
        limit = spec.max_age if isinstance(spec.max_age, float) else 0.0
        self._hold_ns = int(min(limit, 1e9) * 1e9)
        self.reset()

    def absent(self, now: float) -> int:
        self._lose()
        if not self.timed:
            return self._default
        state, then, possible = self._last
        if not 0 <= now - then <= self._hold_ns:
            return self._declared.missing
        self.possible = possible
        return state

    def reset(self) -> None:
        self._lose()
        self._last: tuple[int, float, Sequence[int]] = (self._declared.missing, 0, ())

    def _lose(self) -> None:
        self.possible = ()
        if self._bands is not None:
            self._bands.lose()

    def _quick(self) -> Callable[[object, float], int]:
        return self._read

    def _read(self, raw: object, now: float) -> int:
        state, number = self._judged(raw)
        if number is not None:
            place, self.possible = self._search(self._edges, number), ()
            if self._bands is not None:
                place = self._bands.take(number, place)
                self.possible = [self._order[index] for index in self._bands.possible]
            state = self._order[place]
        elif state == ABSENT:
            return self.absent(now)
        elif state == self._declared.missing or self._bands is None:
            self._lose()
        else:
            self._bands.leave()
            self.possible = ()
        self._last = state, now, self.possible
        return state
