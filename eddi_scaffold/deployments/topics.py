"""Who publishes what: monitors, topics with full names, and publishers not at hand."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

from eddi_scaffold.common.problems import Place, Problem, problem
from eddi_scaffold.config.schema import SimulatorOutput
from eddi_scaffold.deployments.support import PublishedTopic, WiredMonitor
from eddi_scaffold.monitors.input_rules import kind_of_message
from eddi_scaffold.monitors.publications import MESSAGE_PACKAGE, Publication


class Publisher(NamedTuple):
    """A topic that a member publishes."""

    member: WiredMonitor
    publication: Publication


@dataclass(frozen=True)
class Deployment:
    """Monitors that run together."""

    members: Sequence[WiredMonitor]  # those that are at hand
    others: Sequence[WiredMonitor] = ()  # those that run with them

    @cached_property
    def publishers(self) -> Mapping[str, Sequence[Publisher]]:
        """Full name of a topic -> the members that publish it."""
        publishers: dict[str, list[Publisher]] = {}
        for member in self.members:
            for publication in member.publications:
                topic = member.topic(publication.output.topic)
                publishers.setdefault(topic, []).append(Publisher(member, publication))
        return publishers

    @property
    def participants(self) -> Sequence[WiredMonitor]:
        """All monitors, as far as a package remembers them."""
        return [*self.members, *self.others]

    def publisher(self, member: WiredMonitor, source: SimulatorOutput) -> Publisher | None:
        """Return who publishes what a member listens to, ``None`` when no other member does."""
        publishers = self.publishers.get(member.topic(source.topic), ())
        return next((of for of in publishers if of.publication.type == source.type), None)

    def other(self, member: WiredMonitor, source: SimulatorOutput) -> PublishedTopic | None:
        """Return who of the others publishes what a member listens to."""
        topic = member.topic(source.topic)
        items = (item for other in self.others for at, item in other.published if at == topic)
        return next(items, None)


def check_topics(deployment: Deployment) -> Iterator[Problem]:
    """Report topics that two monitors publish (D005)."""
    first: dict[str, tuple[WiredMonitor, Place]] = {}
    for topic, publishers in deployment.publishers.items():
        results = [of for of in publishers if of.publication.of == "" or of.publication.path]
        for other in results[1:]:
            if other.member is not results[0].member:
                names = {"first": results[0].member.name, "second": other.member.name}
                place, own = other.publication.place, other.publication.output.topic
                if results[0].member.namespace == other.member.namespace:
                    yield problem("D005.shared", place, topic=topic, **names)
                else:
                    relative = own.removeprefix("/")
                    yield problem("D005.robots", place, topic=topic, relative=relative, **names)
        if results:
            first[topic] = results[0].member, results[0].publication.place
    for monitor in deployment.others:
        config = monitor.config
        for index, output in enumerate(config.config.EDDIOutputs):
            topic, at = monitor.topic(output.topic), config.place("EDDIOutputs", index, "topic")
            known, place = first.setdefault(topic, (monitor, at))
            if place is at or known.name == monitor.name:  # the same, whose folder was moved
                continue
            # No error: nodes may be started in namespaces of their own, or not at all.
            names = {"name": known.name, "package": monitor.package, "topic": topic}
            yield problem("D005.package", place, **names)


def check_alone(participants: Sequence[WiredMonitor]) -> Iterator[Problem]:
    """Report who reads a value alone (D001): an unknown false would be passed on as known."""
    alone = {
        participant.topic(name): (participant, of)
        for participant in participants
        for name, of in participant.alone.items()
    }
    for reader in participants:
        for index, entry in enumerate(reader.config.config.EDDIInputs):
            reads = dict.fromkeys(topic for topic, _ in reader.topics_read.get(entry.id, ()))
            for topic in (topic for topic in reads if topic in alone):
                publisher, field = alone[topic]
                place = reader.config.place("EDDIInputs", index)
                names = {"input": entry.id, "topic": topic, "monitor": publisher.name}
                yield problem("D001.alone", place, field=field, **names)


def check_types(deployment: Deployment) -> Iterator[Problem]:
    """Report topics that monitors read, or read and publish, with different types (D005)."""
    first: dict[str, tuple[str, str]] = {}
    several = set()
    for topic, publishers in deployment.publishers.items():
        first[topic] = publishers[0].publication.type, publishers[0].member.name
        if len({publisher.publication.type for publisher in publishers}) > 1:
            several.add(topic)  # reported as D005
    for member in deployment.members:
        for index, source in enumerate(member.config.config.SimulatorOutputs):
            topic = member.topic(source.topic)
            type_, name = first.setdefault(topic, (source.type, member.name))
            if source.type != type_ and topic not in several:
                place = member.config.place("SimulatorOutputs", index, "topic")
                types = {"type": type_, "source_type": source.type}
                yield problem("D005.topic_type", place, topic=topic, name=name, **types)


def check_spellings(deployment: Deployment) -> Iterator[Problem]:
    """Report messages of ours that are read, and whose fields get other names (G026)."""
    respelt = {
        f"{MESSAGE_PACKAGE}/{name}"
        for member in deployment.members
        for name in member.kind.respelt(member.config.config.Model.model_extra or {})
    }
    for member in deployment.members:
        for index, source in enumerate(member.config.config.SimulatorOutputs):
            if source.type in respelt:
                place = member.config.place("SimulatorOutputs", index, "type")
                yield problem("G026", place, message=source.type.partition("/")[2])


def shared_by_robots(members: Sequence[WiredMonitor]) -> str | None:
    """Report which topics of monitors two robots on one master would share; ``None`` for none."""
    topics = {
        publication.output.topic
        for member in members
        for publication in member.publications
        if publication.output.topic.startswith("/")
    }
    shared = f"two robots on one master would share {', '.join(sorted(topics))}"
    return f"{shared}: topics without `/` at the start are apart" if topics else None


def absent_publishers(deployment: Deployment) -> Iterator[Problem]:
    """Warn of topics with messages of ours that no monitor publishes (D006)."""
    where = "these files and packages" if deployment.others else "these files"
    for member in deployment.members:
        config = member.config
        required = {name for entry in config.config.EDDIInputs for name in entry.requires}
        required |= {name for input_ in member.facts.inputs for name in input_.requires}
        for index, source in enumerate(config.config.SimulatorOutputs):
            if source.id not in required or kind_of_message(source.type) is None or source.peers:
                continue
            if not (deployment.publisher(member, source) or deployment.other(member, source)):
                place = config.place("SimulatorOutputs", index, "topic")
                yield problem("D006", place, topic=member.topic(source.topic), files=where)
