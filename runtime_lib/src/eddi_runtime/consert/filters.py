"""Filters of leaf values over time: debouncing (ours) and majority (that of SESAME's first tool).

A filter is a state and ``apply``: the truth values of all leaves of this step -> the filtered ones.
``kind: none`` and ``regain_after: 1`` are no filter at all, and no code.
"""

from __future__ import annotations

from collections import deque
from typing import Any, Deque, Mapping, Optional, Protocol, Sequence, Tuple

from ..documents import ModelError, take
from .values import FALSE, TRUE, UNKNOWN

_MAX_SAMPLES = 100_000
"""Longest history; at 1 kHz that is 100 s."""


class LeafFilter(Protocol):
    """State of a filter over all leaves.

    Attributes:
        values: what ``apply`` returned last; UNKNOWN before the first step.
    """

    values: Tuple[int, ...]

    def apply(self, raw: Sequence[int]) -> Tuple[int, ...]:
        """Take one sample of each leaf and return the filtered values."""

    def reset(self) -> None:
        """Forget all samples."""

    def waiting(self, leaf: int) -> str:
        """Return why a leaf whose raw value is TRUE is not TRUE yet, for people."""


def make_filter(settings: Mapping[str, Any], leaves: int) -> Optional[LeafFilter]:
    """Return the filter that the settings ask for, ``None`` for none.

    Raises:
        ModelError: the filter is not known or its number is not a whole number above 0.
    """
    wanted = settings.get("filter")
    if wanted is None:
        return None
    kind = take(wanted, "kind", str, "the filter")
    if kind == "none":
        return None
    if kind == "debounce":
        needed = _samples(wanted, "regain_after")
        return Debounce(leaves, needed) if needed > 1 else None
    if kind == "majority":
        window = _samples(wanted, "window")
        return Majority(leaves, window) if window > 1 else None
    raise ModelError("", f"the filter {kind!r} is not known: none, debounce or majority")


def _samples(wanted: Any, key: str) -> int:
    number: int = take(wanted, key, int, "the filter") if key in wanted else 1
    if not 1 <= number <= _MAX_SAMPLES:
        raise ModelError("", f"{key!r} of the filter is not from 1 to {_MAX_SAMPLES}")
    return number


class Debounce:
    """Loss at once, gain late: TRUE after ``needed`` TRUE samples in a row.

    Before that the last value that was not TRUE holds (UNKNOWN at the start). The direction that
    matters for safety, the loss of evidence, is never delayed.
    """

    def __init__(self, leaves: int, needed: int) -> None:
        self.needed = needed
        self._leaves = leaves
        self.reset()

    def reset(self) -> None:
        """Forget all samples."""
        self._in_a_row = [0] * self._leaves
        self._held = [UNKNOWN] * self._leaves
        self.values: Tuple[int, ...] = (UNKNOWN,) * self._leaves

    def apply(self, raw: Sequence[int]) -> Tuple[int, ...]:
        """Take one sample of each leaf and return the filtered values."""
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
        """Return why a leaf whose raw value is TRUE is not TRUE yet, for people."""
        return f"debouncing, {self._in_a_row[leaf]} of {self.needed} good samples"


class Majority:
    """Strict majority of the last ``window`` samples, of those that are there.

    Both directions are late: a loss is seen after up to half the window.
    """

    def __init__(self, leaves: int, window: int) -> None:
        self.window = window
        self._leaves = leaves
        self.reset()

    def reset(self) -> None:
        """Forget all samples."""
        self._samples: Deque[Sequence[int]] = deque()
        self._true = [0] * self._leaves
        self._not_false = [0] * self._leaves
        self.values: Tuple[int, ...] = (UNKNOWN,) * self._leaves

    def apply(self, raw: Sequence[int]) -> Tuple[int, ...]:
        """Take one sample of each leaf and return the filtered values."""
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
        """Return why a leaf whose raw value is TRUE is not TRUE yet, for people."""
        return f"majority, {self._true[leaf]} of {len(self._samples)} samples good"
