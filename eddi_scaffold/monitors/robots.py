"""A monitor among other robots: what they tell each other, and whose word it relies on."""

from __future__ import annotations

from collections.abc import Container, Iterable, Iterator, Mapping
from functools import partial
from typing import Any

from eddi_scaffold.common.escaping import python_literal
from eddi_scaffold.common.identifiers import attribute, full_topic
from eddi_scaffold.common.problems import Problem, problem
from eddi_scaffold.config.field_paths import Attribute, ByKey, parse_field
from eddi_scaffold.config.file import ConfigFile
from eddi_scaffold.config.schema import FleetSection, SimulatorOutput
from eddi_scaffold.kinds import JsonValue, Kind
from eddi_scaffold.monitors.binding import BoundMonitor
from eddi_scaffold.monitors.expressions import EXPRESSION_KEYS, head_of, path_behind
from eddi_scaffold.program.instructions import BUFFERED, STARTS, Program

MESSAGE = "eddi_messages/RobotGuarantees"
_PERIODS = 3  # A word is an answer to one of ours: it is as old as our period, theirs, and the way

_OUTLIVING = frozenset((*BUFFERED, *STARTS, "once", "age"))
"""Operations that may claim something when what they claim it of has gone."""


def fleet_message(kind: Kind) -> str | None:
    """Return the message type by which monitors of a kind tell other robots what they guarantee."""
    return MESSAGE if MESSAGE.partition("/")[2] in kind.between_robots else None


def check_fleet(monitor: BoundMonitor, config: ConfigFile) -> Iterator[Problem]:
    """Find what does not fit among robots: K029, K080, K081, K083."""
    fleet, frequency = config.config.Fleet, config.config.Model.frequency
    if fleet is not None:
        if fleet_message(monitor.kind) is None:
            place = config.place("Fleet")
            yield problem("K080.guarantees_nothing", place, kind=monitor.kind.title)
        least, place = _PERIODS / frequency, config.place("Fleet", "lease")
        if fleet.lease < least:
            lease = fleet.lease
            yield problem("K029.lease", place, lease=lease, frequency=frequency, longest=least)
    # words that would count for longer than their lease, and in circles for ever
    fed = {input_.model.id for input_ in monitor.inputs if any(s.peers for s in input_.requires)}
    if fed and any(claim.hold_s > 0.0 for claim in monitor.facts.claims):
        yield problem("K083.filter", config.place("Model", "filter"))
    peers = {entry.id for entry in config.config.SimulatorOutputs if entry.peers}
    robot_names = {attribute(id_) for id_ in (*peers, *fed)}
    order = [entry.id for entry in config.config.EDDIInputs]
    for input_ in monitor.inputs if fed else ():
        name, operation = input_.model.id, _remembering(input_.computed or {}, robot_names)
        if operation is not None:
            fields = {"remembering": operation.upper(), "model": name}
            place = config.place("EDDIInputs", order.index(name))
            yield problem("K083.remembering", place, **fields)
    for index, source in enumerate(config.config.SimulatorOutputs):
        at = partial(config.place, "SimulatorOutputs", index)
        if source.peers is None:
            if source.type == MESSAGE:
                yield problem("K081.no_peers", at("type"), source=source.id)
            continue
        if fleet is None:
            yield problem("K080.no_name", at("peers"), source=source.id)
            continue
        if source.type != MESSAGE:
            yield problem("K081.peers_of_other", at("type"), source=source.id, message=MESSAGE)
        if full_topic(source.topic, "", "") != full_topic(fleet.topic, "", ""):
            yield problem("K081.topic", at("topic"), topic=source.topic, fleet_topic=fleet.topic)
        if fleet.robot in source.peers.robots and source.peers.robots != "any":
            yield problem("K080.own_word", at("peers"), robot=fleet.robot)
    # inputs whose value is not that of the guarantee by which their word is chosen
    of_source = {s.id: s.peers.guarantee for s in config.config.SimulatorOutputs if s.peers}
    by_name = {attribute(id_): guarantee for id_, guarantee in of_source.items()}
    bound = {input_.model.id: input_ for input_ in monitor.inputs}
    for index, entry in enumerate(config.config.EDDIInputs):
        names_read = bound[entry.id].reads
        if names_read is not None:
            key = next(key for key in EXPRESSION_KEYS if getattr(entry, key) is not None)
            names = [name for name in names_read if head_of(name) in by_name]
            reads = [(path_behind(name), by_name[head_of(name)]) for name in names]
        else:
            key, path = "field", parse_field(entry.field) if entry.field is not None else ()
            reads = [(path, of_source[name]) for name in entry.requires if name in of_source]
        place = config.place("EDDIInputs", index, key)
        for path, guarantee in dict.fromkeys(reads):
            if path[:1] == (Attribute("guarantees"),) and not (
                len(path) > 1 and isinstance(path[1], ByKey) and path[1].key == guarantee
            ):
                yield problem("K081.other_guarantee", place, guarantee=guarantee, input=entry.id)


def _remembering(computed: Mapping[str, Any], names: Container[str]) -> str | None:
    """Return the operation of an expression that outlives a word, ``None`` where none does."""
    for part in computed.get("parts", ()):
        program: Program = part["program"]
        of_robots: list[bool] = []
        for operation in program.operations:
            is_read = operation.op in ("variable", "age")
            of_robots.append(
                head_of(program.reads[operation.value].name) in names
                if is_read
                else any(of_robots[arg] for arg in operation.args)
            )
            if of_robots[-1] and operation.op in _OUTLIVING:
                return operation.op
    return None


def fleet_answers(
    fleet: FleetSection, message_class: str, sources: Iterable[SimulatorOutput]
) -> dict[str, JsonValue]:
    """Return what the template of a node asks for; each source has ``peers``."""
    return {
        "robot": python_literal(fleet.robot),
        "topic": python_literal(fleet.topic),
        "message_class": message_class,
        "lease": repr(fleet.lease),
        "sources": [
            {
                "id": python_literal(source.id),
                "robots": f"({' '.join(f'{python_literal(name)},' for name in robots)})",
                "model": python_literal(source.peers.model),
                "digest": python_literal(source.peers.digest),
                "guarantee": python_literal(source.peers.guarantee),
            }
            for source in sources
            if source.peers is not None
            for robots in [() if source.peers.robots == "any" else source.peers.robots]
        ],
    }
