"""Filters of leaf values over time: debouncing (ours), majority (that of SESAME's first tool)."""

from __future__ import annotations

from collections import deque
from typing import Callable, Sequence, Tuple

from ..why import FALSE, TRUE, UNKNOWN


class LeafFilter:
    """State of a filter over all leaves."""

    accepts = ""  # the acceptance that it is, because a loss is late; empty for none
    values: tuple[int, ...]  # what ``apply`` returned last; UNKNOWN before the first step
    apply: Callable[[Sequence[int]], Tuple[int, ...]]  # takes a sample of each leaf, filters them
    waiting: Callable[[int], str]  # why a leaf whose raw value is TRUE is not TRUE yet, for people

    def reset(self, leaves: int) -> None:
        """Forget all samples; ``leaves`` are filtered from now on."""
        self.values = (UNKNOWN,) * leaves


class Debounce(LeafFilter):
    """Loss at once, gain late: TRUE after ``needed`` TRUE samples in a row."""

    def __init__(self, needed: int) -> None:
        self.needed = needed
        self.reset(0)

    def reset(self, leaves: int) -> None:
        super().reset(leaves)
        self._in_a_row = [0] * leaves
        self._held = [UNKNOWN] * leaves

    def apply(self, raw: Sequence[int]) -> tuple[int, ...]:
        in_a_row, held, needed = self._in_a_row, self._held, self.needed
        for k, value in enumerate(raw):
            if value != TRUE:
                in_a_row[k] = 0
                held[k] = value
            elif in_a_row[k] < needed:
                in_a_row[k] += 1
                if in_a_row[k] == needed:
                    held[k] = TRUE
        self.values = tuple(held)
        return self.values

    def waiting(self, leaf: int) -> str:
        return f"debouncing, {self._in_a_row[leaf]} of {self.needed} good samples"


class Majority(LeafFilter):
    """Strict majority of the last ``window`` samples; a loss may be half the window late."""

    accepts = "filter: majority"

    def __init__(self, window: int) -> None:
        self.window = window
        self.reset(0)

    def reset(self, leaves: int) -> None:
        super().reset(leaves)
        self._samples: deque[Sequence[int]] = deque()
        self._true = [0] * leaves
        self._not_false = [0] * leaves

    def apply(self, raw: Sequence[int]) -> tuple[int, ...]:
        self._count(raw, 1)
        self._samples.append(raw)
        if len(self._samples) > self.window:
            self._count(self._samples.popleft(), -1)
        half = len(self._samples) / 2
        self.values = tuple(
            [
                TRUE if true > half else UNKNOWN if not_false > half else FALSE
                for true, not_false in zip(self._true, self._not_false)
            ]
        )
        return self.values

    def _count(self, raw: Sequence[int], sign: int) -> None:
        true, not_false = self._true, self._not_false
        for k, value in enumerate(raw):
            if value != FALSE:
                not_false[k] += sign
                if value == TRUE:
                    true[k] += sign

    def waiting(self, leaf: int) -> str:
        return f"majority, {self._true[leaf]} of {len(self._samples)} samples good"
