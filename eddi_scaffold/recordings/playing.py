"""Recordings played to monitors: one timeline, on which each steps as its node would."""

from __future__ import annotations

import math
from collections import deque
from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from eddi_scaffold.common.problems import EddiError, problem
from eddi_scaffold.recordings.csv_recording import Tape
from eddi_scaffold.recordings.messages import Publications
from eddi_scaffold.recordings.node import Received, ReplayedNode, Step

if TYPE_CHECKING:
    from eddi_runtime import Monitor as RuntimeMonitor


@dataclass(frozen=True)
class StepRule:
    """How a node steps.

    Attributes:
        period: between two steps, ``None``: there are none but those at changes.
        on_change: it also steps when something comes, or becomes too old; the period counts from
            the last step then.
    """

    period: float | None
    on_change: bool


ROWS = StepRule(None, on_change=True)
"""One step for each row, or message, and no other."""


def rhythm_of(frequency: float, mode: str) -> StepRule:
    """Return the rhythm of a configuration."""
    return StepRule(1e9 / frequency, mode == "on_change")


class Steps:
    """The steps of one node: from the start to the first one that has seen the end.

    Args:
        rhythm: how it steps.
        limits: source -> ages at which something that was made of it becomes too old.
        start: of the recording.
        end: of the recording; of a node that steps by period only, the step behind it is the last.
    """

    def __init__(
        self, rhythm: StepRule, limits: Mapping[str, Collection[int]], start: int, end: int
    ) -> None:
        self._rhythm, self._limits, self._start, self._end = rhythm, limits, start, end
        self._next: float = math.inf if rhythm.period is None else start
        self._count = 0
        self._last: float = -math.inf
        self._expiries: dict[tuple[str, int], int] = {}

    def due(self) -> int | None:
        """Return when the next step is if nothing comes before, ``None`` when there is none."""
        if not self._rhythm.on_change:
            return int(self._next) if self._last < self._end else None
        due = min([self._next, *self._expiries.values()])
        return int(due) if due <= self._end else None

    def changed(self, t: int) -> None:
        """Note that something came which the node may step for."""
        if self._rhythm.on_change:
            self._next = min(self._next, t)

    def received(self, t: int, source: str) -> None:
        """Note a message: from when on it is too old."""
        if self._rhythm.on_change and self._rhythm.period is not None:
            for limit in self._limits.get(source, ()):
                self._expiries[source, limit] = t + limit + 1

    def stepped(self, t: int) -> None:
        """Note a step."""
        self._last = t
        self._count += 1
        self._expiries = {key: at for key, at in self._expiries.items() if at > t}
        period = self._rhythm.period
        if period is None:
            self._next = math.inf
        elif self._rhythm.on_change:
            self._next = t + max(1, round(period))
        else:  # the start is a whole number that a float may not hold
            self._next = self._start + round(self._count * period)


MAX_STEPS = 10_000_000
"""Eleven days at 10 Hz, some ten minutes of work: who asks for more has a slip in t."""


@dataclass(frozen=True)
class PlayedMonitor:
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
    rhythm: StepRule
    sources: Mapping[str, Sequence[str]]
    limits: Mapping[str, Collection[int]]
    publisher: Publications | None = None


Playback = Iterator[tuple[PlayedMonitor, Step]]
"""The steps of a recording, in the order of time."""


def play(parts: Sequence[PlayedMonitor], tape: Tape) -> Playback:
    """Play a recording to monitors, in the order in which they step.

    Raises:
        EddiError: these are more steps than anybody waits for (I019).
    """
    most = max(_count(part.rhythm, tape) for part in parts)
    if most > MAX_STEPS:
        seconds = (tape.end - tape.start) / 1e9
        raise EddiError(problem("I019", length=seconds, most=most))
    for part in parts:
        part.running.reset()
    return _Player(parts, tape).steps()


def _count(rhythm: StepRule, tape: Tape) -> float:
    """Return about how many steps a rhythm makes."""
    return len(tape.rows) if rhythm.period is None else (tape.end - tape.start) / rhythm.period


class _Player:
    def __init__(self, parts: Sequence[PlayedMonitor], tape: Tape) -> None:
        self._parts = parts
        self._steps = [Steps(part.rhythm, part.limits, tape.start, tape.end) for part in parts]
        self._inboxes: list[list[Received]] = [[] for _ in parts]
        self._wanted = {topic for part in parts for topic in part.sources}
        self._samples = deque(tape.samples)
        self._rows = deque(tape.rows)

    def steps(self) -> Playback:
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

    def _step(self, number: int, t: int) -> Step:
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
