"""A monitor among other robots: what they tell each other, and whose word it relies on."""

from __future__ import annotations

from collections.abc import Iterable, Iterator

from eddi_scaffold.config.file import ConfigFile
from eddi_scaffold.config.schema import FleetSection, SimulatorOutput
from eddi_scaffold.escaping import python_literal
from eddi_scaffold.identifiers import full_topic
from eddi_scaffold.kinds import JsonValue, Kind, Model
from eddi_scaffold.problems import Problem, error

MESSAGE = "eddi_messages/RobotGuarantees"
_PERIODS = 3
"""A word is an answer to one of ours: it is as old as our period, theirs, and the way."""


def fleet_message(kind: Kind[Model]) -> str | None:
    """Return the message type by which monitors of a kind tell other robots what they guarantee."""
    return MESSAGE if MESSAGE.partition("/")[2] in kind.between_robots else None


def check_fleet(kind: Kind[Model], config: ConfigFile) -> Iterator[Problem]:
    """Find what does not fit among robots: K080 to K082.

    Args:
        kind: of the monitor.
        config: how it is connected.
    """
    fleet = config.config.Fleet
    if fleet is not None:
        yield from _check_section(fleet, kind, config)
    for index, source in enumerate(config.config.SimulatorOutputs):
        place = config.place("SimulatorOutputs", index, "peers")
        if source.peers is None:
            if source.type == MESSAGE:
                text = f"{source.id!r} is the word of another robot, and nothing says of which"
                hint = "write `peers:` with `robots`, `model`, `digest` and `guarantee`"
                yield error("K081", text, config.place("SimulatorOutputs", index, "type"), hint)
            continue
        if fleet is None:
            text = f"{source.id!r} is the word of another robot, and this one has no name"
            yield error("K080", text, place, "write a section `Fleet:` with `robot: NAME`")
            continue
        if source.type != MESSAGE:
            text = f"{source.id!r} has `peers:`, which only messages of type {MESSAGE} have"
            yield error("K081", text, config.place("SimulatorOutputs", index, "type"))
        if full_topic(source.topic, "", "") != full_topic(fleet.topic, "", ""):
            text = f"{source.topic} is not the topic of the fleet, {fleet.topic}"
            yield error("K081", text, config.place("SimulatorOutputs", index, "topic"))
        if fleet.robot in source.peers.robots and source.peers.robots != "any":
            text = f"the robot {fleet.robot!r} would rely on its own word"
            yield error("K080", text, place, "read the topic of that monitor, or name other robots")


def _check_section(fleet: FleetSection, kind: Kind[Model], config: ConfigFile) -> Iterator[Problem]:
    if fleet_message(kind) is None:
        text = f"a {kind.title} guarantees nothing that other robots could rely on"
        yield error(
            "K080", text, config.place("Fleet"), "give the section to a ConSert of the robot"
        )
    least = _PERIODS / config.config.Model.frequency
    if fleet.lease < least:
        text = (
            f"a lease of {fleet.lease:g} s ends before an answer comes: at"
            f" {config.config.Model.frequency:g} steps per second it takes up to {least:g} s"
        )
        yield error("K082", text, config.place("Fleet", "lease"), "a longer lease, or more steps")


def fleet_answers(
    fleet: FleetSection, message_class: str, sources: Iterable[SimulatorOutput]
) -> dict[str, JsonValue]:
    """Return what the template of a node asks for.

    Args:
        fleet: the section of the configuration.
        message_class: name of the class of ``MESSAGE``.
        sources: those that an input requires, each with ``peers``.
    """
    return {
        "robot": python_literal(fleet.robot),
        "topic": python_literal(fleet.topic),
        "message_class": message_class,
        "lease": repr(fleet.lease),
        "sources": [
            {
                "id": python_literal(source.id),
                "robots": _tuple(() if source.peers.robots == "any" else source.peers.robots),
                "model": python_literal(source.peers.model),
                "digest": python_literal(source.peers.digest),
                "guarantee": python_literal(source.peers.guarantee),
            }
            for source in sources
            if source.peers is not None
        ],
    }


def _tuple(names: Iterable[str]) -> str:
    return "(" + " ".join(f"{python_literal(one)}," for one in names) + ")"
