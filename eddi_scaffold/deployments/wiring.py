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
from eddi_scaffold.config.field_paths import ByKey
from eddi_scaffold.config.schema import InputQos, OutputEntry
from eddi_scaffold.deployments.meanings import FieldReading, check_meanings, readings
from eddi_scaffold.deployments.support import WiredMonitor, check_acceptances, check_rings, supports
from eddi_scaffold.deployments.topics import (
    Deployment,
    Member,
    Publisher,
    check_alone,
    check_spellings,
    check_topics,
    check_types,
    deployment,
)
from eddi_scaffold.monitors.binding import BoundMonitor
from eddi_scaffold.monitors.publications import STATUS


def check_composition(deployment: Deployment) -> Iterator[Problem]:
    """Report demands that are wired to a guarantee which does not fulfil them (D004)."""
    for member in deployment.members:
        user = member.monitor
        seen: set[tuple[str, str]] = set()
        for reading in readings(user).fields:
            publisher = deployment.publisher(member, reading.source)
            output = None if publisher is None else _output(publisher, reading)
            if publisher is None or output is None or (reading.input, output) in seen:
                continue
            seen.add((reading.input, output))
            provider = publisher.member.monitor
            reason = provider.model.why_not_fulfilled(output, user.model, reading.input)
            if reason is not None:
                yield problem("D004.unfulfilled", reading.place, input=reading.input, reason=reason)


def _output(publisher: Publisher, reading: FieldReading) -> str | None:
    """Return the id of the output that a field names."""
    path = publisher.publication.path or reading.path
    return next((str(step.wanted) for step in path if isinstance(step, ByKey)), None)


def check_hidden(participants: Sequence[WiredMonitor]) -> Iterator[Problem]:
    """Report what is told to other robots and rests by topics on a word of one (D003).

    Args:
        participants: the monitors that read each other's topics.
    """
    telling = [participant for participant in participants if _tells(participant)]
    relying = {claim: participant for participant in participants for claim in participant.by_words}
    if not telling or not relying:
        return
    graph = supports(participants)
    for one in telling:
        for output in one.claims:
            claim = one.claim(output)
            behind = reached(graph, [claim])
            hidden = next((c for c, of in relying.items() if c in behind and of is not one), None)
            if hidden is not None:
                yield _hidden(one, claim, hidden)
                break


def _tells(one: WiredMonitor) -> bool:
    """Return whether other robots may rely on a monitor, among which nobody looked for circles."""
    fleet = one.config.config.Fleet
    return fleet is not None and not fleet.closed


def _hidden(one: WiredMonitor, claim: str, hidden: str) -> Problem:
    return problem(
        "D003.hidden_circle", one.config.place("Fleet"), claim=claim, monitor=hidden, name=one.name
    )


_LESS_THAN = {
    ("reliability", "reliable"): "best_effort",
    ("durability", "transient_local"): "volatile",
}
"""What a reader may ask for -> what does not fulfil it."""


def check_qualities(participants: Sequence[WiredMonitor]) -> Iterator[Problem]:
    """Report topics of which a monitor asks for more than another one offers (D016)."""
    written = [
        (topic, participant, output)
        for participant in participants
        for output in participant.config.config.EDDIOutputs
        for topic in _topics(participant, output)
    ]
    for reader in participants:
        for index, source in enumerate(reader.config.config.SimulatorOutputs):
            topic = reader.topic(source.topic)
            for at, writer, output in written:
                for name, asked in _lacking(source.qos, output.qos) if at == topic else ():
                    message = f"{reader.name} asks for {name} {asked} of {topic}, which"
                    given = f"{writer.name} publishes {getattr(output.qos, name)}"
                    place = reader.config.place("SimulatorOutputs", index, "qos")
                    nothing = f"on ROS 2 it would get nothing: without `{name}`"
                    yield problem(
                        "D016",
                        place,
                        message=message,
                        actual=given,
                        nothing=nothing,
                        writer=writer.name,
                        asked=asked,
                    )


def _topics(one: WiredMonitor, output: OutputEntry) -> Iterator[str]:
    """Yield the full names of the topics that have the quality of an output."""
    topic = one.topic(output.topic)
    yield topic
    if output.field is None:
        yield f"{topic}/{STATUS}"


def _lacking(asked: InputQos, offered: InputQos) -> Iterator[tuple[str, str]]:
    """Yield what is asked for in vain; nodes read reliably what was kept."""
    if asked.durability == "transient_local" and asked.reliability is None:
        asked = asked.model_copy(update={"reliability": "reliable"})
    for (name, wanted), less in _LESS_THAN.items():
        if getattr(asked, name) == wanted and getattr(offered, name) == less:
            yield name, wanted


def check_wiring(members: Sequence[Member], others: Sequence[WiredMonitor] = ()) -> list[Problem]:
    """Check what monitors read of each other (D001 to D009 but D006 and D008, D016).

    Args:
        members: the monitors that are at hand.
        others: those that run with them.
    """
    together = deployment(members, others)
    rings = list(check_rings(together.participants))
    return [
        *check_meanings(together),
        *check_alone(together.participants),
        *check_composition(together),
        *check_topics(together),
        *check_types(together),
        *check_spellings(together),
        *check_qualities(together.participants),
        *rings,
        *([] if rings else check_hidden(together.participants)),
        *([] if rings else check_acceptances([member.participant for member in members])),
    ]


def members_of(monitors: Sequence[BoundMonitor]) -> list[Member]:
    """Return the monitors that are wired at all: those with a configuration."""
    return [Member(monitor) for monitor in monitors if monitor.config is not None]
