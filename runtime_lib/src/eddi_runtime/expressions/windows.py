"""Windows that keep their samples in the order of time.

The classes are copied into generated modules unchanged (``inspect.getsource``).
"""

from __future__ import annotations

from bisect import bisect_left, insort
from collections import deque

from .window import NAN, Window


class Queue(Window):
    """Samples in the order of time."""

    __slots__ = ("_samples",)

    def _clear(self) -> None:
        self._samples: deque[tuple[int, float]] = deque()

    def expire(self, start: int) -> None:
        samples = self._samples
        while samples and samples[0][0] <= start:
            samples.popleft()

    def add(self, t: int, x: float) -> None:
        samples = self._samples
        if len(samples) == self.capacity:
            samples.popleft()
            self._overflow(t)
        samples.append((t, x))


class Maximum(Queue):
    """MAX: the samples that no later one reaches, so that the first is the greatest."""

    __slots__ = ()

    def add(self, t: int, x: float) -> None:
        samples = self._samples
        while samples and samples[-1][1] <= x:
            samples.pop()
        Queue.add(self, t, x)

    def value(self) -> float:
        return self._samples[0][1]


class Minimum(Queue):
    """MIN: the samples that no later one reaches, so that the first is the least."""

    __slots__ = ()

    def add(self, t: int, x: float) -> None:
        samples = self._samples
        while samples and samples[-1][1] >= x:
            samples.pop()
        Queue.add(self, t, x)

    def value(self) -> float:
        return self._samples[0][1]


class Rate(Queue):
    """RATE: (last - first) / (time between them), per second."""

    __slots__ = ()

    def value(self) -> float:
        first, last = self._samples[0], self._samples[-1]
        if first[0] == last[0]:
            return NAN
        value = (last[1] - first[1]) / ((last[0] - first[0]) / 1e9)
        return value if value - value == 0.0 else NAN


class Count(Queue):
    """COUNT: how many samples are true (2); a false one is 0."""

    __slots__ = ()

    def add(self, t: int, x: float) -> None:
        if x:
            Queue.add(self, t, x)

    def value(self) -> float:
        return float(len(self._samples))


class Median(Queue):
    """MEDIAN: the samples by time and by value."""

    __slots__ = ("_sorted",)

    def _clear(self) -> None:
        super()._clear()
        self._sorted: list[float] = []

    def expire(self, start: int) -> None:
        samples, ordered = self._samples, self._sorted
        while samples and samples[0][0] <= start:
            del ordered[bisect_left(ordered, samples.popleft()[1])]

    def add(self, t: int, x: float) -> None:
        if len(self._samples) == self.capacity:
            del self._sorted[bisect_left(self._sorted, self._samples[0][1])]
        Queue.add(self, t, x)
        insort(self._sorted, x)

    def value(self) -> float:
        ordered = self._sorted
        middle = len(ordered) // 2
        high = ordered[middle]
        low = high if len(ordered) % 2 else ordered[middle - 1]
        if low == high:
            return high
        value = 0.5 * low + 0.5 * high
        return value if value - value == 0.0 else NAN
