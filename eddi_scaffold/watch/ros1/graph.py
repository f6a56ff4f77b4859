"""Who publishes what: the master is asked again and again, in a thread of its own."""

from __future__ import annotations

import socket
import threading
import time
from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor
from typing import Any

from eddi_scaffold.watch.messages import MAX_MONITORS, is_watched
from eddi_scaffold.watch.ros1.calls import CallError, call
from eddi_scaffold.watch.ros1.connection import Connection, connect

_EVERY_S = 1.0
_AGAIN_S = 3.0
_AT_ONCE = 8

Key = tuple[str, str]
"""Topic and node."""


class Search:
    """Looks for publishers of what is watched, and connects to each.

    Args:
        master: address of the master.
        caller: our name.
        found: takes each new connection, in a thread.
    """

    def __init__(self, master: str, caller: str, found: Callable[[Connection], None]) -> None:
        self._master, self._caller, self._found = master, caller, found
        self._taken: set[Key] = set()
        self._failed: dict[Key, tuple[float, str]] = {}
        self._trouble = ""
        self._lock = threading.Lock()
        self._ended = threading.Event()
        self._pool = ThreadPoolExecutor(_AT_ONCE, thread_name_prefix="connecting")
        self._thread = threading.Thread(target=self._run, name="search", daemon=True)

    def start(self) -> None:
        """Begin."""
        self._thread.start()

    def close(self) -> None:
        """End."""
        self._ended.set()
        self._pool.shutdown(wait=False, cancel_futures=True)

    def lost(self, key: Key) -> None:
        """Look for a publisher again, whose connection has ended."""
        with self._lock:
            self._taken.discard(key)

    def notes(self) -> Sequence[str]:
        """Return what hinders, as sentences."""
        with self._lock:
            failed = [text for _, text in self._failed.values()]
        return [*([self._trouble] if self._trouble else ()), *failed[:20]]

    def _run(self) -> None:
        while not self._ended.is_set():
            try:
                self._look()
                self._trouble = ""
            except CallError as problem:
                self._trouble = f"the ROS master does not answer: {problem}"
            except Exception as problem:  # noqa: BLE001 - it answers what no master does
                self._trouble = f"the ROS master answers nonsense: {problem}"
            self._ended.wait(_EVERY_S)

    def _look(self) -> None:
        state: Any = call(self._master, self._caller, "getSystemState")
        types = dict(call(self._master, self._caller, "getTopicTypes"))
        there = [
            (str(topic), str(node))
            for topic, nodes in state[0]
            if is_watched(str(topic), str(types.get(topic)))
            for node in nodes
        ]
        now, known = time.monotonic(), set(there)
        with self._lock:
            self._failed = {key: one for key, one in self._failed.items() if key in known}
            new = [
                key
                for key in there
                if key not in self._taken and now - self._failed.get(key, (0.0, ""))[0] > _AGAIN_S
            ]
            new = new[: max(0, 3 * MAX_MONITORS - len(self._taken))]
            self._taken.update(new)
        for key in new:
            self._pool.submit(self._connect, key, str(types[key[0]]))

    def _connect(self, key: Key, type_: str) -> None:
        topic, node = key
        try:
            uri = str(call(self._master, self._caller, "lookupNode", node))
            made = connect(uri, node, topic, type_, self._caller)
        except OSError as problem:
            self._fail(key, f"{node} cannot be reached: {problem.strerror or problem}")
        except Exception as problem:  # noqa: BLE001 - whatever a node answers
            self._fail(key, f"{node}: {problem}")
        else:
            with self._lock:
                self._failed.pop(key, None)
            self._found(made)

    def _fail(self, key: Key, text: str) -> None:
        with self._lock:
            self._failed[key] = (time.monotonic(), text)
            self._taken.discard(key)


def woken() -> tuple[socket.socket, socket.socket]:
    """Return a pair of sockets: what is written to the second wakes who waits for the first."""
    first, second = socket.socketpair()
    first.setblocking(False)
    second.setblocking(False)
    return first, second
