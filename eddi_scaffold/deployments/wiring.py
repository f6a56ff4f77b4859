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
from eddi_scaffold.deployments.meanings import Readings, check_meanings
from eddi_scaffold.deployments.support import (
    WiredMonitor,
    check_acceptances,
    check_rings,
    supports,
    wired,
)
from eddi_scaffold.deployments.topics import (
    Deployment,
    check_alone,
    check_spellings,
    check_topics,
    check_types,
)
from eddi_scaffold.monitors.binding import BoundMonitor
from eddi_scaffold.monitors.publications import STATUS


def check_composition(deployment: Deployment) -> Iterator[Problem]:
    """Report demands that are wired to a guarantee which does not fulfil them (D004)."""
    for member in deployment.members:
        user = member.bound
        assert user is not None
        seen: set[tuple[str, str]] = set()
        for reading in Readings(user).fields:
            publisher = deployment.publisher(member, reading.source)
            if publisher is None:
                continue
            path = publisher.publication.path or reading.path
            output = next((str(step.key) for step in path if isinstance(step, ByKey)), None)
            if output is None or (reading.input, output) in seen:
                continue
            seen.add((reading.input, output))
            provider = publisher.member.bound
            assert provider is not None
            reason = provider.model.why_not_fulfilled(output, user.model, reading.input)
            if reason is not None:
                yield problem("D004.unfulfilled", reading.place, input=reading.input, reason=reason)


def check_hidden(participants: Sequence[WiredMonitor]) -> Iterator[Problem]:
    """Report what is told to other robots and rests by topics on a statement of a robot (D003)."""
    relying = {claim: monitor for monitor in participants for claim in monitor.claims_on_statements}
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


_LESS_THAN = {
    ("reliability", "reliable"): "best_effort",
    ("durability", "transient_local"): "volatile",
}
"""What a reader may ask for -> what does not fulfil it."""


def check_qualities(participants: Sequence[WiredMonitor]) -> Iterator[Problem]:
    """Report topics of which a monitor asks for more than another one offers (D016)."""
    written: dict[str, list[tuple[WiredMonitor, OutputEntry]]] = {}
    for writer in participants:
        for output in writer.config.config.EDDIOutputs:
            topic = writer.topic(output.topic)
            for at in (topic, f"{topic}/{STATUS}")[: 2 if output.field is None else 1]:
                written.setdefault(at, []).append((writer, output))
    for reader in participants:
        for index, source in enumerate(reader.config.config.SimulatorOutputs):
            topic = reader.topic(source.topic)
            for writer, output in written.get(topic, ()):
                for name, asked in _lacking(source.qos, output.qos):
                    yield problem(
                        "D016",
                        reader.config.place("SimulatorOutputs", index, "qos"),
                        message=f"{reader.name} asks for {name} {asked} of {topic}, which",
                        actual=f"{writer.name} publishes {getattr(output.qos, name)}",
                        nothing=f"on ROS 2 it would get nothing: without `{name}`",
                        writer=writer.name,
                        asked=asked,
                    )


def _lacking(asked: InputQos, offered: InputQos) -> Iterator[tuple[str, str]]:
    """Yield what is asked for in vain; nodes read reliably what was kept."""
    if asked.durability == "transient_local" and asked.reliability is None:
        asked = asked.model_copy(update={"reliability": "reliable"})
    for (name, quality), less in _LESS_THAN.items():
        if getattr(asked, name) == quality and getattr(offered, name) == less:
            yield name, quality


def check_wiring(
    members: Sequence[WiredMonitor], others: Sequence[WiredMonitor] = ()
) -> list[Problem]:
    """Check what monitors read of each other (D001 to D009 but D006 and D008, D016)."""
    together = Deployment(members, others)
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
        *([] if rings else check_acceptances(members)),
    ]


def members_of(monitors: Sequence[BoundMonitor]) -> list[WiredMonitor]:
    """Return the monitors that are wired at all: those with a configuration."""
    return [wired(monitor) for monitor in monitors if monitor.config is not None]
