"""Recordings played to monitors: one timeline, on which each steps as its node would."""

from __future__ import annotations

import math
import re
from collections import deque
from collections.abc import Callable, Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from types import MappingProxyType
from typing import Any

from eddi_runtime import Monitor as RuntimeMonitor
from eddi_runtime.history import EDDIInputBase
from eddi_runtime.peers import Fleet

from eddi_scaffold.common.graphs import in_order
from eddi_scaffold.common.problems import EddiError, Place, Problem, problem
from eddi_scaffold.monitors.binding import BoundMonitor
from eddi_scaffold.monitors.input_binding import InputBinding
from eddi_scaffold.recordings.csv_recording import Recording
from eddi_scaffold.recordings.members import Member
from eddi_scaffold.recordings.node import (
    SECOND,
    WORDS,
    GivenInput,
    Process,
    Publications,
    Received,
    ReplayedNode,
    Step,
    generated_lines,
    processing_of,
)

MAX_STEPS = 10_000_000
"""Eleven days at 10 Hz, some ten minutes of work: who asks for more has a slip in t."""
_CALL = re.compile(r'(?m)^  File "(.+)", line ([0-9]+), in ')  # a line of a traceback


@dataclass(frozen=True)
class StepRule:
    """How a node steps."""

    # nanoseconds between two steps, `None`: there are none but those at changes
    period: float | None
    # it also steps when something comes, or becomes too old; the period counts from the last step
    # then
    on_change: bool


ROWS = StepRule(None, on_change=True)  # one step for each row, or message, and no other


@dataclass(frozen=True)
class PlayedMonitor:
    """One monitor that is played."""

    name: str  # for people; empty when it is the only one
    running: RuntimeMonitor[Any]  # the monitor; it begins anew
    node: ReplayedNode  # it has received nothing yet
    rule: StepRule  # how it steps
    sources: Mapping[str, Sequence[str]]  # topic -> ids by which the node knows its messages
    # id of a source -> the ages, in nanoseconds, that inputs allow it
    limits: Mapping[str, Collection[int]]
    publisher: Publications | None = None  # what others receive of it
    words: str = ""  # topic on which it tells other robots, empty for none
    folder: Path | None = None  # of its package, where the code in it runs
    offset: int = 0  # nanoseconds from the start of the recording to that of its node


def compiled(monitor: BoundMonitor) -> RuntimeMonitor[Any]:
    """Return the monitor as its package would load it; hand-written code is not in it."""
    running: RuntimeMonitor[Any] = monitor.compiled.monitor(monitor.model.name)
    return running


def played(members: Sequence[Member], rule: StepRule | None = None) -> list[PlayedMonitor]:
    """Return members as they are played, publishers before those who listen to them.

    Each steps as its node would, without a configuration for each row; or all by a rule.
    """
    several = len(members) > 1
    monitors = []
    for member in members:
        sources: dict[str, dict[str, None]] = {}
        limits: dict[str, set[int]] = {}
        fleet = member.fleet
        for binding in member.bindings:
            for source in binding.requires:
                if isinstance(binding.max_age, int | float):
                    limits.setdefault(source.id, set()).add(round(binding.max_age * SECOND))
                if fleet is None or source.peers is None:
                    # a column has no message
                    topic = member.topic(source.topic) if source.type else source.topic or source.id
                    sources.setdefault(topic, {})[source.id] = None
        if fleet is not None:
            sources.setdefault(fleet.topic, {})[WORDS] = None
        running, node = _started(member, fleet)
        own = ROWS
        if member.monitor.config is not None:
            section = member.monitor.config.config.Model
            own = StepRule(SECOND / section.frequency, section.mode == "on_change")
        monitors.append(
            PlayedMonitor(
                member.name if several else "",
                running,
                node,
                rule or own,
                {topic: list(ids) for topic, ids in sources.items()},
                limits,
                member.publications if several else None,
                fleet.topic if fleet is not None else "",
                member.code.folder if member.code is not None else None,
            )
        )
    publishers = {
        str(number): tuple(
            str(other)
            for other, of in enumerate(monitors)
            if of.publisher is not None and of.publisher.topics & monitor.sources.keys()
        )
        for number, monitor in enumerate(monitors)
    }
    ordered = in_order(publishers)  # without those that listen to each other
    return [monitors[int(k)] for k in dict.fromkeys([*ordered, *publishers])]


