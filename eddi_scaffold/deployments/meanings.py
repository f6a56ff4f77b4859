"""Check that each field that is read of a monitor's message rests only on what is known."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Any

from eddi_scaffold.common.claims import Holds, Meaning, Meanings, Use, ValidityField
from eddi_scaffold.common.identifiers import attribute
from eddi_scaffold.common.problems import Place, Problem, problem
from eddi_scaffold.conditions.uses import uses
from eddi_scaffold.config.field_paths import (
    Attribute,
    ByKey,
    FieldPath,
    Index,
    parse_field,
    pattern,
)
from eddi_scaffold.config.schema import SimulatorOutput
from eddi_scaffold.deployments.support import Deployment, WiredMonitor
from eddi_scaffold.monitors.binding import BoundMonitor
from eddi_scaffold.monitors.expressions import EXPRESSION_KEYS, head_of, path_behind
from eddi_scaffold.monitors.input_binding import InputBinding
from eddi_scaffold.monitors.input_rules import kind_of_message
from eddi_scaffold.monitors.publications import STATUS

Field = tuple[SimulatorOutput, FieldPath]


@dataclass(frozen=True)
class FieldReading:
    """One use of one field."""

    input: str  # id
    text: str  # the field, as a person writes it
    place: Place  # its place in the configuration
    source: SimulatorOutput  # the message
    path: FieldPath  # into the message
    holds: Holds  # which values bring a claim of the monitor nearer
    # further fields, with tests that hold as well when the claim is made this way
    companions: tuple[tuple[Field, Holds], ...] = ()
    is_three_valued: bool = False  # what is not known counts as UNKNOWN, not as a value


class Readings:
    """What the inputs of a monitor read, and what for; no hand-written code is among it."""

    def __init__(self, monitor: BoundMonitor | None) -> None:
        assert monitor is not None
        assert monitor.config is not None
        self._config, form = monitor.config, monitor.config.config
        self._by_id = {binding.model.id: binding for binding in monitor.inputs}
        self._by_attribute = {binding.attribute: binding for binding in monitor.inputs}
        self._entries = {entry.id: (index, entry) for index, entry in enumerate(form.EDDIInputs)}
        self._sources = {attribute(source.id): source for source in form.SimulatorOutputs}
        # inputs with `polarity: HAZARD` whose being true, and so silence, brings a claim nearer
        self.inverted: dict[str, None] = {}
        fields = [
            replace(use, is_three_valued=input_.model.is_three_valued)
            for input_ in monitor.inputs
            for use in self._of(input_, input_.model.uses)
        ]
        self.fields = tuple(dict.fromkeys(fields))

    def _of(self, binding: InputBinding, used: Sequence[Use]) -> Iterator[FieldReading]:
        """Yield what an input reads when it is used in some ways."""
        id_ = binding.model.id
        if id_ not in self._entries or not used:
            return
        if binding.computed is not None:
            yield from self._computed(binding, used)
        elif (path := self._field(binding)) is not None:
            field, place = self._entries[id_][1].field, self._place(binding, "field", "requires")
            text = field or ".".join(step.name for step in path if isinstance(step, Attribute))
            for source in binding.requires:
                for use in used:
                    companions = tuple(self._companions(use))
                    yield FieldReading(id_, text, place, source, path, use.holds, companions)

    def _computed(self, binding: InputBinding, used: Sequence[Use]) -> Iterator[FieldReading]:
        document: Any = binding.computed
        if document["polarity"] == "HAZARD" and any(use.holds(True) for use in used):
            self.inverted[binding.model.id] = None
        results = [True]  # a state counts where it is true, a number is used as a whole
        if document["type"] == "bool":
            results = [value for value in (True, False) if any(use.holds(value) for use in used)]
        for part in document["parts"]:
            program = part["program"]
            (output,) = program.results
            for result in results:
                for name, uses_of_name in uses(program, output.operation, side=result).items():
                    yield from self._named(binding, name, uses_of_name)

    def _named(
        self, binding: InputBinding, name: str, used: Sequence[Use]
    ) -> Iterator[FieldReading]:
        """Yield what an expression reads by a name: of a message, or of another input."""
        source = self._sources.get(head_of(name))
        if source is None:
            if (other := self._by_attribute.get(head_of(name))) is not None:
                yield from self._of(other, used)
            return
        id_, place = binding.model.id, self._place(binding, *EXPRESSION_KEYS)
        for use in used:
            companions = tuple(
                ((self._sources[head_of(other)], path_behind(other)), holds)
                for other, holds in use.companions
                if head_of(other) in self._sources
            )
            yield FieldReading(id_, name, place, source, path_behind(name), use.holds, companions)

    def _companions(self, use: Use) -> Iterator[tuple[Field, Holds]]:
        """Yield the fields of the other inputs that a use of one input names."""
        for id_, holds in use.companions:
            other = self._by_id.get(id_)
            if other is None or other.computed is not None or len(other.requires) != 1:
                continue
            if (path := self._field(other)) is not None:
                yield (other.requires[0], path), holds

    def _field(self, binding: InputBinding) -> FieldPath | None:
        """Return the path that an input takes from its message, ``None`` when a person does."""
        _, entry = self._entries[binding.model.id]
        if not binding.is_given:
            return None
        if entry.field is not None:
            return parse_field(entry.field)
        fields = binding.known_fields or {}
        known = [name for argument in binding.arguments for name in fields.get(argument, ())]
        return (Attribute(known[0]),) if len(known) == 1 else None

    def _place(self, binding: InputBinding, *keys: str) -> Place:
        index, entry = self._entries[binding.model.id]
        key = next((key for key in keys if getattr(entry, key) is not None), "id")
        return self._config.place("EDDIInputs", index, key)


def check_meanings(deployment: Deployment) -> Iterator[Problem]:
    """Report what gains from silence, or fulfils no demand: D001, D002, D004, D007."""
    for member in deployment.members:
        readings, config = Readings(member.bound), member.config
        ids = [entry.id for entry in config.config.EDDIInputs]
        for input_ in readings.inverted:
            place = config.place("EDDIInputs", ids.index(input_), "polarity")
            yield problem("D002.hazard", place, input=input_)
        problems: dict[tuple[object, ...], Problem] = {}
        for reading in readings.fields:
            reports = [
                *_judge(deployment, member, reading),
                *_unfulfilled(deployment, member, reading),
            ]
            for reported in reports:
                problems.setdefault((reported.code, reported.message, reported.place), reported)
        yield from problems.values()


def _unfulfilled(
    deployment: Deployment, member: WiredMonitor, reading: FieldReading
) -> Iterator[Problem]:
    publisher, output = deployment.publisher(member, reading.source) or (None, None)
    path = (output.path or reading.path) if output is not None else ()
    key = next((str(step.key) for step in path if isinstance(step, ByKey)), None)
    provider, user = publisher.bound if publisher is not None else None, member.bound
    if provider is None or user is None or key is None:
        return
    reason = provider.model.why_not_fulfilled(key, user.model, reading.input)
    if reason is not None:
        yield problem("D004.unfulfilled", reading.place, input=reading.input, reason=reason)


def _judge(
    deployment: Deployment, member: WiredMonitor, reading: FieldReading
) -> Iterator[Problem]:
    field = _message_field(deployment, member, (reading.source, reading.path))
    if field is None:
        return
    if any(isinstance(step, Index) for step in field.path):
        yield problem("D007.by_place", reading.place, reading=reading.text)
    meaning, names = field.meaning, {"input": reading.input, "reading": reading.text}
    if reading.is_three_valued and meaning.known:
        return  # the value is UNKNOWN where the message says so
    name = f"{attribute(reading.source.id)}{''.join(pattern(reading.path))}"
    if meaning.silent is not None and not any(reading.holds(value) for value in meaning.silent):
        if meaning.bad is not None and list(map(reading.holds, meaning.bad)) == [True, False]:
            bad = meaning.bad[1]
            yield problem("D002.good_while_hazard", reading.place, name=name, bad=bad, **names)
        return

    def is_ensured(validity: ValidityField) -> bool:
        """Return whether an accompanying test ensures that the field has a meaning."""
        for companion, holds in reading.companions:
            if holds(validity.value) and not holds(not validity.value):
                other = _message_field(deployment, member, companion)
                if other is not None and other.is_at(field.publisher, validity):
                    return True
        return False

    if not any(map(is_ensured, meaning.valid_where)):
        hint = f"read {meaning.instead.format(field=name)}" if meaning.instead else None
        yield problem("D001.gains", reading.place, hint=hint, refused=meaning.refused, **names)


@dataclass(frozen=True)
class _MessageField:
    """A field of a message of ours that is read."""

    publisher: object  # the monitor, or the topic where it is not at hand
    message: str  # that the field is in
    path: FieldPath  # into that message
    meanings: Meanings  # what its fields mean

    @property
    def meaning(self) -> Meaning:
        """What it means, or what the smallest field around it that has a meaning does."""
        fields, steps = self.meanings.get(self.message, {}), pattern(self.path)
        names = ("".join(steps[:end]).removeprefix(".") for end in range(len(steps), 0, -1))
        return next((fields[name] for name in names if name in fields), Meaning())

    def is_at(self, publisher: object, validity: ValidityField) -> bool:
        """Return whether it is a certain field of a publisher."""
        own = (self.publisher, self.message, "".join(pattern(self.path)))
        return own == (publisher, validity.message, f".{validity.field}")


def _message_field(
    deployment: Deployment, member: WiredMonitor, field: Field
) -> _MessageField | None:
    """Return which field of a monitor's message is read, ``None`` for other messages."""
    source, path = field
    kind, message = kind_of_message(source.type), source.type.partition("/")[2]
    if kind is None:
        return None
    for monitor, output in filter(None, [deployment.publisher(member, source)]):
        if monitor.kind is kind:
            return _MessageField(monitor.name, message, path, monitor.meanings(output.part))
    topic = member.topic(source.topic).removesuffix(f"/{STATUS}")
    return _MessageField(topic, message, path, kind.model_class.meanings(None))
