"""A model joined with its configuration: what a monitor listens to, and how it gets its inputs.

What does not fit is a problem with the place in the configuration.
"""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace

from eddi_scaffold.common import units
from eddi_scaffold.common.claims import Acceptance
from eddi_scaffold.common.identifiers import attribute, full_topic, package_name
from eddi_scaffold.common.problems import (
    EddiError,
    Place,
    Problem,
    SimilarNames,
    has_errors,
    problem,
)
from eddi_scaffold.config import field_paths
from eddi_scaffold.config.field_paths import documented_at, resolve
from eddi_scaffold.config.file import ConfigFile, options_of
from eddi_scaffold.config.message_types import (
    EITHER_TIMES,
    Fields,
    MessageFields,
    declared,
    element,
    is_primitive,
    known_messages,
    python_type,
)
from eddi_scaffold.config.message_types.installed import installed_message
from eddi_scaffold.config.schema import USUAL_FREQUENCY, InputEntry, SimulatorOutput
from eddi_scaffold.config.topic_types import check_types
from eddi_scaffold.kinds import EditableMethod, JsonValue, Kind, Model, ModelInput
from eddi_scaffold.monitors import input_rules
from eddi_scaffold.monitors.compiling import CompiledModule, compile_monitor, names_read
from eddi_scaffold.monitors.expression_names import KeyPaths
from eddi_scaffold.monitors.expressions import EXPRESSION_KEYS, CheckedExpression, bind_expression
from eddi_scaffold.monitors.facts import MonitorFacts
from eddi_scaffold.monitors.input_rules import taken
from eddi_scaffold.program.input_expressions import BoundInput

_PYTHON_TYPES: dict[str, type | tuple[type, ...]] = {
    "bool": bool,
    "float": (int, float),
    "int": int,
    "str": str,
    "state": str,
}


_PLAIN = frozenset({None, "", *units.RATIO.names})
"""Units of a number that has none."""
_MULTI_ARRAY = re.compile(r"std_msgs/(Byte|(Float|U?Int)[0-9]+)MultiArray")


@dataclass(frozen=True)
class UnwrittenInput(Problem):
    """A problem that ends when a person writes a region.

    Attributes:
        package: of the monitor.
        regions: ids of the regions, one of which ends it.
    """

    package: str = ""
    regions: tuple[str, ...] = ()


@dataclass(frozen=True)
class InputBinding:
    """One input of the model, joined with its entry in the configuration.

    Attributes:
        model: the input as the model has it.
        attribute: name in ``EDDIInput``.
        requires: the simulator outputs it is made of; one of its own id without a configuration.
        arguments: a Python name for each of them.
        expression: Python expression over the arguments that gives the value, ``None`` when a
            person must write it.
        max_age: seconds, ``"none"`` (never stale, on purpose) or ``None`` (never, by default).
        default: value before the first message.
        factor: exact factor from the configured unit to the model's, or ``None``.
        unit: unit in which the value is given.
        renamed_from: former id.
        known_fields: argument -> its fields, for the messages that are known.
        computed: what ``expression:`` computes, for the runtime.
        computed_text: the same for people.
        reads: names of fields and inputs that it reads.
        key_paths: simulator output -> name in ``expression:`` with keys in brackets -> its path.
    """

    model: ModelInput
    attribute: str
    requires: tuple[SimulatorOutput, ...] = ()
    arguments: tuple[str, ...] = ()
    expression: str | None = None
    max_age: float | str | None = None
    default: bool | int | float | str | None = None
    factor: tuple[int, int] | None = None
    unit: str | None = None
    renamed_from: str | None = None
    known_fields: Mapping[str, Sequence[str]] | None = None
    computed: Mapping[str, JsonValue] | None = None
    computed_text: str = ""
    key_paths: KeyPaths = field(default_factory=dict)
    reads: tuple[str, ...] | None = None

    @property
    def is_given(self) -> bool:
        """Whether the value comes without hand-written code."""
        return self.expression is not None or self.computed is not None

    @property
    def regions(self) -> tuple[str, ...]:
        """The id of its region, and the one before where it was renamed."""
        names = filter(None, (self.model.id, self.renamed_from))
        return tuple(f"process_{attribute(name)}" for name in names)


