"""What is played: monitors of files, of packages, of robots, all alike, joined by topics."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any, NamedTuple, cast, get_args

from eddi_runtime.peers import Fleet, Source

from eddi_scaffold.common.files import Source as File
from eddi_scaffold.common.identifiers import full_topic
from eddi_scaffold.common.problems import EddiError, Problem, problem
from eddi_scaffold.config.field_types import python_type
from eddi_scaffold.kinds import InputType
from eddi_scaffold.monitors.binding import BoundMonitor, known_types
from eddi_scaffold.monitors.input_binding import InputBinding, fits
from eddi_scaffold.monitors.message_types import known_messages
from eddi_scaffold.monitors.robots import fleet_message
from eddi_scaffold.recordings.csv_recording import Recording, header_of, read_rows, recording_of
from eddi_scaffold.recordings.node import Message, Publications, blank


@dataclass(frozen=True)
class Code:
    """The code of a package, which has been loaded."""

    folder: Path  # as it was named
    by_hand: frozenset[str]  # ids of the inputs that hand-written lines make of their messages
    new: Callable[[], tuple[Any, Any]]  # makes an `EDDIMonitor` and an `EDDIInput`


@dataclass(frozen=True)
class Member:
    """One of the monitors that are played together."""

    monitor: BoundMonitor
    namespace: str = ""  # of its robot, such as `/robot1`
    code: Code | None = None  # what runs in place of the generated lines
    # id of an input that is given its value -> column of a CSV file
    columns: Mapping[str, str] = field(default_factory=dict)

    @property
    def name(self) -> str:
        """Its name, for people and in columns."""
        return f"{self.namespace}/{self.monitor.id}".lstrip("/")

    @property
    def bindings(self) -> list[InputBinding]:
        """How its inputs get their values here."""
        return [
            binding.by_value(self.columns[binding.model.id])
            if binding.model.id in self.columns
            else binding
            for binding in self.monitor.inputs
        ]

    @property
    def unknown_without_code(self) -> list[str]:
        """Its inputs that only code of a person can give, where none runs."""
        return [
            f"{self.name}.{binding.model.id}"
            for binding in (self.bindings if self.code is None else ())
            if binding.requires and not binding.is_given
        ]

    @property
    def publications(self) -> Publications | None:
        """What it publishes; nothing without a configuration."""
        return None if self.monitor.config is None else Publications(self.monitor, self.namespace)

    @property
    def fleet(self) -> Fleet | None:
        """The robots among which it is one."""
        config = self.monitor.config.config if self.monitor.config is not None else None
        if config is None or config.Fleet is None or fleet_message(self.monitor.kind) is None:
            return None
        used = {source.id: source for of in self.monitor.inputs for source in of.requires}
        sources = tuple(
            Source(id_, () if of.robots == "any" else of.robots, of.model, of.digest, of.guarantee)
            for id_, source in used.items()
            if (of := source.peers) is not None
        )
        return Fleet(config.Fleet.robot, config.Fleet.topic, None, config.Fleet.lease, sources)

    def is_by_hand(self, binding: InputBinding) -> bool:
        """Return whether lines of a person make an input of its messages here."""
        return self.code is not None and binding.model.id in self.code.by_hand

    def topic(self, name: str) -> str:
        """Return the full name of a topic of its node, as it is in a bag."""
        return full_topic(name, self.namespace, self.monitor.package)

    def topics(self, binding: InputBinding) -> list[str]:
        """Return the topics that an input is made of."""
        return [self.topic(source.topic) for source in binding.requires if source.type]

    def message_of(self, message_type: str) -> _OneValue | None:
        """Return how a message is made of the one value in it; ``None``: there are several."""
        fields = known_types(self.monitor.config, known_messages()).get(message_type, {})
        names = [name for name in fields if name != "layout"]  # of a MultiArray
        types = [python_type(fields[name]) for name in names]
        if len(names) != 1 or types[0] not in get_args(InputType):
            return None
        return _OneValue(message_type, names[0], cast("InputType", types[0]))

    def message_for(self, binding: InputBinding) -> Callable[[Any], Any] | None:
        """Return what makes the one message of an input's value, ``None`` where that cannot be."""
        if len(binding.requires) != 1:
            return None
        if not binding.requires[0].type:  # a plain package: the value itself
            return lambda value: value
        made = self.message_of(binding.requires[0].type)
        return made.message if made and fits(made.value_type, binding.model.type) else None


