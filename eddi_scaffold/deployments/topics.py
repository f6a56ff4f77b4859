"""Who publishes what: monitors, topics with full names, and publishers not at hand."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property

from eddi_scaffold.common.problems import Problem, problem
from eddi_scaffold.config.schema import SimulatorOutput
from eddi_scaffold.deployments.support import Output, Publishers, WiredMonitor, publishers_of
from eddi_scaffold.monitors.input_rules import kind_of_message
from eddi_scaffold.monitors.publications import MESSAGE_PACKAGE


@dataclass(frozen=True)
class Deployment:
    """Monitors that run together."""

    members: Sequence[WiredMonitor]  # those that are at hand
    others: Sequence[WiredMonitor] = ()  # those that run with them

    @cached_property
    def publishers(self) -> Publishers:
        """Full name of a topic -> who publishes it, members first."""
        return publishers_of(self.participants)

    @property
    def participants(self) -> Sequence[WiredMonitor]:
        """All monitors, as far as a package remembers them."""
        return [*self.members, *self.others]

    def publisher(
        self, member: WiredMonitor, source: SimulatorOutput
    ) -> tuple[WiredMonitor, Output] | None:
        """Return who publishes what a member listens to, ``None`` when nobody does."""
        publishers = self.publishers.get(member.topic(source.topic), ())
        return next((of for of in publishers if of[1].type in ("", source.type)), None)


def check_topics(deployment: Deployment) -> Iterator[Problem]:
    """Report topics that two monitors publish (D005)."""
    for topic, publishers in deployment.publishers.items():
        results = [of for of in publishers if of[1].is_result]
        for other, output in results[1:]:
            first, own = results[0]
            names = {"first": first.name, "second": other.name, "topic": topic}
            if other.bound is None and first.name != other.name:  # else its folder was moved
                # No error: nodes may be started in namespaces of their own, or not at all.
                yield problem("D005.package", own.place, package=other.package, **names)
            elif other.bound is None or other is first:
                continue
            elif first.namespace == other.namespace:
                yield problem("D005.shared", output.place, **names)
            else:
                relative = output.topic.removeprefix("/")
                yield problem("D005.robots", output.place, relative=relative, **names)


def check_alone(deployment: Deployment) -> Iterator[Problem]:
    """Report who reads a value alone (D001): an unknown false would be passed on as known."""
    for reader in deployment.participants:
        for index, entry in enumerate(reader.config.config.EDDIInputs):
            for topic in dict.fromkeys(topic for topic, _ in reader.topics_read.get(entry.id, ())):
                for publisher, output in deployment.publishers.get(topic, ()):
                    if output.value:
                        place, field = reader.config.place("EDDIInputs", index), output.value
                        names = {"input": entry.id, "topic": topic, "monitor": publisher.name}
                        yield problem("D001.alone", place, field=field, **names)


def check_types(deployment: Deployment) -> Iterator[Problem]:
    """Report topics that monitors read, or read and publish, with different types (D005)."""
    first: dict[str, tuple[str, str]] = {}
    several = set()
    for topic, publishers in publishers_of(deployment.members).items():
        first[topic] = publishers[0][1].type, publishers[0][0].name
        if len({output.type for _, output in publishers}) > 1:
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
    outputs = [output.topic for member in members for output in member.outputs]
    topics = {topic for topic in outputs if topic.startswith("/")}
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
            if deployment.publisher(member, source) is None:
                place = config.place("SimulatorOutputs", index, "topic")
                yield problem("D006", place, topic=member.topic(source.topic), files=where)
