"""What a plot shows: one track per value, all over the same time.

A track of truth values is drawn as a band, one of texts as labelled stretches, one of numbers as a
line of steps: a value holds until the next one.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Literal

Value = bool | int | float | str | None
"""``None`` is unknown."""

Form = Literal["truth", "number", "text"]


@dataclass(frozen=True)
class Track:
    """One value over time.

    Attributes:
        name: for people.
        group: heading under which it is shown (``inputs``, ``outputs``).
        times: seconds, ascending.
        values: one per time.
    """

    name: str
    group: str
    times: tuple[float, ...]
    values: tuple[Value, ...]

    @property
    def form(self) -> Form:
        """How it is drawn: by the first value that is known."""
        first = next((value for value in self.values if value is not None), True)
        if isinstance(first, bool):
            return "truth"
        return "text" if isinstance(first, str) else "number"


def plain(value: object) -> Value:
    """Return a value as it can be drawn: NaN and what is not a single value are unknown."""
    if isinstance(value, float) and math.isnan(value):
        return None
    return value if isinstance(value, bool | int | float | str) else None


def tracks_of(group: str, samples: Iterable[tuple[float, Mapping[str, object]]]) -> Sequence[Track]:
    """Turn time-stamped values into one track per name, in the order of their first sample."""
    times: dict[str, list[float]] = {}
    values: dict[str, list[Value]] = {}
    for t, named in samples:
        for name, value in named.items():
            times.setdefault(name, []).append(t)
            values.setdefault(name, []).append(plain(value))
    return [Track(name, group, tuple(times[name]), tuple(values[name])) for name in times]


def shown_time(tracks: Iterable[Track]) -> tuple[float, float]:
    """Return from when to when tracks are shown: their last values can be seen as well."""
    times = [track.times for track in tracks if track.times]
    if not times:
        return 0.0, 1.0
    start, end = min(one[0] for one in times), max(one[-1] for one in times)
    if not end > start:
        return start, start + 1.0
    step = max((one[-1] - one[-2] for one in times if len(one) > 1), default=0.0)
    return start, end + max(step, (end - start) / 100)


def stretches(track: Track, end: float) -> list[tuple[float, float, Value]]:
    """Return (from, to, value) of each stretch of equal values; the last one ends at ``end``."""
    found: list[tuple[float, float, Value]] = []
    for k, (t, value) in enumerate(zip(track.times, track.values, strict=True)):
        until = track.times[k + 1] if k + 1 < len(track.times) else end
        if found and found[-1][2] == value and type(found[-1][2]) is type(value):
            found[-1] = (found[-1][0], until, value)
        else:
            found.append((t, until, value))
    return found


def ticks(low: float, high: float) -> list[float]:
    """Return round numbers between two bounds, both included where they are round."""
    if not high > low:
        return [low]
    rough = (high - low) / 8
    power = 10.0 ** math.floor(math.log10(rough))
    step = next(factor * power for factor in (1, 2, 5, 10) if factor * power >= rough)
    first = math.ceil(low / step - 1e-9)
    last = math.floor(high / step + 1e-9)
    return [round(k * step, 12) for k in range(first, last + 1)]
