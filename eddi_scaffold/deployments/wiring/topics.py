"""Topics of a deployment: two publishers or types of one, and publishers that are not at hand."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from eddi_scaffold.deployments.wiring.deployment import Deployment, Member, Publisher
from eddi_scaffold.deployments.wiring.support import Participant, reads_of
from eddi_scaffold.monitors.knowledge import kind_of_message
from eddi_scaffold.monitors.publications import MESSAGE_PACKAGE, publications, read_respelt
from eddi_scaffold.problems import Place, Problem, error, nearest, warning


def check_topics(deployment: Deployment) -> Iterator[Problem]:
    """Report topics that two monitors publish (D005)."""
    for topic, found in deployment.publishers.items():
        publishers = [one for one in found if one.publication.of == "" or one.publication.path]
        for other in publishers[1:]:
            if other.member is not publishers[0].member:
                yield _shared(topic, publishers[0], other)
    yield from _shared_with_others(deployment)


def check_alone(participants: Sequence[Participant]) -> Iterator[Problem]:
    """Report who reads a value alone (D001): an unknown false would be passed on as known."""
    alone = {one.topic(name): (one, of) for one in participants for name, of in one.alone.items()}
    for reader in participants:
        reads = reads_of(reader)
        for index, entry in enumerate(reader.config.config.EDDIInputs):
            for topic in dict.fromkeys(topic for topic, _ in reads.get(entry.id, ())):
                if topic in alone:
                    publisher, field = alone[topic]
                    text = f"input {entry.id!r} gains from silence by {topic}: a value alone does"
                    text += " not show whether anything is known"
                    hint = f"read {field}, on the topic of the whole message of {publisher.name}"
                    yield error("D001", text, reader.config.place("EDDIInputs", index), hint)


def check_types(deployment: Deployment) -> Iterator[Problem]:
    """Report topics that monitors read, or read and publish, with different types (D019)."""
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
                message = f"{topic} has the type {type_} for {name}, and {source.type} here"
                hint = "a topic has one type; is one of the two names wrong?"
                place = member.config.place("SimulatorOutputs", index, "topic")
                yield warning("D019", message, place, hint)


def check_spellings(deployment: Deployment) -> Iterator[Problem]:
    """Report messages of ours that are read, and whose fields get other names (G026)."""
    respelt = {
        name
        for one in deployment.members
        for name in one.monitor.kind.respelt(one.config.config.Model.model_extra or {})
    }
    for one in deployment.members:
        for index, source in enumerate(one.config.config.SimulatorOutputs):
            package, _, name = source.type.partition("/")
            if package == MESSAGE_PACKAGE and name in respelt:
                place = one.config.place("SimulatorOutputs", index, "type")
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
    message = f"{one.name} and {two.name} publish the same topic {topic}"
    hint = "give each a topic of its own"
    if one.namespace != two.namespace:
        relative = second.publication.output.topic.removeprefix("/")
        message = f"two robots share {topic}: {message}"
        hint = f"write {relative}, relative to the namespace of each robot"
    return error("D005", message, second.publication.place, hint)


def _shared_with_others(deployment: Deployment) -> Iterator[Problem]:
    """Report topics that a package which is there publishes as well."""
    first: dict[str, tuple[Participant, Place]] = {}
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
            message = (
                f"{one.name} and the package {other.package} that is there publish the same "
                f"topic {topic}"
            )
            hint = "give each a topic of its own"
            if one.package in new:
                hint += (
                    f"; if the model has a new name, add `--rename {other.package}={one.package}`"
                )
            hint += "; else remove the package that is of no use"
            # No error: nodes may be started in namespaces of their own, or not at all.
            yield warning("D005", message, place, hint)


def _absent(deployment: Deployment, member: Member) -> Iterator[Problem]:
    config = member.config
    required = {name for one in config.config.EDDIInputs for name in one.requires}
    required |= {one.id for binding in member.monitor.inputs for one in binding.requires}
    for index, source in enumerate(config.config.SimulatorOutputs):
        topic = member.topic(source.topic)
        if source.id not in required or kind_of_message(source.type) is None or source.peers:
            continue
        if not (deployment.publisher(member, source) or deployment.other(member, source)):
            of = "these files and packages" if deployment.others else "these files"
            message = f"{topic} is published by none of {of}, so what it depends on is not checked"
            place = config.place("SimulatorOutputs", index, "topic")
            hint = "check it together with the configuration and the model of its publisher"
            alike = _alike(deployment, member, topic, source.type)
            if alike is not None:
                hint = f"{alike} Else {hint}"
            yield warning("D006", message, place, hint)


def _alike(deployment: Deployment, member: Member, topic: str, type_: str) -> str | None:
    """Return the hint at a topic of nearly this name that another member publishes."""
    known = {
        at: one.member.name
        for at, found in deployment.publishers.items()
        for one in found
        if one.publication.type == type_ and one.member is not member
    }
    near = nearest(topic, known)
    return f"did you mean {near} ({known[near]})?" if near is not None else None