@dataclass(frozen=True)
class BoundMonitor:
    """Everything a platform needs to know of one monitor.

    Attributes:
        package: name of its package.
        model: the model, configured.
        compiled: the model as it runs.
        facts: what others need to know of it.
        default_guarantees: marks that were given when the model was read.
        cross_check: how the compiled model compares with an independent tool, one sentence.
    """

    package: str
    model: Model
    kind: Kind
    config: ConfigFile | None
    inputs: tuple[InputBinding, ...]
    compiled: CompiledModule
    facts: MonitorFacts
    default_guarantees: tuple[str, ...] = ()
    cross_check: str = ""

    @property
    def id(self) -> str:
        """The id in its configuration, else the name of its model: for people."""
        return self.config.config.Model.id if self.config is not None else self.model.name

    @property
    def needed_methods(self) -> list[EditableMethod]:
        """The methods of its kind that only a person can write."""
        modules = self.model.editable_modules()
        return [method for module in modules for method in module.methods if method.is_needed]

    def topic(self, name: str) -> str:
        """Return the full name of a topic of its node, as it is in a bag."""
        return full_topic(name, "", self.package)


def monitor_of(
    model: Model,
    kind: Kind,
    config: ConfigFile | None,
    marks: Sequence[str] = (),
) -> tuple[BoundMonitor | None, list[Problem]]:
    """Join a checked model with its configuration.

    Args:
        model: what is monitored.
        kind: the kind of the model.
        config: how it is connected, if it is.
        marks: the default guarantees that were marked when the model was read; remembered.

    Returns:
        The monitor, ``None`` when a problem is an error, and all problems of the join.
    """
    configured, problems = model.configure(options_of(config))
    if configured is None and not kind.inputs_of_model:
        return None, problems  # what the inputs are is not known
    model = configured or model
    known = known_types(config, {**known_messages(), **EITHER_TIMES})  # a platform binds again
    bindings, found = bind_inputs(model, kind, config, known)
    problems = [*problems, *found]
    if config is not None:
        used = {source.id for binding in bindings for source in binding.requires}
        problems += check_types(config, used)
        problems += _check_model_section(model, kind, config)
    problems += _repeated_attributes(bindings)
    if configured is None or has_errors(problems):
        return None, problems
    place = config.place("Model") if config is not None else model.place
    frequency = config.config.Model.frequency if config is not None else USUAL_FREQUENCY
    entries = config.config.EDDIInputs if config is not None else ()
    inputs = {binding.model.id: _bound_input(binding) for binding in bindings}
    accepted: list[Acceptance] = []
    for index, entry in enumerate(entries):
        found_here = [*input_rules.of_input(entry, inputs[entry.id], index)]
        inputs[entry.id] = replace(inputs[entry.id], accepts=input_rules.keys(found_here))
        accepted += found_here
    try:
        compiled, facts = compile_monitor(
            model, kind, tuple(inputs.values()), accepted, frequency, place
        )
    except EddiError as refused:
        return None, [*problems, *refused.problems]
    own = model.file_stem or model.name
    package = package_name(config.config.Model.id if config is not None else own)
    joined = (package, model, kind, config, tuple(bindings), compiled, facts, tuple(marks))
    return BoundMonitor(*joined), problems


def known_types(config: ConfigFile | None, known: MessageFields) -> MessageFields:
    """Return all known types, and those that a configuration declares itself; its word counts."""
    given = config.config.MessageTypes if config is not None else {}
    own = {
        name: declared(((of, field) for field, of in field_paths.items()), name.partition("/")[0])
        for name, field_paths in given.items()
    }
    return {**known, **own}


