"""How one input of a model gets its value: from messages, by an expression, or by hand."""

from __future__ import annotations

import math
import re
from collections.abc import Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace

from eddi_scaffold.common import units
from eddi_scaffold.common.identifiers import attribute, full_topic
from eddi_scaffold.common.problems import Place, Problem, problem
from eddi_scaffold.config import field_paths
from eddi_scaffold.config.field_types import Fields, MessageFields, python_type
from eddi_scaffold.config.file import ConfigFile
from eddi_scaffold.config.schema import InputEntry, SimulatorOutput
from eddi_scaffold.kinds import JsonValue, ModelInput
from eddi_scaffold.monitors.compiling import names_read
from eddi_scaffold.monitors.expressions import (
    EXPRESSION_KEYS,
    CheckedExpression,
    ExpressionBinder,
    head_of,
    path_behind,
)
from eddi_scaffold.monitors.input_rules import kind_of_message, taken
from eddi_scaffold.monitors.message_types import installed_message
from eddi_scaffold.monitors.message_types.documented import documented_at
from eddi_scaffold.program.input_expressions import BoundInput

_PYTHON_TYPES: Mapping[str, type | tuple[type, ...]] = {
    "bool": bool,
    "float": (int, float),
    "int": int,
    "str": str,
    "state": str,
}
_FITTING = {
    "state": ("bool", "int", "str", "float[]"),  # a name, or one likelihood per state
    "float[]": ("float", "int", "float[]"),  # one number is a list of one
    "float": ("float", "int"),
}
"""Type of an input -> those that can fill it, where that are others than the same."""
_PLAIN = frozenset({None, "", *units.RATIO.names})  # Units of a number that has none
_MULTI_ARRAY = re.compile(r"std_msgs/(Byte|(Float|U?Int)[0-9]+)MultiArray")


@dataclass(frozen=True)
class UnwrittenInput(Problem):
    """A problem that ends when a person writes a region."""

    package: str = ""  # of the monitor
    regions: tuple[str, ...] = ()  # ids of the regions, one of which ends it
    # an input and its monitor, for people, where only code by hand can make it of its messages
    by_hand: str = ""


@dataclass(frozen=True)
class InputBinding:
    """One input of the model, joined with its entry in the configuration."""

    model: ModelInput
    attribute: str
    # the simulator outputs it is made of; one of its own id without a configuration
    requires: tuple[SimulatorOutput, ...] = ()
    arguments: tuple[str, ...] = ()  # a Python name for each of them
    # Python expression over the arguments that gives the value, `None` when a person must write it
    expression: str | None = None
    # seconds, `"none"` (never stale, on purpose) or `None` (never, by default)
    max_age: float | str | None = None
    default: bool | int | float | str | None = None  # value before the first message
    # exact factor from the configured unit to the model's, or `None`
    factor: tuple[int, int] | None = None
    unit: str | None = None
    renamed_from: str | None = None
    # argument -> its fields, for the messages that are known
    known_fields: Mapping[str, Sequence[str]] | None = None
    computed: Mapping[str, JsonValue] | None = None  # what `expression:` computes, for the runtime
    text: str = ""  # of it, or the field, for people
    reads: tuple[str, ...] | None = None  # names of fields and inputs that it reads
    # claims of other monitors that it reads: a simulator output, and the id of the claim, empty for
    # that which the message names
    claims: tuple[tuple[str, str], ...] = ()

    @property
    def is_given(self) -> bool:
        """Whether the value comes without hand-written code."""
        return self.expression is not None or self.computed is not None

    @property
    def regions(self) -> tuple[str, ...]:
        """The id of its region, and the one before where it was renamed."""
        names = filter(None, (self.model.id, self.renamed_from))
        return tuple(f"process_{attribute(name)}" for name in names)

    def compiled(self, package: str) -> BoundInput:
        """Return what is compiled of it, for a package."""
        topics = {
            source.id: full_topic(source.topic, "", package)
            for source in self.requires
            if source.topic
        }
        return BoundInput(
            self.model.id,
            self.attribute,
            tuple(source.id for source in self.requires),
            self.max_age,
            self.factor,
            self.default,
            self.model.every_message,
            self.computed,
            topics=topics,
            claims=self.claims,
        )

    def by_value(self, topic: str = "") -> InputBinding:
        """Return it where the value itself is given, in place of messages."""
        name = self.model.id
        source = SimulatorOutput.model_construct(id=name, type="", topic=topic, max_age=None)
        direct = replace(self, requires=(source,), arguments=(self.attribute,))
        return replace(direct, expression=self.attribute, computed=None, reads=None)


