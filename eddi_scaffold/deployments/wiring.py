"""Monitors that are wired to each other by topics, and whether what is wired may be relied on.

A monitor by itself takes a missing or old message as unknown. Behind another monitor that is not
enough: its messages go on when its own sources have died. So every field of a monitor's message
that is read must have a meaning only where something is known, each demand must be fulfilled by the
guarantee that it is wired to, and no claim may rest on itself.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from eddi_scaffold.common.graphs import reached
from eddi_scaffold.common.problems import Problem, problem
from eddi_scaffold.deployments.meanings import check_meanings
from eddi_scaffold.deployments.support import (
    Deployment,
    WiredMonitor,
    acceptances,
    check_rings,
    publishers_of,
    supports,
    wired,
)
from eddi_scaffold.monitors.binding import BoundMonitor
from eddi_scaffold.monitors.input_rules import kind_of_message
from eddi_scaffold.monitors.publications import MESSAGE_PACKAGE


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


def check_hidden(participants: Sequence[WiredMonitor]) -> Iterator[Problem]:
    """Report what is told to other robots and rests by topics on a statement of a robot (D003)."""
    relying: dict[str, WiredMonitor] = {}
    for monitor in participants:
        sources = {source.id for source in monitor.config.config.SimulatorOutputs if source.peers}
        fed = {input_.id for input_ in monitor.facts.inputs if sources & set(input_.requires)}
        claims = [claim.id for claim in monitor.facts.claims if fed & claim.rests_on]
        relying |= dict.fromkeys(map(monitor.claim, claims), monitor)
    graph = supports(participants) if relying else {}
    for monitor in participants if relying else ():
        fleet = monitor.config.config.Fleet
        if fleet is None or fleet.closed:  # nobody relies on it whose circles were not looked for
            continue
        for claim in map(monitor.claim, monitor.claims):
            behind = reached(graph, [claim])
            hidden = (name for name, of in relying.items() if name in behind and of is not monitor)
            if (name := next(hidden, None)) is not None:
                place, names = monitor.config.place("Fleet"), {"monitor": name}
                yield problem("D003.hidden_circle", place, claim=claim, name=monitor.name, **names)
                break


def check_wiring(
    members: Sequence[WiredMonitor], others: Sequence[WiredMonitor] = ()
) -> list[Problem]:
    """Check what monitors read of each other (D001 to D009 but D006 and D008)."""
    together = Deployment(members, others)
    rings = list(check_rings(together.participants))
    accepted = [] if rings else acceptances(members)
    return [
        *check_meanings(together),
        *check_alone(together),
        *check_topics(together),
        *check_types(together),
        *check_spellings(together),
        *rings,
        *([] if rings else check_hidden(together.participants)),
        *(problem("D009", of.place, reason=of.as_text()) for of in accepted),
    ]


def members_of(monitors: Sequence[BoundMonitor]) -> list[WiredMonitor]:
    """Return the monitors that are wired at all: those with a configuration."""
    return [wired(monitor) for monitor in monitors if monitor.config is not None]