def bound_to(monitor: BoundMonitor, known: MessageFields) -> tuple[BoundMonitor, list[Problem]]:
    """Return a monitor with the fields of a platform: one that another has may be missing.

    Args:
        monitor: as it was read.
        known: type -> its fields.
    """
    inputs, problems = bind_inputs(monitor.model, monitor.kind, monitor.config, known)
    errors = [
        problem for problem in problems if problem.level == "error"
    ]  # the rest was told before
    return replace(monitor, inputs=tuple(inputs)), errors


def _bound_input(binding: InputBinding) -> BoundInput:
    return BoundInput(
        binding.model.id,
        binding.attribute,
        tuple(source.id for source in binding.requires),
        binding.max_age,
        binding.factor,
        binding.default,
        binding.model.every_message,
        binding.computed,
    )


def _check_model_section(model: Model, kind: Kind, config: ConfigFile) -> Iterable[Problem]:
    section = config.config.Model
    if section.type.casefold() not in {name.casefold() for name in kind.config_types}:
        yield problem(
            "K010.kind", config.place("Model", "type"), kind=kind.title, declared=section.type
        )
    if section.id != model.name and package_name(section.id) == package_name(model.name):
        yield problem(
            "K012.spelling",
            config.place("Model", "id"),
            id=section.id,
            original=model.name,
            source=model.source.name,
        )
    elif package_name(section.id) != package_name(model.name):
        yield problem("K012.package", config.place("Model", "id"), id=section.id, model=model.name)


def bind_inputs(
    model: Model, kind: Kind, config: ConfigFile | None, known: MessageFields
) -> tuple[list[InputBinding], list[Problem]]:
    """Return how each input of a configured model gets its value, and what does not fit.

    Args:
        model: what is monitored.
        kind: of the model.
        config: how it is connected, if it is.
        known: the types of messages.
    """
    inputs = model.inputs()
    if config is None:
        return [_unconfigured(item) for item in inputs], []
    problems: list[Problem] = []
    left = {item.id: item for item in inputs}
    types = {item.id: item.type for item in inputs}
    bindings: list[InputBinding] = []
    near = SimilarNames([item.id for item in inputs], "the inputs are")
    for index, entry in enumerate(config.config.EDDIInputs):
        item = left.pop(entry.id, None)
        if item is None:
            place = config.place("EDDIInputs", index, "id")
            problems.append(
                problem("K013.no_input", place, hint=near.hint(entry.id), input=entry.id)
            )
            continue
        binding, found = _InputBinder(item, entry, index, config, known, types).bind()
        bindings.append(binding)
        problems += found
    for item in left.values():
        problems.append(
            problem(
                "K014.no_entry",
                config.place("EDDIInputs"),
                input=item.id,
                without_input=kind.without_input,
            )
        )
        bindings.append(InputBinding(item, _attribute(item), unit=item.unit))
    return bindings, problems


def _unconfigured(item: ModelInput) -> InputBinding:
    """Bind an input to a value of its own id: what a plain program passes in."""
    return by_value(InputBinding(item, _attribute(item), unit=item.unit))


def by_value(binding: InputBinding) -> InputBinding:
    """Return the binding of an input that is given its value itself, in place of messages."""
    source = SimulatorOutput.model_construct(id=binding.model.id, type="", topic="", max_age=None)
    name = binding.attribute
    return replace(
        binding,
        requires=(source,),
        arguments=(name,),
        expression=name,
        computed=None,
        key_paths={},
        reads=None,
    )


def _attribute(item: ModelInput) -> str:
    return item.attribute or attribute(item.id)


def _repeated_attributes(bindings: Sequence[InputBinding]) -> Iterable[Problem]:
    first: dict[str, str] = {}
    for binding in bindings:
        other = first.setdefault(binding.attribute, binding.model.id)
        if other != binding.model.id:
            yield problem(
                "K015.inputs", first=other, second=binding.model.id, name=binding.attribute
            )


