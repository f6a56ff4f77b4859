"""A deployment played in one process: the product's monitors, nodes and messages on a grid of time.

At a time come first restarts, then samples, then every monitor that is due, in the order of the
deployment. What one publishes, those behind it receive at once, those before it in their next step.
"""

from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any, NamedTuple

from eddi_runtime import Monitor as RunningMonitor

from eddi_scaffold.monitors.binding import BoundMonitor
from eddi_scaffold.recordings.node import GivenInput, Message, Received, ReplayedNode
from eddi_scaffold.recordings.node import Publications as ProductPublisher
from eddi_scaffold.recordings.playing import compiled


class Sample(NamedTuple):
    t: int
    topic: str
    message: Message
    latched: bool = False


@dataclass(frozen=True)
class History:
    until: int
    samples: tuple[Sample, ...] = ()
    # name, from, to: the process does not run, and begins anew at the end
    dead: tuple[tuple[str, int, int], ...] = ()
    # time, name: it has forgotten everything, also what it had received
    restarts: tuple[tuple[int, str], ...] = ()
    # time, offset: the clock of the steps is set, ages of messages do not change
    clock: tuple[tuple[int, int], ...] = ()
    # who begins anew receives the last message of each topic whose publisher lives
    latching: bool = False

    def at(self, t: int) -> Sequence[Sample]:
        return self._by_time.get(t, ())

    @cached_property
    def _by_time(self) -> Mapping[int, Sequence[Sample]]:
        found: dict[int, list[Sample]] = {}
        for sample in self.samples:
            found.setdefault(sample.t, []).append(sample)
        return found

    def is_dead(self, name: str, t: int) -> bool:
        return any(who == name and begin <= t < end for who, begin, end in self.dead)

    def begins(self, name: str, t: int) -> bool:
        ends = any(who == name and end == t for who, _, end in self.dead)
        return ends or (t, name) in self.restarts

    def offset(self, t: int) -> int:
        return sum(by for since, by in self.clock if since <= t)


Published = Sequence[tuple[str, Message]]


def resolved(topic: str, namespace: str = "") -> str:
    if topic.startswith("/"):
        return topic
    return f"/{namespace}/{topic}".replace("//", "/")


class Publisher(ProductPublisher):
    """The publications of one monitor in one namespace.

    Attributes:
        hazards: events whose `active` claims nothing, and whose absence does.
    """

    def __init__(
        self, monitor: BoundMonitor, rename: Mapping[str, str], namespace: str = ""
    ) -> None:
        """Take over the outputs of the configuration.

        Args:
            rename: topic in the configuration -> another one, as a launch file remaps it.
        """

        def full(topic: str) -> str:
            for old, new in rename.items():
                if topic == old or topic.startswith(f"{old}/"):  # also what stands beside a result
                    return resolved(new + topic.removeprefix(old), namespace)
            return resolved(topic, namespace)

        super().__init__(monitor)
        self.channels = [
            one._replace(topic=full(one.publication.output.topic)) for one in self.channels
        ]
        self.hazards = _hazards(monitor)
        claims = {"safeml": "status", "bayesian_network": "evidence"}.get(monitor.kind.name, "")
        self._claiming = {one.topic for one in self.channels if one.publication.of == claims}

    def messages(self, running: RunningMonitor, output: Any, wanted: Collection[str]) -> Any:
        return super().messages(running, output, {*wanted, *self._claiming})

    def claims(self, told: Published) -> Mapping[str, bool]:
        found: dict[str, bool] = {}
        for _, message in told:
            kind = message.message_type.partition("/")[2]
            if kind == "ConSertOutput":
                found.update((one.id, one.active) for one in message.guarantees)
            elif kind == "EventOutput":
                hazard = message.id in self.hazards
                found[message.id] = not message.active if hazard else message.active
            elif kind in ("ReliabilityOutput", "BayesianNetworkEvidence"):
                found.update((one.id, one.active) for one in message.evidence)
            elif kind == "StateMachineOutput":
                found.update((one.id, one.active) for one in message.evidence)
                found |= {"not failed": message.failed == 0, "failed": message.failed == 2}
                found.update((f"in {one.id}", one.verdict == 2) for one in message.in_state)
                found.update((f"not in {one.id}", one.verdict == 0) for one in message.in_state)
            elif kind == "SafeMLStatus":
                found["in_scope"] = message.in_scope
        return found


def _hazards(monitor: BoundMonitor) -> frozenset[str]:
    if monitor.kind.name != "event":
        return frozenset()
    events = monitor.model.data.analysis.events
    return frozenset(event.id for event in events if event.polarity == "HAZARD")


MS = 1_000_000
CLOCK_START = 1_000_000_000
"""Milliseconds: where the clock of the steps begins, far enough from zero to be set back."""


@dataclass(frozen=True)
class Member:
    name: str
    monitor: BoundMonitor
    topics: Mapping[str, str]  # id of each simulator output -> full name of its topic
    publisher: Publisher  # what it publishes, and what it claims
    every: int  # its period
    delay: int = 0  # from its step until others receive what it published


