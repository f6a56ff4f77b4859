"""A bag as a source: what monitors published while it was recorded."""

from __future__ import annotations

import time
from collections.abc import Iterator, Sequence
from contextlib import ExitStack
from pathlib import Path
from typing import Any

from eddi_scaffold.common.problems import EddiError, Place, problem
from eddi_scaffold.recordings.bags import opened, topic_of, type_of
from eddi_scaffold.watch.messages import DIAGNOSTICS, Message, is_watched

_TICK_S = 0.25
"""Of the recording, after which time passes without a message, so that silence is seen."""


class Recording:
    """The messages of a bag; times are seconds since its first message, of any topic.

    It is played at a speed, or, without one, as fast as it can be read.

    Raises:
        EddiError: rosbags is not installed (I010), the bag cannot be read (I011), or no monitor's
            messages are in it (V002).
    """

    def __init__(self, path: Path, speed: float | None = None) -> None:
        self._speed = speed
        self._now, self._began = 0.0, time.monotonic()
        with ExitStack() as stack:
            self._messages = _messages(stack.enter_context(opened(path)), Place(str(path)))
            self._next = next(self._messages, None)
            self.close = stack.pop_all().close

    def receive(self, seconds: float) -> tuple[float, Sequence[Message]] | None:
        """Return the next message, or that time has passed without one."""
        if self._next is None:
            return None
        until = self._now + (_TICK_S if self._speed is None else seconds * self._speed)
        messages: list[Message] = []
        if self._next.t <= until:
            until = max(self._now, self._next.t)
            messages = [self._next]
            self._next = next(self._messages, None)
        if self._speed is not None:
            time.sleep(max(0.0, self._began + until / self._speed - time.monotonic()))
        self._now = until
        return until, messages

    def notes(self) -> Sequence[str]:
        """Return nothing: a recording is as it is."""
        return ()


def _messages(reader: Any, place: Place) -> Iterator[Message]:
    watched = [c for c in reader.connections if is_watched(topic_of(c), type_of(c))]
    if all(type_of(connection) == DIAGNOSTICS for connection in watched):
        raise EddiError(problem("V002", place))
    seen: set[int] = set()
    for connection, t, data in reader.messages(watched):
        is_kept = bool(getattr(connection.ext, "latching", 0)) and id(connection) not in seen
        seen.add(id(connection))
        yield Message(
            topic_of(connection),
            type_of(connection),
            reader.deserialize(connection, data),
            (t - reader.start_time) / 1e9,
            getattr(connection.ext, "callerid", None) or "",
            is_kept,
        )
