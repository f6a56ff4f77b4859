"""The newest view, for all who look at it: written by one thread, read by those of connections."""

from __future__ import annotations

import threading
import time
from dataclasses import dataclass

from eddi_scaffold.watch.fleet import Snapshot
from eddi_scaffold.watch.page.view import View


@dataclass(frozen=True)
class Shown:
    """A snapshot and its view.

    Attributes:
        number: of views so far.
        at: when it was made, on the monotonic clock.
    """

    number: int
    at: float
    snapshot: Snapshot
    view: View


class Feed:
    """Holds what is shown.

    Attributes:
        closed: there will be no more.

    Args:
        snapshot: the first one.
        view: of it.
    """

    def __init__(self, snapshot: Snapshot, view: View) -> None:
        self._news = threading.Condition()
        self._shown = Shown(0, time.monotonic(), snapshot, view)
        self.closed = False

    @property
    def shown(self) -> Shown:
        """The newest."""
        return self._shown

    def show(self, snapshot: Snapshot, view: View) -> None:
        """Replace what is shown, and wake who waits for it."""
        with self._news:
            self._shown = Shown(self._shown.number + 1, time.monotonic(), snapshot, view)
            self._news.notify_all()

    def after(self, number: int, seconds: float) -> Shown:
        """Return the newest, and wait for it as long as it is not newer than a number."""
        with self._news:
            self._news.wait_for(lambda: self.closed or self._shown.number > number, seconds)
            return self._shown

    def close(self) -> None:
        """Let everybody who waits go."""
        with self._news:
            self.closed = True
            self._news.notify_all()