def _started(member: Member, fleet: Fleet | None) -> tuple[RuntimeMonitor[Any], ReplayedNode]:
    if member.code is None:
        running = compiled(member.monitor)
        return running, ReplayedNode(GivenInput(member.bindings), running, fleet=fleet)
    eddi_monitor, eddi_input = member.code.new()
    if member.columns:
        if not hasattr(eddi_input, "begin_step"):  # of the D7.2 tools: it takes messages alone
            eddi_input = EDDIInputBase()
        pairs = zip(member.monitor.inputs, member.bindings, strict=True)
        lines = [(here, _lines(member, binding, eddi_input)) for binding, here in pairs]
        eddi_input.processing = processing_of(eddi_input, lines)
    running = eddi_monitor.monitor
    return running, ReplayedNode(eddi_input, running, eddi_monitor.execute_step, fleet)


def _lines(member: Member, binding: InputBinding, eddi_input: Any) -> Process:
    """Return what makes an input of its messages, or of its value; people write in the former."""
    name = binding.attribute
    process: Process | None = getattr(eddi_input, f"process_{name}", None)
    if binding.model.id not in member.columns:
        return process or generated_lines(eddi_input, binding)
    make = member.message_for(binding)
    if process is None or make is None or not member.is_by_hand(binding):
        return lambda value: setattr(eddi_input, name, value)
    return lambda value: process(make(value))


class Steps:
    """The steps of one node: from the start to the first one that has seen the end.

    Of a node that steps by period only, that is the step behind the end. ``limits``: source -> ages
    at which something that was made of it becomes too old.
    """

    def __init__(
        self, rule: StepRule, limits: Mapping[str, Collection[int]], start: int, end: int
    ) -> None:
        self._rule, self._limits, self._start, self._end = rule, limits, start, end
        self._next: float = math.inf if rule.period is None else start
        self._count = 0
        self._last: float = -math.inf
        self._expiries: dict[tuple[str, int], int] = {}

    def due(self) -> int | None:
        """Return when the next step is if nothing comes before, ``None`` when there is none."""
        if not self._rule.on_change:
            return int(self._next) if self._last < self._end else None
        due = min([self._next, *self._expiries.values()])
        return int(due) if due <= self._end else None

    def changed(self, t: int) -> None:
        """Note that something came which the node may step for."""
        if self._rule.on_change:
            self._next = min(self._next, t)

    def received(self, t: int, source: str) -> None:
        """Note a message: from when on it is too old."""
        if self._rule.on_change and self._rule.period is not None:
            for limit in self._limits.get(source, ()):
                self._expiries[source, limit] = t + limit + 1

    def stepped(self, t: int) -> None:
        """Note a step."""
        self._last = t
        self._count += 1
        self._expiries = {key: end for key, end in self._expiries.items() if end > t}
        period = self._rule.period
        if period is None:
            self._next = math.inf
        elif self._rule.on_change:
            self._next = t + max(1, round(period))
        else:  # the start is a whole number that a float may not hold
            self._next = self._start + round(self._count * period)


Playback = Iterator[tuple[PlayedMonitor, Step]]  # the steps of a recording, in the order of time


def play(
    monitors: Sequence[PlayedMonitor],
    recording: Recording,
    silent: Mapping[str, int] = MappingProxyType({}),
) -> Playback:
    """Play a recording to monitors, in the order in which they step.

    Args:
        monitors: they begin anew.
        recording: what their nodes receive, besides what they tell each other.
        silent: topic -> time after which nobody receives anything on it.

    Raises:
        EddiError: these are more steps than anybody waits for (I019).
    """
    length, rows = recording.end - recording.start, len(recording.rows)
    periods = [monitor.rule.period for monitor in monitors]
    most = max(rows if period is None else length / period for period in periods)
    if most > MAX_STEPS:
        raise EddiError(problem("I019", length=length / SECOND, most=most))
    for monitor in monitors:
        monitor.running.reset()
    return _Player(monitors, recording, silent).steps()


