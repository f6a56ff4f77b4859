"""Check that each field that is read of a monitor's message rests only on what is known."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any

from eddi_scaffold.common.claims import Holds, Meaning, Meanings, Use, ValidityField
from eddi_scaffold.common.identifiers import attribute
from eddi_scaffold.common.problems import Place, Problem, problem
from eddi_scaffold.conditions.uses import uses
from eddi_scaffold.config.field_paths import Attribute, FieldPath, Index, parse_field, pattern
from eddi_scaffold.config.file import ConfigFile
from eddi_scaffold.config.schema import SimulatorOutput
from eddi_scaffold.deployments.topics import Deployment, Member
from eddi_scaffold.monitors.binding import BoundMonitor
from eddi_scaffold.monitors.expression_names import head_of, path_behind
from eddi_scaffold.monitors.expressions import EXPRESSION_KEYS
from eddi_scaffold.monitors.input_binding import InputBinding
from eddi_scaffold.monitors.input_rules import kind_of_message
from eddi_scaffold.monitors.publications import STATUS

Field = tuple[SimulatorOutput, FieldPath]


@dataclass(frozen=True)
class FieldReading:
    """One use of one field.

    Attributes:
        input: id.
        text: the field, as a person writes it.
        place: its place in the configuration.
        source: the message.
        path: into the message.
        holds: which values bring a claim of the monitor nearer.
        beside: further fields, with tests that hold as well when the claim is made this way.
    """

    input: str
    text: str
    place: Place
    source: SimulatorOutput
    path: FieldPath
    holds: Holds
    beside: tuple[tuple[Field, Holds], ...] = ()


@dataclass(frozen=True)
class Readings:
    """What a monitor reads; what a person writes by hand is not among it.

    Attributes:
        fields: every use of every field.
        inverted: inputs with ``polarity: HAZARD`` whose being true brings a claim nearer, so that
            silence does.
    """

    fields: Sequence[FieldReading]
    inverted: Sequence[str]


def readings(monitor: BoundMonitor) -> Readings:
    """Return what the inputs of a monitor read, and what for."""
    assert monitor.config is not None
    reader = _Reader(monitor, monitor.config)
    found = [one for binding in monitor.inputs for one in reader.of(binding, binding.model.uses)]
    return Readings(tuple(dict.fromkeys(found)), tuple(reader.inverted))


class _Reader:
    def __init__(self, monitor: BoundMonitor, config: ConfigFile) -> None:
        self.inverted: dict[str, None] = {}
        self._config = config
        self._bindings = {binding.attribute: binding for binding in monitor.inputs}
        self._entries = {entry.id: k for k, entry in enumerate(config.config.EDDIInputs)}
        self._sources = {attribute(entry.id): entry for entry in config.config.SimulatorOutputs}

    def of(self, binding: InputBinding, used: Sequence[Use]) -> Iterator[FieldReading]:
        """Yield what an input reads when it is used in some ways."""
        if binding.model.id not in self._entries or not used:
            return
        if binding.computed is not None:
            yield from self._computed(binding, used)
            return
        path = self._field(binding)
        if path is None:
            return
        entry = self._config.config.EDDIInputs[self._entries[binding.model.id]]
        key = "field" if entry.field is not None else "requires"
        for source in binding.requires:
            for use in used:
                beside = tuple(self._beside(use))
                shown = entry.field or ".".join(s.name for s in path if isinstance(s, Attribute))
                place = self._place(binding, key)
                yield FieldReading(binding.model.id, shown, place, source, path, use.holds, beside)

    def _computed(self, binding: InputBinding, used: Sequence[Use]) -> Iterator[FieldReading]:
        document: Any = binding.computed
        if document["polarity"] == "HAZARD" and any(use.holds(True) for use in used):
            self.inverted[binding.model.id] = None
        for part in document["parts"]:
            program = part["program"]
            (result,) = program.results
            for wanted in _sides(document["type"], used):
                for name, found in uses(program, result.operation, wanted=wanted).items():
                    yield from self._named(binding, name, found)

    def _named(
        self, binding: InputBinding, name: str, found: Sequence[Use]
    ) -> Iterator[FieldReading]:
        head = head_of(name)
        if head not in self._sources:
            other = self._bindings.get(head)
            if other is not None:
                yield from self.of(other, found)
            return
        source, path = self._sources[head], path_behind(name)
        place = self._place(binding, *EXPRESSION_KEYS)
        for use in found:
            beside = tuple(
                ((self._sources[head_of(other)], path_behind(other)), holds)
                for other, holds in use.beside
                if head_of(other) in self._sources
            )
            yield FieldReading(binding.model.id, name, place, source, path, use.holds, beside)

    def _beside(self, use: Use) -> Iterator[tuple[Field, Holds]]:
        """Yield the fields of the other inputs that a use of one input names."""
        for name, holds in use.beside:
            other = next((b for b in self._bindings.values() if b.model.id == name), None)
            path = self._field(other) if other is not None and other.computed is None else None
            if other is not None and path is not None and len(other.requires) == 1:
                yield (other.requires[0], path), holds

    def _field(self, binding: InputBinding) -> FieldPath | None:
        """Return the path that an input takes from its message, ``None`` when a person does."""
        entry = self._config.config.EDDIInputs[self._entries[binding.model.id]]
        if not binding.is_given:
            return None
        if entry.field is not None:
            return parse_field(entry.field)
        fields = binding.known_fields or {}
        known = [name for argument in binding.arguments for name in fields.get(argument, ())]
        return (Attribute(known[0]),) if len(known) == 1 else None

    def _place(self, binding: InputBinding, *keys: str) -> Place:
        index = self._entries[binding.model.id]
        entry = self._config.config.EDDIInputs[index]
        key = next((key for key in keys if getattr(entry, key) is not None), "id")
        return self._config.place("EDDIInputs", index, key)


def _sides(type_: str, used: Sequence[Use]) -> Sequence[bool]:
    """Return which results of an expression bring a claim nearer."""
    if type_ != "bool":  # a state counts where it is true, a number is used as a whole
        return (True,)
    return [side for side in (True, False) if any(use.holds(side) for use in used)]


_UNLISTED = Meaning()


def check_meanings(deployment: Deployment) -> Iterator[Problem]:
    """Report what gains from silence: D001, D002, D007."""
    for member in deployment.members:
        found = readings(member.monitor)
        for input_ in found.inverted:
            yield _inverted(member, input_)
        seen: set[tuple[object, ...]] = set()
        for reading in found.fields:
            for reported in _judge(deployment, member, reading):
                key = (reported.code, reported.message, reported.place)
                if key not in seen:
                    yield reported
                seen.add(key)


def _inverted(member: Member, input_: str) -> Problem:
    ids = [entry.id for entry in member.config.config.EDDIInputs]
    place = member.config.place("EDDIInputs", ids.index(input_), "polarity")
    return problem("D002.hazard", place, input=input_)


def _judge(deployment: Deployment, member: Member, reading: FieldReading) -> Iterator[Problem]:
    found = _read(deployment, member, (reading.source, reading.path))
    if found is None:
        return
    if any(isinstance(step, Index) for step in found.path):
        yield problem("D007.by_place", reading.place, reading=reading.text)
    meaning = _meaning(found)
    name = f"{attribute(reading.source.id)}{''.join(pattern(reading.path))}"
    if meaning.silent is not None and not any(reading.holds(value) for value in meaning.silent):
        if meaning.bad is not None and list(map(reading.holds, meaning.bad)) == [True, False]:
            yield problem(
                "D002.good_while_hazard",
                reading.place,
                input=reading.input,
                reading=reading.text,
                name=name,
                bad=meaning.bad[1],
            )
        return
    hint = f"read {meaning.instead.format(field=name)}" if meaning.instead else None
    if not any(_is_given(deployment, member, reading, one, found) for one in meaning.given):
        yield problem(
            "D001.gains",
            reading.place,
            hint=hint,
            input=reading.input,
            reading=reading.text,
            refused=meaning.refused,
        )


@dataclass(frozen=True)
class _Read:
    """A field of a message of ours that is read.

    Attributes:
        publisher: the monitor, or the topic where it is not at hand.
        message: that the field is in.
        path: into that message.
        meanings: what its fields mean.
    """

    publisher: object
    message: str
    path: FieldPath
    meanings: Meanings


def _read(deployment: Deployment, member: Member, field: Field) -> _Read | None:
    """Return which field of a monitor's message is read, ``None`` for other messages."""
    source, path = field
    publisher = deployment.publisher(member, source)
    kind, message = kind_of_message(source.type), source.type.partition("/")[2]
    if kind is None:
        return None
    if publisher is not None:
        one, of = publisher.publication, publisher.member.participant
        meanings = of.meanings(one.output.event)
        return _Read(of.name, message, path, meanings)
    other = deployment.other(member, source)
    if other is not None and other.of.kind is kind:
        return _Read(other.of.name, message, path, other.of.meanings(other.part))
    topic = member.topic(source.topic).removesuffix(f"/{STATUS}")
    return _Read(topic, message, path, kind.model_class.meanings(None))


def _meaning(read: _Read) -> Meaning:
    """Return what a field means, or what the nearest field around it does."""
    fields = read.meanings.get(read.message, {})
    steps = pattern(read.path)
    for end in range(len(steps), 0, -1):
        name = "".join(steps[:end]).removeprefix(".")
        if name in fields:
            return fields[name]
    return _UNLISTED


def _is_given(
    deployment: Deployment, member: Member, reading: FieldReading, given: ValidityField, of: _Read
) -> bool:
    """Return whether an accompanying test ensures that a field has a meaning."""
    for field, holds in reading.beside:
        if not holds(given.value) or holds(not given.value):
            continue
        found = _read(deployment, member, field)
        if found is not None and _is_at(found, of.publisher, given):
            return True
    return False


def _is_at(read: _Read, publisher: object, given: ValidityField) -> bool:
    field = "".join(pattern(read.path))
    return (read.publisher, read.message, field) == (publisher, given.message, f".{given.field}")
