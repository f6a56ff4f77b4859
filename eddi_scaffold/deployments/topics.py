"""Who publishes what: monitors, topics with full names, and publishers not at hand."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property

from eddi_scaffold.common.problems import Place, Problem, most_similar, problem
from eddi_scaffold.config.file import ConfigFile
from eddi_scaffold.config.schema import SimulatorOutput
from eddi_scaffold.deployments.support import (
    PublishedTopic,
    WiredMonitor,
    topics_published,
    topics_read,
)
from eddi_scaffold.monitors.binding import BoundMonitor
from eddi_scaffold.monitors.input_rules import kind_of_message
from eddi_scaffold.monitors.publications import (
    MESSAGE_PACKAGE,
    Publication,
    publications,
    read_respelt,
)


@dataclass(frozen=True)
class Member:
    """A monitor of a deployment that is at hand with its model.

    Attributes:
        monitor: it has a configuration.
        namespace: of its robot, such as ``/robot1``; empty for none.
    """

    monitor: BoundMonitor
    namespace: str = ""

    @cached_property
    def participant(self) -> WiredMonitor:
        """The same, as far as a package remembers it."""
        monitor = self.monitor
        return WiredMonitor(
            self.name,
            monitor.package,
            self.namespace,
            monitor.kind,
            self.config,
            monitor.facts,
            monitor.model.source.name,
            {
                one.output.topic: _field(one)
                for one in publications(monitor, self.config)[0]
                if one.path
            },
        )

    @property
    def config(self) -> ConfigFile:
        """Its configuration."""
        assert self.monitor.config is not None
        return self.monitor.config

    @property
    def name(self) -> str:
        """Its id, with the namespace where it has one: for people."""
        id_ = self.config.config.Model.id
        return f"{self.namespace}/{id_}" if self.namespace else id_

    def topic(self, name: str) -> str:
        """Return the full name of a topic, as ROS resolves it for this monitor's node."""
        return self.participant.topic(name)


def _field(one: Publication) -> str:
    path = one.output.field or f"evidence[{one.output.id}].active"  # the topic of a threshold
    return f"`{path}` of {one.message}"


@dataclass(frozen=True)
class Publisher:
    """A topic that a member publishes."""

    member: Member
    publication: Publication


@dataclass(frozen=True)
class Deployment:
    """Monitors that run together.

    Attributes:
        members: those that are at hand.
        publishers: full name of a topic -> the members that publish it.
        others: those that run with them.
    """

    members: tuple[Member, ...]
    publishers: Mapping[str, Sequence[Publisher]]
    others: tuple[WiredMonitor, ...] = ()

    @property
    def participants(self) -> Sequence[WiredMonitor]:
        """All monitors, as far as a package remembers them."""
        return [*(member.participant for member in self.members), *self.others]

    def publisher(self, member: Member, source: SimulatorOutput) -> Publisher | None:
        """Return who publishes what a member listens to, ``None`` when no other member does."""
        found = self.publishers.get(member.topic(source.topic), ())
        return next((one for one in found if one.publication.type == source.type), None)

    def other(self, member: Member, source: SimulatorOutput) -> PublishedTopic | None:
        """Return who of the others publishes what a member listens to."""
        topic = member.topic(source.topic)
        found = (
            item for other in self.others for at, item in topics_published(other) if at == topic
        )
        return next(found, None)


def deployment(members: Sequence[Member], others: Sequence[WiredMonitor] = ()) -> Deployment:
    """Return the members with what each of them publishes where."""
    publishers: dict[str, list[Publisher]] = {}
    for member in members:
        for one in publications(member.monitor, member.config)[0]:
            topic = member.topic(one.output.topic)
            publishers.setdefault(topic, []).append(Publisher(member, one))
    return Deployment(tuple(members), publishers, tuple(others))


def check_topics(deployment: Deployment) -> Iterator[Problem]:
    """Report topics that two monitors publish (D005)."""
    for topic, found in deployment.publishers.items():
        publishers = [one for one in found if one.publication.of == "" or one.publication.path]
        for other in publishers[1:]:
            if other.member is not publishers[0].member:
                yield _shared(topic, publishers[0], other)
    yield from _shared_with_others(deployment)


def check_alone(participants: Sequence[WiredMonitor]) -> Iterator[Problem]:
    """Report who reads a value alone (D001): an unknown false would be passed on as known."""
    alone = {
        participant.topic(name): (participant, of)
        for participant in participants
        for name, of in participant.alone.items()
    }
    for reader in participants:
        reads = topics_read(reader)
        for index, entry in enumerate(reader.config.config.EDDIInputs):
            for topic in dict.fromkeys(topic for topic, _ in reads.get(entry.id, ())):
                if topic in alone:
                    publisher, field = alone[topic]
                    yield problem(
                        "D001.alone",
                        reader.config.place("EDDIInputs", index),
                        input=entry.id,
                        topic=topic,
                        field=field,
                        monitor=publisher.name,
                    )


