"""End of a process: once, soon, and with a status that gives the reason.

A transport that talks to others while it ends may never come back from that; a guard limits it.
"""

from __future__ import annotations

import contextlib
import os
import sys
import threading
import time
from typing import Callable

from .logs import LOG
from .schedule import Waker

GRACE_S = 1.5
_FLUSH_S = 0.3


class Ending:
    """The end of the process."""

    def __init__(self) -> None:
        self.begun = False  # the node must publish nothing more
        self.status = 0  # exit status
        self._stops: list[Callable[[], None]] = []
        self._waker = Waker()

    def on_end(self, stop: Callable[[], None]) -> None:
        """Have something stopped first; it may run in a signal handler and must return at once."""
        self._stops.append(stop)
        if self.begun:  # already, or between the two lines
            stop()

    def install(self) -> None:
        """Guard the end: when it takes too long, the process ends without it."""
        threading.Thread(target=self._guard, name="end guard", daemon=True).start()

    def begin(self) -> None:
        """Begin to end; may run in a signal handler."""
        self.begun = True
        self._waker.wake()
        for stop in self._stops:
            stop()

    def wait(self) -> None:
        """Wait until all is logged; the guard limits the wait."""
        LOG.flush(_FLUSH_S)

    def _guard(self) -> None:
        while not self._waker.wait(threading.TIMEOUT_MAX):
            pass
        time.sleep(GRACE_S)
        with contextlib.suppress(Exception):
            sys.stdout.flush()
        os._exit(self.status)
