"""A node of which others say when it monitors: what its states mean, on any transport.

Configured, it has its publishers. Active, it listens and steps, and knows nothing of before; the
last that it publishes is that nothing is known.
"""

from __future__ import annotations

import threading
from typing import Any, Callable

from .node import Node
from .start import LOG, Ending, Waker

_STEP_S = 5.0  # a step that takes longer is left behind when the node is deactivated


class LifeCycle:
    """Which monitor there is; ``run`` steps it in a thread of its own, beside the transitions."""

    def __init__(self, place: Any, make: Callable[[], Any]) -> None:
        self._place, self._make = place, make
        self._next: Any = None
        self._active: Node | None = None
        self._waker = Waker()
        self._idle = threading.Event()
        self._idle.set()
        self.ending = Ending()

    def run(self, begun: Callable[[], None]) -> int:
        """Follow the transitions until the process is to end; return the exit status."""
        with self._place.until(self.ending):
            self.ending.on_end(self._stop)
            begun()  # before the transport's thread begins
            self._place.start()
            while not self.ending.begun:
                self._waker.wait(threading.TIMEOUT_MAX)
                active: Any = self._active
                if active is None:
                    continue
                if self.ending.begun:  # before it could be told
                    active.ending.begin()
                active.run(lambda: None)
                active.withdraw()
                self._active = None
                self._idle.set()
        return self.ending.status

    def _stop(self) -> None:
        active = self._active
        if active is not None:
            active.ending.begin()
        self._waker.wake()

    def configure(self) -> None:
        """Have a monitor, and publishers that do not send yet; nothing if that fails."""
        try:
            self._next = self._make()
            self._next.prepare()
            self._next.init_publisher()
        except Exception:
            self.clean_up()
            raise

    def prepare(self) -> None:
        if not self._idle.is_set():
            raise RuntimeError("the last step has not ended yet")
        self._next = self._next or self._make()

    def activate(self) -> None:
        self._active, self._next = self._next, None
        self._idle.clear()
        self._waker.wake()

    def deactivate(self) -> None:
        """Have it end: its last word is that nothing is known, even if hand-written code hangs."""
        self._stop()
        if not self._idle.wait(_STEP_S):
            LOG.error("deactivate: a step has not ended within %g s, it is left behind", _STEP_S)
            active = self._active
            if active is not None:
                active.withdraw()
        self._place.stop_listening()

    def clean_up(self) -> None:
        self._next = None
        self._place.stop_publishing()
