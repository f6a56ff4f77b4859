"""Topics of a deployment: two publishers of one, and publishers that are not among the files."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from eddi_scaffold.deployments.wiring.deployment import (
    Deployment,
    Member,
    Publisher,
    kind_of_message,
)
from eddi_scaffold.monitors.publications import MESSAGE_PACKAGE, publications, read_respelt
from eddi_scaffold.problems import Problem, error, warning


def check_topics(deployment: Deployment) -> Iterator[Problem]:
    """Report topics that two monitors publish (D005)."""
    for topic, found in deployment.publishers.items():
        publishers = [one for one in found if one.publication.of == "" or one.publication.path]
        for other in publishers[1:]:
            if other.member is not publishers[0].member:
                yield _shared(topic, publishers[0], other)


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
    """Warn of topics with messages of ours that no member publishes (D006)."""
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


def _absent(deployment: Deployment, member: Member) -> Iterator[Problem]:
    config = member.config
    required = {name for one in config.config.EDDIInputs for name in one.requires}
    required |= {one.id for binding in member.monitor.inputs for one in binding.requires}
    for index, source in enumerate(config.config.SimulatorOutputs):
        topic = member.topic(source.topic)
        if source.id not in required or kind_of_message(source.type) is None or source.peers:
            continue
        if deployment.publisher(member, source) is None:
            message = (
                f"{topic} is published by none of these files, so what it depends on is not checked"
            )
            place = config.place("SimulatorOutputs", index, "topic")
            hint = "check it together with the configuration and the model of its publisher"
            yield warning("D006", message, place, hint)
