"""Sliding windows over time: the samples of the last ``length`` nanoseconds, O(1) amortised.

A window at time t holds the samples in (t - length, t]. It is full when the time since the first
sample (after the start, a gap, or a clock that went back) is at least ``need`` = length - period.
An UNKNOWN sample is NaN; it makes the window UNKNOWN as long as it is inside.

The classes are copied into generated modules unchanged (``inspect.getsource``).
"""

from __future__ import annotations

import math
from collections import deque

from .hold import NEVER

NAN = math.nan
"""A number that is UNKNOWN."""


class Window:
    """What all windows share."""

    __slots__ = ("bad", "capacity", "length", "need", "overflows")

    def __init__(self, length: int, need: int, capacity: int) -> None:
        self.length = length  # nanoseconds
        self.need = need  # time since the first sample from which on it is full
        self.capacity = capacity  # samples that fit; a host may step at twice the rate
        # how often the oldest sample had to go too early. The window is UNKNOWN until the time of
        # the overflow has left it.
        self.overflows = 0
        self.reset()

    def reset(self) -> None:
        """Forget all samples."""
        self.bad = NEVER  # time of the last sample that makes it UNKNOWN
        self._clear()

    def push(self, t: int, age: int, x: float) -> float:
        """Take a sample of a later time and return the value of the window, NaN for UNKNOWN.

        ``age``: time since the first sample.
        """
        start = t - self.length
        self.expire(start)
        if x == x:  # noqa: PLR0124 - not NaN
            self.add(t, x)
        else:
            self.bad = t
        if age < self.need or self.bad > start:
            return NAN
        return self.value()

    def expire(self, start: int) -> None:
        """Drop the samples up to a time."""
        raise NotImplementedError

    def add(self, t: int, x: float) -> None:
        """Take a known sample."""
        raise NotImplementedError

    def value(self) -> float:
        """Return the value over the samples; there is one at least."""
        raise NotImplementedError

    def _clear(self) -> None:
        raise NotImplementedError

    def _overflow(self, t: int) -> None:
        self.overflows += 1
        self.bad = t


class Covered:
    """A window that may hold UNKNOWN samples, as long as enough of its samples are known."""

    __slots__ = ("_coverage", "_known", "_samples", "_window", "bad", "capacity", "overflows")

    def __init__(self, window: Window, coverage: float) -> None:
        self._window = window
        self._coverage = coverage
        self.capacity = window.capacity
        self.overflows = 0
        self._samples: deque[tuple[int, bool]] = deque()
        self.reset()

    def reset(self) -> None:
        """Forget all samples."""
        self.bad = NEVER
        self._known = 0
        self._samples.clear()
        self._window.reset()

    def push(self, t: int, age: int, x: float) -> float:
        """Take a sample and return the value over the known ones; see ``Window.push``."""
        window = self._window
        samples = self._samples
        start = t - window.length
        while samples and samples[0][0] <= start:
            self._known -= samples.popleft()[1]
        if len(samples) == self.capacity:
            self._known -= samples.popleft()[1]
            self.overflows += 1
            self.bad = t
        known = x == x  # noqa: PLR0124 - not NaN
        samples.append((t, known))
        window.expire(start)
        if known:
            self._known += 1
            window.add(t, x)
        if age < window.need or self.bad > start or window.bad > start:
            return NAN
        return window.value() if self._known / len(samples) >= self._coverage else NAN
