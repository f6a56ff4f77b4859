"""What the inputs of a monitor read: which field of which message, and what for."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any

from eddi_scaffold.claims import Holds, Use
from eddi_scaffold.config.fields import Attribute, FieldPath, parse_field
from eddi_scaffold.config.file import ConfigFile
from eddi_scaffold.config.schema import SimulatorOutput
from eddi_scaffold.identifiers import attribute
from eddi_scaffold.language.uses import uses
from eddi_scaffold.monitors.binding import BoundMonitor, InputBinding
from eddi_scaffold.monitors.expression_names import head_of, path_behind
from eddi_scaffold.monitors.expressions import EXPRESSION_KEYS
from eddi_scaffold.problems import Place

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
        self._entries = {one.id: k for k, one in enumerate(config.config.EDDIInputs)}
        self._sources = {attribute(one.id): one for one in config.config.SimulatorOutputs}

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
            form = part["form"]
            (output,) = form["outputs"]
            for wanted in _sides(document["type"], used):
                for name, found in uses(form, output["node"], wanted=wanted).items():
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
