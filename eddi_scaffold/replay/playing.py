"""Recordings played to monitors: one timeline, on which each steps as its node would.

Of several monitors, each receives at once what those before it publish, and in its next step what
those behind it publish.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from eddi_scaffold.problems import EddiError, error
from eddi_scaffold.replay.node import Frame, Received, ReplayedNode
from eddi_scaffold.replay.publishing import Publications
from eddi_scaffold.replay.recordings import Tape
from eddi_scaffold.replay.steps import Rhythm, Steps

if TYPE_CHECKING:
    from eddi_runtime import Monitor as RuntimeMonitor

MAX_STEPS = 10_000_000
"""Eleven days at 10 Hz, some ten minutes of work: who asks for more has a slip in t."""


@dataclass(frozen=True)
class Part:
    """One monitor that is played.

    Attributes:
        name: for people; empty when it is the only one.
        running: the monitor; it begins anew.
        node: it has received nothing yet.
        rhythm: how it steps.
        sources: topic -> ids by which the node knows its messages.
        limits: id of a source -> the ages, in nanoseconds, that inputs allow it.
        publisher: what others receive of it.
    """

    name: str
    running: RuntimeMonitor[Any]
    node: ReplayedNode
    rhythm: Rhythm
    sources: Mapping[str, Sequence[str]]
    limits: Mapping[str, Collection[int]]
    publisher: Publications | None = None


Play = Iterator[tuple[Part, Frame]]
"""The steps of a recording, in the order of time."""


def play(parts: Sequence[Part], tape: Tape) -> Play:
    """Play a recording to monitors, in the order in which they step.

    Raises:
        EddiError: these are more steps than anybody waits for (I019).
    """
    most = max(_count(part.rhythm, tape) for part in parts)
    if most > MAX_STEPS:
        seconds = (tape.end - tape.start) / 1e9
        message = f"the recording is {seconds:,.0f} s long, which is {most:,.0f} steps"
        raise EddiError(error("I019", message, hint="see column t, or use --steps rows"))
    for part in parts:
        part.running.reset()
    return _Player(parts, tape).steps()


def _count(rhythm: Rhythm, tape: Tape) -> float:
    """Return about how many steps a rhythm makes."""
    return len(tape.rows) if rhythm.period is None else (tape.end - tape.start) / rhythm.period


class _Player:
    def __init__(self, parts: Sequence[Part], tape: Tape) -> None:
        self._parts = parts
        self._steps = [Steps(one.rhythm, one.limits, tape.start, tape.end) for one in parts]
        self._inboxes: list[list[Received]] = [[] for _ in parts]
        self._wanted = {topic for one in parts for topic in one.sources}
        self._samples = deque(tape.samples)
        self._rows = deque(tape.rows)

    def steps(self) -> Play:
        while (t := self._next()) is not None:
            if self._rows and self._rows[0] <= t:
                self._rows.popleft()
                for steps in self._steps:
                    steps.changed(t)
            while self._samples and self._samples[0].t <= t:
                one = self._samples.popleft()
                self._deliver(one.topic, one.message, one.t)
            for number, part in enumerate(self._parts):
                due = self._steps[number].due()
                if due is not None and due <= t:
                    yield part, self._step(number, t)

    def _next(self) -> int | None:
        """Return when something comes or somebody steps next."""
        times = [due for steps in self._steps if (due := steps.due()) is not None]
        if self._samples:
            times.append(self._samples[0].t)
        if self._rows:
            times.append(self._rows[0])
        return min(times, default=None)

    def _step(self, number: int, t: int) -> Frame:
        part = self._parts[number]
        frame = part.node.step(t, self._inboxes[number])
        self._inboxes[number] = []
        self._steps[number].stepped(t)
        if part.publisher is not None:
            for topic, message in part.publisher.messages(part.running, frame.output, self._wanted):
                self._deliver(topic, message, t, behind=number)
        return frame

    def _deliver(self, topic: str, message: Any, t: int, behind: int = -1) -> None:
        """Give a message to all who listen; only those behind the sender step for it at once."""
        for number, part in enumerate(self._parts):
            for source in part.sources.get(topic, ()):
                self._inboxes[number].append(Received(t, source, message))
                self._steps[number].received(t, source)
                if number > behind:
                    self._steps[number].changed(t)