def check_types(deployment: Deployment) -> Iterator[Problem]:
    """Report topics that monitors read, or read and publish, with different types (D005)."""
    first: dict[str, tuple[str, str]] = {}
    several = set()
    for topic, found in deployment.publishers.items():
        first[topic] = found[0].publication.type, found[0].member.name
        if any(one.publication.type != found[0].publication.type for one in found):
            several.add(topic)  # reported as D005
    for member in deployment.members:
        for index, source in enumerate(member.config.config.SimulatorOutputs):
            topic = member.topic(source.topic)
            type_, name = first.setdefault(topic, (source.type, member.name))
            if source.type != type_ and topic not in several:
                place = member.config.place("SimulatorOutputs", index, "topic")
                yield problem(
                    "D005.topic_type",
                    place,
                    topic=topic,
                    type=type_,
                    name=name,
                    source_type=source.type,
                )


def check_spellings(deployment: Deployment) -> Iterator[Problem]:
    """Report messages of ours that are read, and whose fields get other names (G026)."""
    respelt = {
        name
        for member in deployment.members
        for name in member.monitor.kind.respelt(member.config.config.Model.model_extra or {})
    }
    for member in deployment.members:
        for index, source in enumerate(member.config.config.SimulatorOutputs):
            package, _, name = source.type.partition("/")
            if package == MESSAGE_PACKAGE and name in respelt:
                place = member.config.place("SimulatorOutputs", index, "type")
                yield read_respelt(name, place)


def shared_by_robots(members: Sequence[Member]) -> str | None:
    """Report which topics of monitors two robots on one master would share; ``None`` for none."""
    topics = {
        one.output.topic
        for member in members
        for one in publications(member.monitor, member.config)[0]
        if one.output.topic.startswith("/")
    }
    if not topics:
        return None
    shown = ", ".join(sorted(topics))
    return (
        f"two robots on one master would share {shown}: topics without `/` at the start are apart"
    )


def absent_publishers(deployment: Deployment) -> Iterator[Problem]:
    """Warn of topics with messages of ours that no monitor publishes (D006)."""
    for member in deployment.members:
        yield from _absent(deployment, member)


def _shared(topic: str, first: Publisher, second: Publisher) -> Problem:
    one, two = first.member, second.member
    place = second.publication.place
    if one.namespace == two.namespace:
        return problem("D005.shared", place, first=one.name, second=two.name, topic=topic)
    relative = second.publication.output.topic.removeprefix("/")
    return problem(
        "D005.robots", place, first=one.name, second=two.name, topic=topic, relative=relative
    )


def _shared_with_others(deployment: Deployment) -> Iterator[Problem]:
    """Report topics that a package which is there publishes as well."""
    first: dict[str, tuple[WiredMonitor, Place]] = {}
    new = {member.monitor.package for member in deployment.members}
    for topic, found in deployment.publishers.items():
        publisher = next((o for o in found if o.publication.of == "" or o.publication.path), None)
        if publisher is not None:
            first[topic] = publisher.member.participant, publisher.publication.place
    for other in deployment.others:
        own = {
            other.topic(output.topic): other.config.place("EDDIOutputs", index, "topic")
            for index, output in enumerate(other.config.config.EDDIOutputs)
        }
        for topic, at in own.items():
            one, place = first.setdefault(topic, (other, at))
            if place is at or one.name == other.name:  # the same monitor, whose folder was moved
                continue
            hint = "give each a topic of its own"
            if one.package in new:
                hint += (
                    f"; if the model has a new name, add `--rename {other.package}={one.package}`"
                )
            hint += "; else remove the package that is of no use"
            # No error: nodes may be started in namespaces of their own, or not at all.
            yield problem(
                "D005.package", place, hint=hint, name=one.name, package=other.package, topic=topic
            )


def _absent(deployment: Deployment, member: Member) -> Iterator[Problem]:
    config = member.config
    required = {name for entry in config.config.EDDIInputs for name in entry.requires}
    required |= {
        requirement.id for binding in member.monitor.inputs for requirement in binding.requires
    }
    for index, source in enumerate(config.config.SimulatorOutputs):
        topic = member.topic(source.topic)
        if source.id not in required or kind_of_message(source.type) is None or source.peers:
            continue
        if not (deployment.publisher(member, source) or deployment.other(member, source)):
            of = "these files and packages" if deployment.others else "these files"
            place = config.place("SimulatorOutputs", index, "topic")
            hint = "check it together with the configuration and the model of its publisher"
            alike = _alike(deployment, member, topic, source.type)
            if alike is not None:
                hint = f"{alike} Else {hint}"
            yield problem("D006", place, hint=hint, topic=topic, files=of)


def _alike(deployment: Deployment, member: Member, topic: str, type_: str) -> str | None:
    """Return the hint at a topic of nearly this name that another member publishes."""
    known = {
        at: one.member.name
        for at, found in deployment.publishers.items()
        for one in found
        if one.publication.type == type_ and one.member is not member
    }
    near = most_similar(topic, known)
    return f"did you mean {near} ({known[near]})?" if near is not None else None
