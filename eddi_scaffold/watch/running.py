"""From a source to what is shown."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator

from eddi_scaffold.watch.fleet import Change, FleetState
from eddi_scaffold.watch.messages import Source
from eddi_scaffold.watch.page import view_of
from eddi_scaffold.watch.page_feed import Feed
from eddi_scaffold.watch.text import Clock

WAIT_S = 0.1
"""After which silence is looked for."""
_FIRST_NOTES_S = 1.5
_NOTES = 1000
_SHOW_S = 0.5
"""Between two views of a page, at least."""


def changes(source: Source, state: FleetState, note: Callable[[str], None]) -> Iterator[Change]:
    """Yield the changes of verdicts until the source ends.

    Args:
        source: of messages.
        state: takes them.
        note: takes each sentence on what hinders, once.
    """
    told: set[str] = set()
    due = time.monotonic() + _FIRST_NOTES_S
    for _, found in _steps(source, state):
        yield from found
        if time.monotonic() >= due:
            due = time.monotonic() + _SHOW_S
            _tell(source, state, note, told)
    _tell(source, state, note, told)


def _tell(source: Source, state: FleetState, note: Callable[[str], None], told: set[str]) -> None:
    quiet = () if state.has_monitors else ("no monitor has been heard of yet",)
    for text in (*source.notes(), *state.notes, *quiet):
        if text not in told and len(told) < _NOTES:
            told.add(text)
            note(text)


def show(source: Source, state: FleetState, feed: Feed, clock: Clock) -> None:
    """Keep a page new until the source ends."""
    now, due = 0.0, 0.0
    for now, _ in _steps(source, state):
        if time.monotonic() >= due:
            due = time.monotonic() + _SHOW_S
            snapshot = state.snapshot(now)
            feed.show(snapshot, view_of(snapshot, clock, tuple(source.notes())))
    snapshot = state.snapshot(now)
    feed.show(snapshot, view_of(snapshot, clock, ("The recording has ended.",)))


def _steps(source: Source, state: FleetState) -> Iterator[tuple[float, list[Change]]]:
    while (received := source.receive(WAIT_S)) is not None:
        now, messages = received
        found = state.look(now - 1e-9 if messages else now)
        for message in messages:
            found += state.take(message)
        yield now, found
