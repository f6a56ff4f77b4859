"""Quality of service on topics between monitors: a reader must not ask for more than it is given.

On ROS 2 such a reader gets nothing. What is usual fits: results are reliable and kept for who comes
later, evidence is read as it comes.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from eddi_scaffold.config.schema import InputQos, OutputEntry
from eddi_scaffold.deployments.wiring.support import Participant
from eddi_scaffold.monitors.publications import STATUS
from eddi_scaffold.problems import Problem, error

_LESS_THAN = {
    ("reliability", "reliable"): "best_effort",
    ("durability", "transient_local"): "volatile",
}
"""What a reader may ask for -> what does not fulfil it."""


def check_qualities(participants: Sequence[Participant]) -> Iterator[Problem]:
    """Report topics of which a monitor asks for more than another one offers (D016)."""
    written = [
        (topic, one, output)
        for one in participants
        for output in one.config.config.EDDIOutputs
        for topic in _topics(one, output)
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
                    hint = f"{nothing} {writer.name} publishes {asked}"
                    yield error("D016", f"{message} {given}", place, hint)


def _topics(one: Participant, output: OutputEntry) -> Iterator[str]:
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
