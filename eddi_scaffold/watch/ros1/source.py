"""The messages of a ROS 1 graph."""

from __future__ import annotations

import contextlib
import os
import selectors
import time
from collections import deque
from collections.abc import Iterator, Sequence

from eddi_scaffold.watch.messages import GATHER_S, Message
from eddi_scaffold.watch.ros1.connection import Connection, close
from eddi_scaffold.watch.ros1.decoding import DecodingError
from eddi_scaffold.watch.ros1.graph import Search, woken


class Ros1Graph:
    """What the monitors on a graph publish, from now on; times are of the monotonic clock.

    Args:
        master: address of the master (``ROS_MASTER_URI``).
    """

    def __init__(self, master: str) -> None:
        self._selector = selectors.DefaultSelector()
        self._wake, self._waker = woken()
        self._selector.register(self._wake, selectors.EVENT_READ)
        self._new: deque[Connection] = deque()
        self._bad: dict[str, None] = {}
        self._search = Search(master, f"/eddi_watch_{os.getpid()}", self._add)
        self._search.start()

    def _add(self, one: Connection) -> None:
        self._new.append(one)
        with contextlib.suppress(OSError):
            self._waker.send(b".")

    def receive(self, seconds: float) -> tuple[float, Sequence[Message]]:
        """Wait for messages, and return what came."""
        if self._selector.select(seconds):
            time.sleep(GATHER_S)
        ready = self._selector.select(0)
        now = time.monotonic()
        found: list[Message] = []
        for key, _ in ready:
            if key.data is None:
                self._take_new()
            else:
                found += self._read(key.data, now)
        return now, found

    def _take_new(self) -> None:
        with contextlib.suppress(OSError):
            self._wake.recv(4096)
        while self._new:
            one = self._new.popleft()
            self._selector.register(one.socket, selectors.EVENT_READ, one)

    def _read(self, one: Connection, now: float) -> Iterator[Message]:
        try:
            for content, kept in one.read():
                yield Message(one.topic, one.type, content, now, one.node, kept)
        except BlockingIOError:
            pass
        except (OSError, DecodingError) as problem:
            if isinstance(problem, DecodingError) and len(self._bad) < 20:
                self._bad[f"{one.topic} of {one.node}: {problem}"] = None
            self._selector.unregister(one.socket)
            close(one.socket)
            self._search.lost((one.topic, one.node))

    def notes(self) -> Sequence[str]:
        """Return who cannot be listened to, and why."""
        return [*self._search.notes(), *self._bad]

    def close(self) -> None:
        """End all connections."""
        self._search.close()
        for key in list(self._selector.get_map().values()):
            close(key.fileobj)  # type: ignore[arg-type]  # only sockets are registered
        close(self._waker)
        self._selector.close()