@dataclass(frozen=True)
class Deployment:
    """Monitors, in the order in which they step, and what happens to them."""

    members: tuple[Member, ...]
    history: History
    tick: int = 500

    @cached_property
    def subscribers(self) -> Mapping[str, Sequence[tuple[str, str]]]:
        """Topic -> name of a monitor and id of its simulator output."""
        found: dict[str, list[tuple[str, str]]] = {}
        for member in self.members:
            for source, topic in member.topics.items():
                found.setdefault(topic, []).append((member.name, source))
        return found

    @property
    def sources(self) -> frozenset[str]:
        """The topics that somebody reads and none of the monitors publishes."""
        own = {topic for member in self.members for topic in member.publisher.topics}
        return frozenset(self.subscribers) - own


Claims = Mapping[str, bool]
"""``monitor.output`` -> whether it is claimed."""


@dataclass
class _Process:
    node: ReplayedNode
    inbox: list[Received] = field(default_factory=list)


class Observer:
    """Sees what monitors receive and publish; this one leaves all as it is."""

    def begun(self, member: Member) -> None:
        """Note that a process begins, with nothing received."""

    def received(self, member: Member, t: int, messages: Sequence[Received]) -> Sequence[Received]:
        """Return what a monitor is given in a step."""
        return messages

    def published(
        self, member: Member, t: int, messages: Sequence[tuple[str, Message]]
    ) -> Sequence[tuple[str, Message]]:
        """Return what the others receive of a step."""
        return messages


class World:
    """One run of a deployment.

    Args:
        deployment: what to play.
        observer: sees everything, and may change what is received.
        running: compiled monitors by name, which begin anew; without them they are compiled here.
    """

    def __init__(
        self,
        deployment: Deployment,
        observer: Observer | None = None,
        running: Mapping[str, RunningMonitor] | None = None,
    ) -> None:
        self._deployment = deployment
        self._history = deployment.history
        self._observer = observer or Observer()
        self._running = running or {m.name: compiled(m.monitor) for m in deployment.members}
        self._last: dict[str, Message] = {}
        self._late: list[tuple[int, str, Message]] = []
        self._processes = {member.name: self._begun(member) for member in deployment.members}

    def run(self) -> Iterator[tuple[int, Claims]]:
        for t in range(0, self._history.until + 1, self._deployment.tick):
            yield t, self._tick(t)

    def _begun(self, member: Member) -> _Process:
        running = self._running[member.name]
        running.reset()
        self._observer.begun(member)
        return _Process(ReplayedNode(GivenInput(member.monitor.inputs), running))

    def _tick(self, t: int) -> Claims:
        self._begin_anew(t)
        for sample in self._history.at(t):
            self._deliver(sample.topic, sample.message, t, latched=sample.latched)
        self._deliver_late(t)
        claims: dict[str, bool] = {}
        for member in self._deployment.members:
            if t % member.every == 0 and not self._history.is_dead(member.name, t):
                claims.update(self._step(member, t))
        return claims

    def _begin_anew(self, t: int) -> None:
        for member in self._deployment.members:
            if self._history.begins(member.name, t):
                self._processes[member.name] = self._begun(member)
                if self._history.latching:
                    self._greet(member, t)

    def _greet(self, member: Member, t: int) -> None:
        """Give the last messages of living monitors to one that subscribes to them."""
        for source, topic in member.topics.items():
            alive = any(
                topic in other.publisher.topics and not self._history.is_dead(other.name, t)
                for other in self._deployment.members
            )
            if alive and topic in self._last:
                message = Received(t * MS, source, self._last[topic], latched=True)
                self._processes[member.name].inbox.append(message)

    def _deliver(self, topic: str, message: Message, t: int, *, latched: bool = False) -> None:
        self._last[topic] = message
        for name, source in self._deployment.subscribers.get(topic, ()):
            if not self._history.is_dead(name, t):
                one = Received(t * MS, source, message, latched)
                self._processes[name].inbox.append(one)

    def _deliver_late(self, t: int) -> None:
        due = [one for one in self._late if one[0] <= t]
        self._late = [one for one in self._late if one[0] > t]
        for _, topic, message in due:
            self._deliver(topic, message, t)

    def _step(self, member: Member, t: int) -> Claims:
        process = self._processes[member.name]
        given = self._observer.received(member, t, process.inbox)
        process.inbox = []
        clock = (CLOCK_START + t + self._history.offset(t)) * MS
        output = process.node.step(t * MS, given, clock).output
        told = member.publisher.messages(
            self._running[member.name], output, self._deployment.subscribers
        )
        claims = member.publisher.claims(told)
        for topic, message in self._observer.published(member, t, told):
            if member.delay:
                self._late.append((t + member.delay, topic, message))
            else:
                self._deliver(topic, message, t)
        return {f"{member.name}.{name}": claimed for name, claimed in claims.items()}
