"""From a source to what is shown: a line for each change, or a page that is kept new."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator, Sequence
from dataclasses import asdict

from eddi_scaffold.watch.fleet import Change, FleetState, Snapshot
from eddi_scaffold.watch.messages import Source

Clock = Callable[[float], str]  # seconds of a source -> as a person reads them
WAIT_S = 0.1  # after which silence is looked for
_FIRST_NOTES_S = 1.5
_NOTES = 1000
_SHOW_S = 0.5  # between two views of a page, at least
_ORIGIN_S = time.time() - time.monotonic()
"""Of the monotonic clock, the same for all times, so that no text changes by itself."""


def changes(source: Source, state: FleetState, note: Callable[[str], None]) -> Iterator[Change]:
    """Yield the changes of verdicts until the source ends; note what hinders, each thing once."""
    noted: set[str] = set()

    def note_new() -> None:
        for text in (*source.notes(), *state.notes):
            if text not in noted and len(noted) < _NOTES:
                noted.add(text)
                note(text)

    due = time.monotonic() + _FIRST_NOTES_S
    for _, new in _steps(source, state):
        yield from new
        if time.monotonic() >= due:
            due = time.monotonic() + _SHOW_S
            note_new()
    note_new()


def follow(
    source: Source, state: FleetState, show: Callable[[Snapshot, Sequence[str]], None]
) -> None:
    """Show a snapshot, and notes on the source, again and again until it ends."""
    now, due = 0.0, 0.0
    for now, _ in _steps(source, state):
        if time.monotonic() >= due:
            due = time.monotonic() + _SHOW_S
            show(state.snapshot(now), source.notes())
    show(state.snapshot(now), ("The recording has ended.",))


def _steps(source: Source, state: FleetState) -> Iterator[tuple[float, list[Change]]]:
    while (received := source.receive(WAIT_S)) is not None:
        now, messages = received
        new = state.look(now - 1e-9 if messages else now)
        for message in messages:
            new += state.take(message)
        yield now, new


def line(change: Change, clock: Clock) -> str:
    """Return a change as a line: when, which robot, monitor and verdict, its state, why."""
    why = f"   {', '.join(change.reasons)}" if change.reasons else ""
    what = f"{change.robot}  {change.monitor}  {change.id}  {change.state}"
    return f"{clock(change.t)}  {what}{why}"


def document(change: Change, clock: Clock) -> dict[str, object]:
    """Return a change for programs."""
    return {**asdict(change), "reasons": list(change.reasons), "time": clock(change.t).strip()}


def time_of_day(t: float) -> str:
    """Return a time of the monotonic clock as the time of day here."""
    at = t + _ORIGIN_S
    return f"{time.strftime('%H:%M:%S', time.localtime(at))}.{int(at * 1000) % 1000:03d}"


def seconds(t: float) -> str:
    """Return the time in a recording."""
    return f"{t:10.3f}"
