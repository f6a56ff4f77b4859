"""The view as lines of text."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import asdict

from eddi_scaffold.watch.fleet import Change

Clock = Callable[[float], str]
"""Seconds of a source -> as a person reads them."""


def line(change: Change, clock: Clock) -> str:
    """Return a change as a line: when, which robot, monitor and verdict, its state, why."""
    who = f"{change.robot}  {change.monitor}  {change.id}"
    why = f"   {because(change.reasons)}" if change.reasons else ""
    return f"{clock(change.t)}  {who}  {change.state}{why}"


def because(reasons: tuple[str, ...]) -> str:
    """Return reasons in one line."""
    return ", ".join(reasons)


def document(change: Change, clock: Clock) -> dict[str, object]:
    """Return a change for programs."""
    return {**asdict(change), "reasons": list(change.reasons), "time": clock(change.t).strip()}


def time_of_day(origin: float) -> Clock:
    """Return what writes times of the monotonic clock as the time of day here.

    Args:
        origin: time since the epoch when the monotonic clock was 0.
    """

    def write(t: float) -> str:
        at = origin + t
        return f"{time.strftime('%H:%M:%S', time.localtime(at))}.{int(at * 1000) % 1000:03d}"

    return write


def seconds(t: float) -> str:
    """Return the time in a recording."""
    return f"{t:10.3f}"
