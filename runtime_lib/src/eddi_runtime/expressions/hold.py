"""AND and OR of a truth value over a sliding window, of which two times are remembered.

The class is copied into generated modules unchanged (``inspect.getsource``).
"""

from __future__ import annotations

NEVER = -(1 << 64)
"""Before any time that fits into 64 bits."""


class Hold:
    """TIME and ONCE: AND and OR over a window, by the last times of two of the three values."""

    __slots__ = ("_dominant", "_last", "_unknown", "length", "need")

    capacity = 0
    overflows = 0

    def __init__(self, length: int, need: int, dominant: int) -> None:
        self.length = length
        self.need = need
        self._dominant = dominant
        self.reset()

    def reset(self) -> None:
        """Forget all samples."""
        self._last = self._unknown = NEVER

    def push(self, t: int, age: int, x: int) -> int:
        """Take a truth value (0, 1, 2) and return that of the window."""
        start = t - self.length
        dominant = self._dominant
        if x == dominant:
            self._last = t
        elif x == 1:
            self._unknown = t
        if self._last > start:
            return dominant
        if age < self.need or self._unknown > start:
            return 1
        return 2 - dominant