class _Player:
    def __init__(
        self, monitors: Sequence[PlayedMonitor], recording: Recording, silent: Mapping[str, int]
    ) -> None:
        start, end = recording.start, recording.end
        self._monitors, self._silent = monitors, silent
        self._steps = [Steps(m.rule, m.limits, start + m.offset, end) for m in monitors]
        self._inboxes: list[list[Received]] = [[] for _ in monitors]
        self._topics = {topic for monitor in monitors for topic in monitor.sources}
        self._samples, self._rows = deque(recording.samples), deque(recording.rows)

    def steps(self) -> Playback:
        while (t := self._next()) is not None:
            if self._rows and self._rows[0] <= t:
                self._rows.popleft()
                for steps in self._steps:
                    steps.changed(t)
            while self._samples and self._samples[0].t <= t:
                sample = self._samples.popleft()
                self._deliver(sample.topic, sample.message, sample.t)
            for number, monitor in enumerate(self._monitors):
                due = self._steps[number].due()
                if due is not None and due <= t:
                    yield monitor, self._step(number, t)

    def _next(self) -> int | None:
        """Return when something comes or somebody steps next."""
        times = [due for steps in self._steps if (due := steps.due()) is not None]
        if self._samples:
            times.append(self._samples[0].t)
        if self._rows:
            times.append(self._rows[0])
        return min(times, default=None)

    def _step(self, number: int, t: int) -> Step:
        monitor = self._monitors[number]
        step = monitor.node.step(t, self._inboxes[number])
        self._inboxes[number] = []
        self._steps[number].stepped(t)
        publisher = monitor.publisher
        if publisher is not None:
            for topic, message in publisher.messages(monitor.running, step.output, self._topics):
                self._deliver(topic, message, t, sender=number)
            self._tell(publisher, monitor.running, t)
        word = monitor.node.word(step.output, t)
        if word is not None:
            self._deliver(monitor.words, word, t, sender=number)
        return step

    def _tell(self, publisher: Publications, running: RuntimeMonitor[Any], t: int) -> None:
        """Give the reasons of a monitor to those that read its claims."""
        why: Any = None
        for reader, inbox in zip(self._monitors, self._inboxes, strict=True):
            topics = reader.sources.keys() & publisher.topics
            heard = {source for topic in topics for source in reader.sources[topic]}
            read = {source for spec in reader.running.inputs for source, _ in spec.claims}
            for source in read & heard:
                why = why or running.why()
                inbox.append(Received(t, f"{source}/why", why))

    def _deliver(self, topic: str, message: Any, t: int, sender: int = -1) -> None:
        """Give a message to all who listen; only those behind the sender step for it at once."""
        if t > self._silent.get(topic, t):
            return
        for number, monitor in enumerate(self._monitors):
            for source in monitor.sources.get(topic, ()):
                self._inboxes[number].append(Received(t, source, message))
                self._steps[number].received(t, source)
                if number > sender and source != WORDS:
                    self._steps[number].changed(t)


def raising(play: Playback, report: Callable[[Problem], None]) -> Playback:
    """Warn of the first exception of each hand-written method when it was raised (I014)."""
    reported: set[tuple[Path, str]] = set()
    for monitor, step in play:
        for name, (reason, traceback) in sorted(monitor.node.raised.items()):
            if (folder := monitor.folder) is None or (folder, name) in reported:
                continue
            reported.add((folder, name))
            place = Place(str(folder))
            for path, line in _CALL.findall(traceback):
                if Path(path).is_relative_to(folder.resolve()):  # the last one of its own
                    own = folder / Path(path).relative_to(folder.resolve())
                    place = Place(str(own), int(line))
            report(problem("I014.raises", place, name=name, time=step.t, reason=reason))
        yield monitor, step