class InputBinder:
    """Joins one input of the model with one entry of ``EDDIInputs``."""

    def __init__(
        self,
        item: ModelInput,
        entry: InputEntry,
        index: int,
        config: ConfigFile,
        known: MessageFields,
        types: Mapping[str, str],
    ) -> None:
        self.item, self.entry, self.index, self.config = item, entry, index, config
        self.problems: list[Problem] = []
        self.known, self.types = known, types
        sources = {source.id: source for source in reversed(config.config.SimulatorOutputs)}
        self.requires = tuple(sources[name] for name in dict.fromkeys(entry.requires))
        self.arguments = tuple(attribute(source.id) for source in self.requires)
        self.fields = {
            name: known[source.type]
            for name, source in zip(self.arguments, self.requires, strict=True)
            if source.type in known
        }

    def bind(self) -> tuple[InputBinding, list[Problem]]:
        """Return the joined input and what does not fit."""
        entry, item = self.entry, self.item
        computed = self._computed()
        if len(set(self.arguments)) != len(self.arguments):
            names = ", ".join(self.arguments)
            self._report("K015.sources", "requires", input=entry.id, names=names)
        types = {entry.type, item.type}
        if entry.type not in (None, item.type) and not types <= {"int", "float"}:
            self._report("K016.type", "type", input=entry.id, expected=item.type, actual=entry.type)
        factor = self._factor()
        self._check_default(factor)
        # one that is to be computed and has no expression has an error
        is_field = computed is None and not entry.is_computed
        reads = names_read(computed.document) if computed is not None else None
        binding = InputBinding(
            item,
            item.attribute or attribute(item.id),
            self.requires,
            self.arguments,
            self._expression() if is_field else None,
            self._max_age(),
            entry.default,
            factor,
            entry.unit if factor is not None else item.unit,
            entry.renamed_from,
            {name: tuple(fields) for name, fields in self.fields.items()},
            text=entry.field or "",
            reads=reads,
            claims=tuple(self._claims(reads)),
        )
        if computed is not None:
            binding = replace(binding, computed=computed.document, text=computed.text)
        return binding, self.problems

    def _claims(self, reads: Sequence[str] | None) -> Iterator[tuple[str, str]]:
        """Yield the claims of other monitors that it reads, by itself or in code by hand."""
        entry = self.entry
        for name, source in zip(self.arguments, self.requires, strict=True):
            kind = kind_of_message(source.type)
            where = kind.claim.field if kind is not None and kind.claim is not None else None
            if source.peers is not None:
                yield source.id, source.peers.guarantee
            elif where is not None and "{" not in where:  # each message is about one
                yield source.id, ""
            elif where == "{}":  # a kind with but one
                yield source.id, "in_scope"
            elif where is not None:
                paths = [path_behind(read) for read in reads or () if head_of(read) == name]
                if entry.field is not None:
                    with suppress(field_paths.FieldPathError):  # which is told
                        paths.append(field_paths.parse_field(entry.field))
                keys = [path[1] for path in paths if len(path) > 1]
                ids = [str(key.key) for key in keys if isinstance(key, field_paths.ByKey)]
                yield from ((source.id, id_) for id_ in dict.fromkeys(ids))

    def _place(self, *key: str) -> Place:
        return self.config.place("EDDIInputs", self.index, *key)

    def _report(self, case: str, *key: str, hint: str | None = None, **fields: object) -> None:
        self.problems.append(problem(case, self._place(*key), hint=hint, **fields))

    def _computed(self) -> CheckedExpression | None:
        """Check ``expression:`` and its like; what it reads becomes what the input requires."""
        entry = self.entry
        if entry.event is not None and entry.expression_file is None:
            self._report("K003.event_without_file", "event", input=entry.id)
        if not entry.is_computed:
            if entry.polarity == "HAZARD":
                self._report("K003.useless_polarity", "polarity", input=entry.id)
            return None
        if entry.field is not None:
            key = "expression" if entry.expression_file is None else "expression_file"
            self._report("K003.field_and_expression", "field", input=entry.id, key=key)
        types = self.types
        binder = ExpressionBinder(self.item, self.index, self.config, self._fields_of, types)
        checked = binder.bind()
        self.problems += binder.problems
        if checked is not None:
            self._check_unit((checked.unit,) if checked.unit else (), checked.text)
            self.requires = checked.requires
            self.arguments = tuple(attribute(source.id) for source in self.requires)
        return checked

    def _max_age(self) -> float | str | None:
        """Return the age of the entry, else the least that the sources allow.

        The word of a robot has a lease. The limit of a monitor's message is none of a sensor that
        an expression reads beside it.
        """
        if self.entry.max_age is not None:
            return self.entry.max_age
        fleet = self.config.config.Fleet
        lease = fleet.lease if fleet is not None else None
        limits = [lease if source.peers else source.limit for source in self.requires]
        is_written = self.entry.is_computed and None in limits
        ages = [
            source.max_age
            if source.max_age is not None or (is_written and not source.peers)
            else limit
            for source, limit in zip(self.requires, limits, strict=True)
        ]
        numbers = [age for age in ages if isinstance(age, float | int)]
        if numbers:
            return min(numbers)
        limitless = next((age for age in ages if age is not None), None)
        if limitless is None and self.item.safety and self.requires:
            topics = ", ".join(source.topic for source in self.requires)
            self._report("K017.entry", input=self.entry.id, topics=topics)
        return limitless

    def _expression(self) -> str | None:
        """Return the expression of ``field:``, or of the only field where that fits."""
        path = self.entry.field
        if self.item.type == "float[]" and self.requires:
            return self._numbers()
        if len(self.requires) != 1:
            if path is not None:
                number, name = len(self.requires), self.entry.id
                self._report("K019.one_message", "field", input=name, number=number)
            return None
        (argument,), (source,) = self.arguments, self.requires
        if path is None and source.peers and "guarantees" in self.fields.get(argument, ()):
            path = f"guarantees[{source.peers.guarantee}].active"
        if path is not None:
            return self._taken(argument, source.type, path)
        return self._only_field(argument)

    def _numbers(self) -> str | None:
        """Return the expression for a list of numbers, joined where several messages hold it."""
        path = self.entry.field
        parts: list[str | None] = []
        for argument, source in zip(self.arguments, self.requires, strict=True):
            if path in {None, "data"} and _MULTI_ARRAY.fullmatch(source.type):
                parts.append(argument)  # as a whole: its layout defines where its data begin
            elif path is not None:
                parts.append(self._taken(argument, source.type, path))
            else:
                parts.append(self._only_field(argument))
        known = [part for part in parts if part is not None]
        if len(known) < len(parts):
            return None
        return known[0] if len(known) == 1 else f"joined({', '.join(known)})"

    def _only_field(self, argument: str) -> str | None:
        fields = self.fields.get(argument, {})
        names = [name for name, type_ in fields.items() if fits(python_type(type_), self.item.type)]
        return f"{argument}.{names[0]}" if names and len(fields) == 1 else None

    def _taken(self, argument: str, message: str, text: str) -> str | None:
        """Return the expression that takes a field from a message, checked as far as is known."""
        try:
            path = field_paths.parse_field(text)
        except field_paths.FieldPathError as failure:
            self._report("K019.path", "field", hint=failure.hint, reason=failure)
            return None
        try:
            resolved = field_paths.resolve(path, message, self._fields_of)
        except field_paths.FieldPathError as failure:
            first, hint = path[0], failure.hint
            name = first.name if isinstance(first, field_paths.Attribute) else ""
            if path[1:] and name in self.entry.requires:
                hint = f"leave out `{name}.`: the path begins in the message"
            self._report("K020.path", "field", hint=hint, reason=failure)
            return taken(argument, path, message)
        path = resolved.path
        if resolved.type is not None and not fits(resolved.type, self.item.type):
            fields = {"field": self.entry.field, "message": message, "type": resolved.type}
            fields |= {"input": self.item.id, "expected": self.item.type}
            self._report("K038", "field", **fields)
        documented = documented_at(path, message, self._fields_of)
        if documented is not None:
            self._check_unit(documented.units, f"{self.entry.field} of {message}")
        return taken(argument, path, message)

    def _fields_of(self, message: str) -> Fields | None:
        return self.known[message] if message in self.known else installed_message(message)

    def _check_unit(self, stated: Sequence[str], subject: str) -> None:
        """Compare the unit that a value has with the one that the input is declared to have."""
        declared = self.entry.unit if self.entry.unit is not None else self.item.unit
        given_by = next((k for k in ("field", *EXPRESSION_KEYS) if getattr(self.entry, k)), "id")
        if declared is None or self.item.units is None:
            return
        if not units.contradict(stated, declared):
            # Of a fraction nothing may be accepted: the range is meant in percent.
            good, largest = self.item.is_good, units.factor("fraction", self.item.unit or "")
            if tuple(stated) == ("fraction",) and good is not None and largest is not None:
                # a range with a number between two ends has the lower end, or begins in between
                numbers = [number for number in (0.0, *self.item.starts) if 0 <= number <= largest]
                if not any(map(good, numbers)):
                    covered = self.item.covered
                    self._report("K022.percent", given_by, subject=subject, covered=covered)
            return
        key = "unit" if self.entry.unit is not None else given_by
        fields = {"subject": subject, "actual": " or ".join(stated), "input": self.entry.id}
        fields["expected"] = declared or "a ratio"
        for unit in stated:
            if (exact := units.factor(unit, declared)) is not None:
                times = f"1 {unit} is {float(exact):g} {declared or 'of a ratio'}"
                self._report("K022.unit", key, unit=unit, conversion=times, **fields)
                return
        self._report("K022.apart", key, reason=units.apart(stated[0], declared), **fields)

    def _factor(self) -> tuple[int, int] | None:
        configured, of_model = self.entry.unit, self.item.unit
        if configured is None or configured == (of_model or "") or {configured, of_model} <= _PLAIN:
            return None
        if self.item.type not in {"float", "int"}:
            self._report("K016.unit_of_other", "unit", input=self.entry.id)
            return None
        factor = (self.item.units or {}).get(configured)
        if factor is None:
            names = [unit or '""' for unit in self.item.units or {}]
            hint = f"units that can be: {', '.join(names)}"
            expected = of_model or "a ratio"
            self._report("K022.conversion", "unit", hint=hint, actual=configured, expected=expected)
            return None
        return None if factor[0] == factor[1] else factor

    def _check_default(self, factor: tuple[int, int] | None) -> None:
        value, item = self.entry.default, self.item
        if value is None:
            return
        finite = not isinstance(value, float) or math.isfinite(value)
        is_of_type = finite and isinstance(value, _PYTHON_TYPES.get(item.type, ()))
        if not is_of_type or (item.type != "bool" and isinstance(value, bool)):
            self._report("K016.default", "default", input=item.id, value=value, type=item.type)
            return
        if factor is not None and isinstance(value, int | float):
            value = value * factor[0] / factor[1]
        if item.is_good is not None and item.is_good(value) and not self.entry.allow_unsafe_default:
            self._report("K024", "default", default=self.entry.default, input=item.id)


def fits(type_: str, expected: str) -> bool:
    """Return whether a field of one Python type can fill an input."""
    return type_ in _FITTING.get(expected, (expected,))