class _OneValue(NamedTuple):
    message_type: str
    field: str
    value_type: InputType

    def message(self, value: Any) -> Message:
        empty = vars(blank(self.message_type)) if self.message_type in known_messages() else {}
        return Message(**{**empty, "message_type": self.message_type, self.field: value})


def published(members: Sequence[Member]) -> frozenset[str]:
    """Return the topics of members that are not taken from a recording.

    Of one alone, none; the words of robots are where there are several robots.
    """
    if len(members) < 2:
        return frozenset()
    robots: dict[str, set[str]] = {}
    for fleet in (member.fleet for member in members):
        if fleet is not None:
            robots.setdefault(fleet.topic, set()).add(fleet.robot)
    words = frozenset(topic for topic, names in robots.items() if len(names) > 1)
    return words.union(*(of.topics for member in members if (of := member.publications)))


def read_values(
    file: File, members: Sequence[Member]
) -> tuple[list[Member], Recording, list[Problem]]:
    """Read a CSV file for members.

    A column is called by an input, by an input of a member (``monitor.input``), or by a topic: its
    messages are made of the values. What another member publishes needs none.

    Returns:
        The members with their columns, the recording, and warnings.

    Raises:
        EddiError: inputs of one name are not the same in two monitors (G000), or a problem of the
            file is an error (I001, I003, I006).
    """
    members = _with_columns(members, header_of(file))
    types: dict[str, InputType] = {}
    topics: dict[str, _OneValue] = {}
    unreached: dict[str, None] = {}  # inputs
    shared = published(members)
    pairs = [(member, of) for member in members for of in member.monitor.inputs]
    for member, binding in pairs:
        if (column := member.columns.get(binding.model.id)) is not None:
            types[column] = binding.model.type
            if member.is_by_hand(binding) and member.message_for(binding) is None:
                unreached[f"{member.name}.{binding.model.id}"] = None
            continue
        for source in binding.requires:
            topic, made = member.topic(source.topic), member.message_of(source.type)
            if made is not None and topic not in shared:
                topics[topic], types[topic] = made, made.value_type
            elif topic not in shared:
                unreached[f"{member.name}.{binding.model.id}"] = None
    rows, problems = read_rows(file, types)
    if rows is None:
        raise EddiError(*problems)
    recording = recording_of(rows)
    samples = (
        replace(s, message=topics[s.topic].message(s.message)) if s.topic in topics else s
        for s in recording.samples
    )
    if unreached:
        problems.append(problem("I001.bodies", inputs=", ".join(unreached)))
    return members, replace(recording, samples=tuple(samples)), problems


def _with_columns(members: Sequence[Member], header: Sequence[str]) -> list[Member]:
    shared = published(members)
    owners: dict[str, tuple[str, object]] = {}
    result: list[Member] = []
    for member in members:
        columns = {}
        for binding in member.monitor.inputs:
            id_, topics = binding.model.id, member.topics(binding)
            is_received = bool(topics) and shared.issuperset(topics)
            if is_received and (binding.is_given or member.code is not None):
                continue
            if not set(header).isdisjoint(topics):
                continue
            columns[id_] = f"{member.name}.{id_}"
            computed = (binding.expression, binding.text)
            meaning = (binding.model.type, binding.unit, computed, topics)
            first, same = owners.setdefault(id_, (member.name, meaning))
            if columns[id_] not in header and same == meaning:
                columns[id_] = id_
            elif columns[id_] not in header and id_ in header:
                raise EddiError(problem("G000.one_column", id=id_, first=first, second=member.name))
        result.append(replace(member, columns=columns))
    return result