class _InputBinder:
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
        self.known = known
        self.types = types
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
        computed = self._computed()
        self._check_arguments()
        self._check_type()
        factor = self._factor()
        self._check_default(factor)
        binding = InputBinding(
            self.item,
            _attribute(self.item),
            self.requires,
            self.arguments,
            self._expression() if computed is None else None,
            self._max_age(),
            self.entry.default,
            factor,
            self.entry.unit if factor is not None else self.item.unit,
            self.entry.renamed_from,
            {name: tuple(of) for name, of in self.fields.items()},
            computed.document if computed is not None else None,
            computed.text if computed is not None else "",
            computed.key_paths if computed is not None else {},
            names_read(computed.document) if computed is not None else None,
        )
        return binding, self.problems

    def _computed(self) -> CheckedExpression | None:
        """Check ``expression:`` and its like; what it reads becomes what the input requires."""
        entry = self.entry
        if entry.event is not None and entry.expression_file is None:
            self._report("K003.event_without_file", "event", input=entry.id)
        if not entry.is_computed:
            if entry.polarity == "HAZARD":
                place = self._place("polarity")
                self.problems.append(problem("K003.useless_polarity", place, input=entry.id))
            return None
        if entry.field is not None:
            key = "expression" if entry.expression_file is None else "expression_file"
            self._report("K003.field_and_expression", "field", input=entry.id, key=key)
        found, problems = bind_expression(
            self.item, self.index, self.config, self._fields_of, self.types
        )
        self.problems += problems
        if found is not None:
            self._check_unit((found.unit,) if found.unit else (), found.text)
            self.requires = found.requires
            self.arguments = tuple(attribute(source.id) for source in self.requires)
        return found

    def _place(self, *key: str) -> Place:
        return self.config.place("EDDIInputs", self.index, *key)

    def _report(self, case: str, key: str, /, *, hint: str | None = None, **fields: object) -> None:
        self.problems.append(problem(case, self._place(key), hint=hint, **fields))

    def _check_arguments(self) -> None:
        if len(set(self.arguments)) != len(self.arguments):
            names = ", ".join(self.arguments)
            self._report("K015.sources", "requires", input=self.entry.id, names=names)

    def _check_type(self) -> None:
        given, wanted = self.entry.type, self.item.type
        if given is not None and given != wanted and not {given, wanted} <= {"int", "float"}:
            self._report("K016.type", "type", input=self.entry.id, expected=wanted, actual=given)

    def _max_age(self) -> float | str | None:
        max_age = self.entry.max_age if self.entry.max_age is not None else self._of_sources()
        if max_age is None and self.item.safety and self.requires:
            topics = ", ".join(source.topic for source in self.requires)
            self.problems.append(
                problem("K017.entry", self._place(), input=self.entry.id, topics=topics)
            )
        return max_age

    def _of_sources(self) -> float | str | None:
        """Return the least age that the sources allow; the word of a robot has a lease.

        The limit of a monitor's message is none of a sensor that an expression reads beside it.
        """
        fleet = self.config.config.Fleet
        lease = fleet.lease if fleet is not None else None
        limits = [
            lease if requirement.peers else requirement.limit for requirement in self.requires
        ]
        written = self.entry.is_computed and None in limits
        allowed = (
            requirement.max_age
            if requirement.max_age is not None or (written and not requirement.peers)
            else limit
            for requirement, limit in zip(self.requires, limits, strict=True)
        )
        ages = [age for age in allowed if age is not None]
        numbers = [age for age in ages if not isinstance(age, str)]
        return min(numbers) if numbers else next(iter(ages), None)

    def _expression(self) -> str | None:
        """Return the expression of ``field:``, or of the only field where that fits."""
        entry = self.entry
        if entry.is_computed:
            return None  # it has an error
        if self.item.type == "float[]" and self.requires:
            return self._numbers()
        if len(self.requires) != 1:
            if entry.field is not None:
                self._report("K019.one_message", "field", input=entry.id, number=len(self.requires))
            return None
        argument = self.arguments[0]
        of_type = self.fields.get(argument)
        peers = self.requires[0].peers
        if entry.field is None and peers is not None and "guarantees" in (of_type or {}):
            field = f"guarantees[{peers.guarantee}].active"
            return self._taken(argument, self.requires[0].type, field)
        if entry.field is None:
            self._warn_unfit(self.requires[0].type)
            return _only_fitting_field(argument, of_type, self.item.type)
        return self._taken(argument, self.requires[0].type, entry.field)

    def _warn_unfit(self, message: str) -> None:
        """Warn of a message without any value of the type of the input."""
        if holds(message, self.item.type, self._fields_of) is False:
            own = InputBinding(self.item, "", renamed_from=self.entry.renamed_from).regions
            package = package_name(self.config.config.Model.id)
            unfit = problem(
                "K038.no_field",
                self._place("requires"),
                input=self.item.id,
                type=self.item.type,
                message=message,
            )
            self.problems.append(UnwrittenInput(**vars(unfit), package=package, regions=own))

    def _numbers(self) -> str | None:
        """Return the expression for a list of numbers, joined where several messages hold it.

        A ``MultiArray`` is taken as a whole, because its layout defines where its data begin.
        """
        field = self.entry.field
        parts: list[str | None] = []
        for argument, source in zip(self.arguments, self.requires, strict=True):
            if field in {None, "data"} and _MULTI_ARRAY.fullmatch(source.type):
                parts.append(argument)
            elif field is not None:
                parts.append(self._taken(argument, source.type, field))
            else:
                of_type = self.fields.get(argument)
                parts.append(_only_fitting_field(argument, of_type, self.item.type))
        known = [part for part in parts if part is not None]
        if len(known) < len(parts):
            return None
        return known[0] if len(known) == 1 else f"joined({', '.join(known)})"

    def _taken(self, argument: str, message: str, field: str) -> str | None:
        """Return the expression that takes a field from a message."""
        try:
            path = field_paths.parse_field(field)
        except field_paths.FieldPathError as failure:
            self._report("K019.path", "field", hint=failure.hint, reason=failure)
            return None
        return taken(argument, self._checked(path, message), message)

    def _checked(self, path: field_paths.FieldPath, message: str) -> field_paths.FieldPath:
        """Check a path with what is known of the message, also by the ROS of this machine."""
        try:
            found = resolve(path, message, self._fields_of)
        except field_paths.FieldPathError as failure:
            first, *rest = path
            hint = failure.hint
            if (
                rest
                and isinstance(first, field_paths.Attribute)
                and first.name in self.entry.requires
            ):
                hint = f"leave out `{first.name}.`: the path begins in the message"
            self._report("K020.path", "field", hint=hint, reason=failure)
            return path
        self._check_end(found.type, message)
        documented = documented_at(found.path, message, self._fields_of)
        if documented is not None:
            self._check_unit(documented.units, f"{self.entry.field} of {message}")
        return found.path

    def _check_unit(self, given: Sequence[str], what: str) -> None:
        """Compare the unit that a value has with the one that the input is declared to have."""
        wanted = self.entry.unit if self.entry.unit is not None else self.item.unit
        if wanted is None or self.item.units is None:
            return
        if not units.contradict(given, wanted):
            self._check_reach(given, what)
            return
        factors = [units.factor(unit, wanted) for unit in given]
        shown = " or ".join(unit for unit in given)
        expected = wanted or "a ratio"
        key = "unit" if self.entry.unit is not None else self._given_by
        if not any(factors):
            reason = units.apart(given[0], wanted)
            self._report(
                "K022.apart",
                key,
                hint=_shifted(given[0], wanted),
                subject=what,
                actual=shown,
                input=self.entry.id,
                expected=expected,
                reason=reason,
            )
            return
        unit, exact = next(pair for pair in zip(given, factors, strict=True) if pair[1])
        times = f"1 {unit} is {float(exact or 0):g} {wanted or 'of a ratio'}"
        self._report(
            "K022.unit",
            key,
            subject=what,
            actual=shown,
            input=self.entry.id,
            expected=expected,
            unit=unit,
            conversion=times,
        )

    def _check_reach(self, given: Sequence[str], what: str) -> None:
        """Warn of a fraction of which nothing is accepted: the range is meant in percent."""
        good, one = self.item.is_good, units.factor("fraction", self.item.unit or "")
        if tuple(given) != ("fraction",) or good is None or one is None:
            return
        # a range with a number between two ends has the lower end, or begins in between
        if not any(good(number) for number in (0.0, *self.item.starts) if 0 <= number <= one):
            self.problems.append(
                problem(
                    "K022.percent",
                    self._place(self._given_by),
                    subject=what,
                    covered=self.item.covered,
                )
            )

    @property
    def _given_by(self) -> str:
        return next((k for k in ("field", *EXPRESSION_KEYS) if getattr(self.entry, k)), "id")

    def _check_end(self, of: str | None, message: str) -> None:
        if of is not None and not fits(of, self.item.type):
            self._report(
                "K038.type",
                "field",
                field=self.entry.field,
                message=message,
                type=of,
                input=self.item.id,
                expected=self.item.type,
            )

    def _fields_of(self, message: str) -> Fields | None:
        return self.known[message] if message in self.known else installed_message(message)

    def _factor(self) -> tuple[int, int] | None:
        given, wanted = self.entry.unit, self.item.unit
        if given is None or given == (wanted or "") or {given, wanted} <= _PLAIN:
            return None
        if self.item.type not in {"float", "int"}:
            self._report("K016.unit_of_other", "unit", input=self.entry.id)
            return None
        factor = (self.item.units or {}).get(given)
        if factor is None:
            fitting = [unit or '""' for unit in self.item.units or {}]
            near = SimilarNames(fitting, "units that can be").hint(given)
            self._report(
                "K022.conversion",
                "unit",
                hint=_shifted(given, wanted) or near,
                actual=given,
                expected=wanted or "a ratio",
            )
            return None
        return None if factor[0] == factor[1] else factor

    def _check_default(self, factor: tuple[int, int] | None) -> None:
        value, item = self.entry.default, self.item
        if value is None:
            return
        finite = not isinstance(value, float) or math.isfinite(value)
        fits = finite and isinstance(value, _PYTHON_TYPES.get(item.type, ()))
        if not fits or (item.type != "bool" and isinstance(value, bool)):
            self._report("K016.default", "default", input=item.id, value=value, type=item.type)
            return
        if factor is not None and isinstance(value, int | float):
            value = value * factor[0] / factor[1]
        if item.is_good is None or not item.is_good(value) or self.entry.allow_unsafe_default:
            return
        self._report("K024", "default", default=self.entry.default, input=item.id)


