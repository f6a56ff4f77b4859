"""The log of this process, written by a thread of its own so that no line can stop a monitor.

A transport may ask others before it writes a line, or write to a pipe that somebody has to read;
when they hang, the loop of the monitor would otherwise end at its next line.
"""

from __future__ import annotations

import collections
import contextlib
import threading
import time
from functools import partial
from typing import Callable, Mapping, Tuple

from .schedule import Waker

_KEPT = 500
_Line = Tuple[str, str, Tuple[object, ...]]
LEVELS = ("info", "warn", "error")
"""For the record; something needs attention; something is broken."""
Writers = Mapping[str, Callable[..., None]]
"""Level -> writes a text with its values, as ``logging`` does."""


class Log:
    """Keeps lines until the thread has written them; the oldest are dropped when it hangs."""

    def __init__(self) -> None:
        self.named = False  # lines begin with the name of their thread: it is that of a monitor
        # Appending to a deque takes no lock, so a signal handler may log as well.
        self._lines: collections.deque[_Line] = collections.deque(maxlen=_KEPT)
        self._waker = Waker()
        self._busy = False
        self._dropped = 0
        self.info, self.warn, self.error = (partial(self._put, level) for level in LEVELS)

    def start(self, write: Writers) -> None:
        """Begin to write; what was said before is written now."""
        threading.Thread(target=self._run, args=[write], name="log", daemon=True).start()

    def flush(self, seconds: float) -> None:
        """Wait until everything is written, but not longer than this."""
        end = time.monotonic() + seconds
        while (self._lines or self._busy) and time.monotonic() < end:
            time.sleep(0.005)

    def _put(self, level: str, text: str, *values: object) -> None:
        if self.named:
            text = f"{threading.current_thread().name}: {text}"
        self._dropped += len(self._lines) == _KEPT
        self._lines.append((level, text, values))
        self._waker.wake()

    def _run(self, write: Writers) -> None:
        while True:
            self._waker.wait(threading.TIMEOUT_MAX)
            self._busy = True
            while self._lines:
                level, text, values = self._lines.popleft()
                with contextlib.suppress(Exception):  # a broken pipe ends this line, not the log
                    write[level](text, *values)
            if self._dropped:
                dropped, self._dropped = self._dropped, 0
                write["warn"]("%d log lines were dropped", dropped)
            self._busy = False


LOG = Log()
"""One per process."""
