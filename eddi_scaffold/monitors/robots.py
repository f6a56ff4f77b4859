"""A monitor among other robots: what they tell each other, and whose word it relies on."""

from __future__ import annotations

from collections.abc import Container, Iterable, Iterator, Mapping
from typing import Any

from eddi_scaffold.common.escaping import python_literal
from eddi_scaffold.common.identifiers import attribute, full_topic
from eddi_scaffold.common.problems import Problem, error
from eddi_scaffold.compiling.program.instructions import BUFFERED, STARTS
from eddi_scaffold.config.field_paths import Attribute, ByKey, parse_field
from eddi_scaffold.config.file import ConfigFile
from eddi_scaffold.config.schema import FleetSection, SimulatorOutput
from eddi_scaffold.kinds import JsonValue, Kind, Model
from eddi_scaffold.monitors.binding import BoundMonitor
from eddi_scaffold.monitors.expression_names import head_of, path_behind
from eddi_scaffold.monitors.expressions import EXPRESSION_KEYS

MESSAGE = "eddi_messages/RobotGuarantees"
_PERIODS = 3
"""A word is an answer to one of ours: it is as old as our period, theirs, and the way."""

_OUTLIVING = frozenset((*BUFFERED, *STARTS, "once", "age"))
"""Operations that may claim something when what they claim it of has gone."""


def fleet_message(kind: Kind[Model]) -> str | None:
    """Return the message type by which monitors of a kind tell other robots what they guarantee."""
    return MESSAGE if MESSAGE.partition("/")[2] in kind.between_robots else None


def check_fleet(monitor: BoundMonitor, config: ConfigFile) -> Iterator[Problem]:
    """Find what does not fit among robots: K080 to K083.

    Args:
        monitor: any.
        config: how it is connected.
    """
    fleet = config.config.Fleet
    if fleet is not None:
        yield from _check_section(fleet, monitor.kind, config)
    yield from _check_memory(monitor, config)
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
    yield from _check_guarantees(monitor, config)


def _check_guarantees(monitor: BoundMonitor, config: ConfigFile) -> Iterator[Problem]:
    """Find inputs whose value is not that of the guarantee by which their word is chosen (K081)."""
    wanted = {s.id: s.peers.guarantee for s in config.config.SimulatorOutputs if s.peers}
    by_name = {attribute(id_): guarantee for id_, guarantee in wanted.items()}
    bound = {input_.model.id: input_ for input_ in monitor.inputs}
    for index, entry in enumerate(config.config.EDDIInputs):
        names_read = bound[entry.id].reads
        if names_read is not None:
            key = next(key for key in EXPRESSION_KEYS if getattr(entry, key) is not None)
            names = [name for name in names_read if head_of(name) in by_name]
            reads = [(path_behind(name), by_name[head_of(name)]) for name in names]
        else:
            key, path = "field", parse_field(entry.field) if entry.field is not None else ()
            reads = [(path, wanted[name]) for name in entry.requires if name in wanted]
        for path, guarantee in dict.fromkeys(reads):
            if path[:1] == (Attribute("guarantees"),) and not (
                len(path) > 1 and isinstance(path[1], ByKey) and path[1].wanted == guarantee
            ):
                text = (
                    f"the word is chosen by its guarantee {guarantee!r}, and {entry.id!r} reads "
                    "another one of it"
                )
                hint = f"write guarantees[{guarantee}].active, or another `guarantee` in `peers:`"
                yield error("K081", text, config.place("EDDIInputs", index, key), hint)


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


def _check_memory(monitor: BoundMonitor, config: ConfigFile) -> Iterator[Problem]:
    """Find words that would count for longer than their lease, and in circles for ever (K083)."""
    fed = {input_.model.id for input_ in monitor.inputs if any(s.peers for s in input_.requires)}
    if not fed:
        return
    if any(claim.hold_s > 0.0 for claim in monitor.facts.claims):
        text = "a filter by majority lets words of other robots count after their lease"
        hint = "`filter: {kind: debounce, regain_after: n}` is late only where something is gained"
        yield error("K083", text, config.place("Model", "filter"), hint)
    sources = {entry.id for entry in config.config.SimulatorOutputs if entry.peers}
    words = {attribute(one) for one in (*sources, *fed)}
    index = {entry.id: k for k, entry in enumerate(config.config.EDDIInputs)}
    for input_ in monitor.inputs:
        remembering = _remembering(input_.computed or {}, words)
        if remembering is not None:
            text = (
                f"{remembering.upper()} lets {input_.model.id!r} rest on the word of another robot "
                "after its lease"
            )
            hint = "read the word as it is now; `TIME` is late only where something is gained"
            yield error("K083", text, config.place("EDDIInputs", index[input_.model.id]), hint)


def _remembering(computed: Mapping[str, Any], words: Container[str]) -> str | None:
    """Return the operation of an expression that outlives a word, ``None`` where none does."""
    for part in computed.get("parts", ()):
        form = part["form"]
        of_words: list[bool] = []
        for node in form["nodes"]:
            if node["op"] in ("variable", "age"):
                name = form["variables"][node["value"]]["name"]
                of_words.append(head_of(name) in words)
            else:
                of_words.append(any(of_words[arg] for arg in node.get("args", ())))
            if of_words[-1] and node["op"] in _OUTLIVING:
                return str(node["op"])
    return None


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
    return "(" + " ".join(f"{python_literal(name)}," for name in names) + ")"