def _shifted(given: str, wanted: str | None) -> str | None:
    """Return the hint at how a temperature gets from one scale to the other."""
    sign = {("K", "degC"): "-", ("degC", "K"): "+"}.get((given, wanted or ""))
    return f"write `expression: value {sign} 273.15` instead" if sign else None


def _only_fitting_field(
    argument: str, of_type: Mapping[str, str] | None, wanted: str
) -> str | None:
    if of_type is None or len(of_type) != 1:
        return None
    ((name, of),) = of_type.items()
    return f"{argument}.{name}" if fits(python_type(of), wanted) else None


def holds(message: str, wanted: str, fields_of: Callable[[str], Fields | None]) -> bool | None:
    """Return whether a message has a value for an input, ``None`` where that is not known."""
    types, is_known = [message], True
    for type_name in types:  # grows: a type is looked into once, however often it occurs
        inside = fields_of(type_name)
        is_known = is_known and inside is not None
        for name, of in (inside or {}).items():
            single = element(of) or of
            if name == "header":
                continue
            if not is_primitive(single):
                types += [single] if single not in types else []
            elif fits(python_type(of), wanted) or fits(python_type(single), wanted):
                return True
    return False if is_known else None


def fits(given: str, wanted: str) -> bool:
    """Return whether a field of one Python type can fill an input."""
    if wanted == "state":  # a name, or one likelihood per state
        return given in ("bool", "int", "str", "float[]")
    if wanted == "float[]":  # one number is a list of one
        return given in ("float", "int", "float[]")
    return given == wanted or (given, wanted) == ("int", "float")
