"""Recordings played to monitors: one timeline, on which each steps as its node would."""

from __future__ import annotations

import math
from collections import deque
from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

from eddi_runtime import Monitor as RuntimeMonitor

from eddi_scaffold.common.problems import EddiError, Place, Problem, problem
from eddi_scaffold.kinds import InputType
from eddi_scaffold.monitors.binding import BoundMonitor
from eddi_scaffold.monitors.input_binding import InputBinding
from eddi_scaffold.recordings.csv_recording import Recording
from eddi_scaffold.recordings.node import (
    SECOND,
    GivenInput,
    Publications,
    Received,
    ReplayedNode,
    Step,
)

MAX_STEPS = 10_000_000
"""Eleven days at 10 Hz, some ten minutes of work: who asks for more has a slip in t."""
_ALL = {"fraction": 1.0, "percent": 100.0, "pct": 100.0}
"""Unit -> what all of something is in it; a ratio without a name may be more."""

Running = tuple["RuntimeMonitor[Any]", ReplayedNode]  # A monitor that runs, and a node of it


@dataclass(frozen=True)
class StepRule:
    """How a node steps."""

    # nanoseconds between two steps, `None`: there are none but those at changes
    period: float | None
    # it also steps when something comes, or becomes too old; the period counts from the last step
    # then
    on_change: bool


ROWS = StepRule(None, on_change=True)  # one step for each row, or message, and no other


def step_rule(monitor: BoundMonitor) -> StepRule:
    """Return how the node of a monitor steps; without a configuration, for each row."""
    if monitor.config is None:
        return ROWS
    section = monitor.config.config.Model
    return StepRule(SECOND / section.frequency, section.mode == "on_change")


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


def compiled(monitor: BoundMonitor) -> RuntimeMonitor[Any]:
    """Return the monitor as its package would load it; hand-written code is not in it."""
    running: RuntimeMonitor[Any] = monitor.compiled.monitor(monitor.model.name)
    return running


def published(monitors: Sequence[BoundMonitor]) -> frozenset[str]:
    """Return the topics that monitors publish which are played together; of one alone, none."""
    if len(monitors) < 2:
        return frozenset()
    return frozenset().union(*(Publications(m).topics for m in monitors))


def columns(monitors: Sequence[BoundMonitor]) -> dict[str, InputType]:
    """Return input -> type of those whose values a recording has: what no other monitor publishes.

    Raises:
        EddiError: inputs of one name are not the same in two monitors (G000).
    """
    shared = published(monitors)
    owners: dict[str, tuple[str, object]] = {}
    types: dict[str, InputType] = {}
    for monitor in monitors:
        for binding in monitor.inputs:
            if _is_received(binding, monitor, shared):
                continue
            id_, type_ = binding.model.id, binding.model.type
            topics = [monitor.topic(source.topic) for source in binding.requires]
            meaning = (type_, binding.unit, binding.expression, binding.computed_text, topics)
            first, same = owners.setdefault(id_, (monitor.id, meaning))
            if same != meaning:
                raise EddiError(problem("G000.one_column", id=id_, first=first, monitor=monitor.id))
            types[id_] = type_
    return types


def more_than_all(
    monitors: Sequence[BoundMonitor], recording: Recording, file: str
) -> Iterator[Problem]:
    """Warn of inputs that are more than all of what they are a part of (I006)."""
    units = {input_.model.id: input_.unit for monitor in monitors for input_ in monitor.inputs}
    reported = set()
    for sample in recording.samples:
        unit, value = units.get(sample.topic), sample.message
        most = _ALL.get(unit or "", math.inf)
        if sample.topic in reported or not isinstance(value, int | float) or not value > most:
            continue
        reported.add(sample.topic)
        message = f"{sample.topic!r} is {value:g} {unit} at {sample.t / SECOND:.3f} s"
        yield problem("I006.more_than_all", Place(file), message=message, most=most, unit=unit)


def _is_received(binding: InputBinding, monitor: BoundMonitor, shared: Collection[str]) -> bool:
    topics = [monitor.topic(source.topic) for source in binding.requires]
    return bool(topics) and binding.is_given and all(topic in shared for topic in topics)


def of_values(
    monitors: Sequence[BoundMonitor], rules: Sequence[StepRule], running: Running | None = None
) -> list[PlayedMonitor]:
    """Return monitors that are given their ``columns``, and listen to each other.

    A package may run the only one; without, it is what the package would be without hand-written
    lines.
    """
    shared = published(monitors)
    by_value = []
    for monitor in monitors:
        bindings = (b if _is_received(b, monitor, shared) else b.by_value() for b in monitor.inputs)
        by_value.append(replace(monitor, inputs=tuple(bindings)))
    return of_messages(by_value, rules, running)


def of_messages(
    monitors: Sequence[BoundMonitor], rules: Sequence[StepRule], running: Running | None = None
) -> list[PlayedMonitor]:
    """Return monitors that listen to topics, also to those of each other, in the order of steps."""
    several = len(monitors) > 1
    played = []
    for monitor, rule in zip(monitors, rules, strict=True):
        sources: dict[str, dict[str, None]] = {}
        limits: dict[str, set[int]] = {}
        for binding in monitor.inputs:
            for source in binding.requires:
                # a column has no message
                topic = monitor.topic(source.topic) if source.type else source.id
                sources.setdefault(topic, {})[source.id] = None
                if isinstance(binding.max_age, int | float):
                    limits.setdefault(source.id, set()).add(round(binding.max_age * SECOND))
        name = monitor.config.config.Model.id if several and monitor.config is not None else ""
        publisher = Publications(monitor) if several else None
        if running is None:
            model = compiled(monitor)
            own = model, ReplayedNode(GivenInput(monitor.inputs), model)
        else:
            own = running
        topics = {topic: list(ids) for topic, ids in sources.items()}
        played.append(PlayedMonitor(name, *own, rule, topics, limits, publisher))
    return _in_order(played)


def _in_order(monitors: Sequence[PlayedMonitor]) -> list[PlayedMonitor]:
    """Return publishers before those who listen to them, as far as no two listen to each other."""
    ordered: list[PlayedMonitor] = []
    begun: set[str] = set()

    def visit(monitor: PlayedMonitor) -> None:
        if monitor.name in begun:
            return
        begun.add(monitor.name)
        for other in monitors:
            if other.publisher is not None and other.publisher.topics & monitor.sources.keys():
                visit(other)
        ordered.append(monitor)

    for monitor in monitors:
        visit(monitor)
    return ordered


class Steps:
    """The steps of one node: from the start to the first one that has seen the end.

    Args:
        rule: how it steps.
        limits: source -> ages at which something that was made of it becomes too old.
        start: of the recording.
        end: of the recording; of a node that steps by period only, the step behind it is the last.
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


def play(monitors: Sequence[PlayedMonitor], recording: Recording) -> Playback:
    """Play a recording to monitors, in the order in which they step.

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
    return _Player(monitors, recording).steps()


class _Player:
    def __init__(self, monitors: Sequence[PlayedMonitor], recording: Recording) -> None:
        start, end = recording.start, recording.end
        self._monitors = monitors
        self._steps = [Steps(m.rule, m.limits, start, end) for m in monitors]
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
        for number, monitor in enumerate(self._monitors):
            for source in monitor.sources.get(topic, ()):
                self._inboxes[number].append(Received(t, source, message))
                self._steps[number].received(t, source)
                if number > sender:
                    self._steps[number].changed(t)
