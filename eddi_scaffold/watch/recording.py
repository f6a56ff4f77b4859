"""A bag as a source: what monitors published while it was recorded."""

from __future__ import annotations

import time
from collections.abc import Iterator, Sequence
from contextlib import ExitStack
from pathlib import Path
from typing import Any

from eddi_scaffold.common.identifiers import full_topic
from eddi_scaffold.common.problems import EddiError, Place, problem
from eddi_scaffold.recordings.bags import opened
from eddi_scaffold.watch.messages import Message, is_watched

_TICK = 0.25
"""Seconds of the recording after which time passes without a message, so that silence is seen."""


class Recording:
    """The messages of a bag; times are seconds since its first message, of any topic.

    Args:
        path: as of ``read_bag``.
        speed: seconds of the recording for each second; ``None``: as fast as it can be read.

    Raises:
        EddiError: rosbags is not installed (I010), the bag cannot be read (I011), or no monitor's
            messages are in it (V002).
    """

    def __init__(self, path: Path, speed: float | None = None) -> None:
        self._speed = speed
        self._place = Place(str(path))
        self._stack = ExitStack()
        try:
            reader = self._stack.enter_context(opened(path))
            self._messages = self._read(reader)
        except BaseException:
            self._stack.close()
            raise
        self._next = next(self._messages, None)
        self._now = 0.0
        self._began = time.monotonic()

    def _read(self, reader: Any) -> Iterator[Message]:
        names = {one.id: full_topic(one.topic, namespace="", package="") for one in _all(reader)}
        types = {one.id: one.msgtype.replace("/msg/", "/") for one in _all(reader)}
        found = [one for one in _all(reader) if is_watched(names[one.id], types[one.id])]
        if not any(not names[one.id].startswith("/diagnostics") for one in found):
            raise EddiError(problem("V002", self._place))
        return self._each(reader, found, names, types)

    def _each(self, reader: Any, found: Any, names: Any, types: Any) -> Iterator[Message]:
        seen: set[int] = set()
        for connection, t, data in reader.messages(found):
            node = getattr(connection.ext, "callerid", None) or ""
            kept = bool(getattr(connection.ext, "latching", 0)) and connection.id not in seen
            seen.add(connection.id)
            yield Message(
                names[connection.id],
                types[connection.id],
                reader.deserialize(connection, data),
                (t - reader.start_time) / 1e9,
                node,
                kept,
            )

    def receive(self, seconds: float) -> tuple[float, Sequence[Message]] | None:
        """Return the next message, or that time has passed without one."""
        if self._next is None:
            return None
        step = _TICK if self._speed is None else seconds * self._speed
        until = self._now + step
        found: list[Message] = []
        if self._next.t <= until:
            until = max(self._now, self._next.t)
            found = [self._next]
            self._next = next(self._messages, None)
        if self._speed is not None:
            wait = self._began + until / self._speed - time.monotonic()
            time.sleep(max(0.0, wait))
        self._now = until
        return until, found

    def notes(self) -> Sequence[str]:
        """Return nothing: a recording is as it is."""
        return ()

    def close(self) -> None:
        """Close the bag."""
        self._stack.close()


def _all(reader: Any) -> Sequence[Any]:
    found: Sequence[Any] = reader.connections
    return found
