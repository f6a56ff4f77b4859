"""Sums and moments over sliding windows in two stacks, without a subtraction.

The old samples carry what was gathered from the newest of them on, the new ones what was gathered
since: the value is one of each, so that a spike that has left leaves no error behind. When the old
ones have run out, the new ones become old: O(1) amortised, as many steps as samples at the worst.

The classes are copied into generated modules unchanged (``inspect.getsource``).
"""

from __future__ import annotations

import math

from .hold import NEVER
from .window import NAN, Window


class Stacks(Window):
    """Two stacks: old samples with what was gathered from the newest of them, and new samples."""

    __slots__ = ("_back", "_front")

    def _clear(self) -> None:
        self._front: list[tuple[int, float, float]] = []
        self._back: list[tuple[int, float]] = []
        self._start_back()

    def expire(self, start: int) -> None:
        front = self._front
        while front and front[-1][0] <= start:
            front.pop()
        if not front and self._back and self._back[0][0] <= start:
            self._turn(start)

    def add(self, t: int, x: float) -> None:
        if len(self._front) + len(self._back) == self.capacity:
            if not self._front:
                self._turn(NEVER)
            self._front.pop()
            self._overflow(t)
        self._back.append((t, x))
        self._gather(x, len(self._back))

    def _turn(self, start: int) -> None:
        """Move the new samples to the old ones, gathering from the newest on."""
        front = self._front
        back, self._back = self._back, []
        self._start_back()
        for t, x in reversed(back):
            if t <= start:
                break
            self._gather(x, len(front) + 1)
            front.append((t, *self._gathered()))
        self._start_back()

    def _start_back(self) -> None:
        raise NotImplementedError

    def _gather(self, x: float, count: int) -> None:
        raise NotImplementedError

    def _gathered(self) -> tuple[float, float]:
        raise NotImplementedError


class Sum(Stacks):
    """SUM: compensated (Neumaier 1974), as a rounded sum and the sum of what was rounded off."""

    __slots__ = ("_high", "_low")

    def _start_back(self) -> None:
        self._high = self._low = 0.0

    def _gather(self, x: float, count: int) -> None:
        high = self._high
        total = high + x
        if abs(high) >= abs(x):
            self._low += (high - total) + x
        else:
            self._low += (x - total) + high
        self._high = total

    def _gathered(self) -> tuple[float, float]:
        return self._high, self._low

    def value(self) -> float:
        if not self._front:
            total = self._high + self._low
        else:
            _, high, low = self._front[-1]
            total = high + self._high
            if abs(high) >= abs(self._high):
                rest = (high - total) + self._high
            else:
                rest = (self._high - total) + high
            total += rest + (low + self._low)
        return total if total - total == 0.0 else NAN


class Average(Sum):
    """AVERAGE: the sum by the number of samples."""

    __slots__ = ()

    def value(self) -> float:
        return Sum.value(self) / (len(self._front) + len(self._back))


class Deviation(Stacks):
    """STDDEV: sample standard deviation (n - 1), from means and squares (Welford 1962)."""

    __slots__ = ("_mean", "_squares")

    def _start_back(self) -> None:
        self._mean = self._squares = 0.0

    def _gather(self, x: float, count: int) -> None:
        away = x - self._mean
        self._mean += away / count
        self._squares += away * (x - self._mean)

    def _gathered(self) -> tuple[float, float]:
        return self._mean, self._squares

    def value(self) -> float:
        old, new = len(self._front), len(self._back)
        if old + new < 2:
            return NAN
        squares = self._squares
        if old:
            _, mean, front = self._front[-1]
            squares = front + squares
            if new:  # Chan, Golub, LeVeque 1979
                away = self._mean - mean
                squares += away * away * (float(old) * float(new) / float(old + new))
        value = squares / float(old + new - 1)
        return math.sqrt(value) if value - value == 0.0 else NAN
