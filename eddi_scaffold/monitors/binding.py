"""A model joined with its configuration: what a monitor listens to, and how it gets its inputs."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

from eddi_scaffold.common.claims import Acceptance
from eddi_scaffold.common.identifiers import attribute, full_topic, package_name
from eddi_scaffold.common.problems import EddiError, Problem, SimilarNames, has_errors, problem
from eddi_scaffold.config.field_types import EITHER_TIMES, MessageFields, declared
from eddi_scaffold.config.file import ConfigFile
from eddi_scaffold.config.schema import USUAL_FREQUENCY, InputEntry, OutputEntry
from eddi_scaffold.kinds import DeclaredInput, EditableMethod, Kind, Model, Options, kinds
from eddi_scaffold.monitors import input_rules
from eddi_scaffold.monitors.compiling import (
    CompiledModule,
    MonitorFacts,
    compile_monitor,
    input_lags,
)
from eddi_scaffold.monitors.input_binding import InputBinder, InputBinding
from eddi_scaffold.monitors.message_types import known_messages
from eddi_scaffold.monitors.spellings import default_outputs
from eddi_scaffold.monitors.topic_types import check_types
from eddi_scaffold.program.input_expressions import BoundInput


def options_of(file: ConfigFile | None) -> Options:
    """Return the options of a configuration for the kind of its model."""
    if file is None:
        return Options()
    config, section = file.config, file.config.Model
    extra = {**(section.model_extra or {}), "parameters": section.parameters}
    types = {source.id: source.type for source in config.SimulatorOutputs}
    inputs = tuple(
        DeclaredInput(
            id=entry.id,
            type=entry.type,
            unit=entry.unit,
            default=entry.default,
            place=file.place("EDDIInputs", index),
            messages=tuple(types[name] for name in entry.requires),
        )
        for index, entry in enumerate(config.EDDIInputs)
    )
    return Options(
        id=section.id,
        values={key: value for key, value in extra.items() if value is not None},
        inputs=inputs,
        frequency=section.frequency,
        parts=tuple(output.event for output in config.EDDIOutputs),
        place=lambda *path: file.place("Model", *path),
        inside=lambda *path: file.inside("Model", *path),
    )


@dataclass(frozen=True)
class BoundMonitor:
    """Everything a platform needs to know of one monitor."""

    package: str
    model: Model
    kind: Kind
    config: ConfigFile | None
    inputs: tuple[InputBinding, ...]
    compiled: CompiledModule
    facts: MonitorFacts
    unconfigured: Model  # before it was configured
    bound: tuple[BoundInput, ...]  # the inputs as they were compiled
    default_guarantees: tuple[str, ...] = ()  # marks that were given when the model was read
    cross_check: str = ""  # how the compiled model compares with an independent tool, one sentence

    @property
    def id(self) -> str:
        """The id in its configuration, else the name of its model: for people."""
        return self.config.config.Model.id if self.config is not None else self.model.name

    @property
    def needed_methods(self) -> list[EditableMethod]:
        """The methods of its kind that only a person can write."""
        modules = self.model.editable_modules()
        return [method for module in modules for method in module.methods if method.is_needed]

    def lag(self, output: str, input_: str) -> float:
        """Return the seconds beyond one step after which a bad value that lasts ends a claim."""
        own = input_lags(self.model.inputs(), self.bound)[input_].value
        return self.model.lag(output, input_) + own

    def topic(self, name: str) -> str:
        """Return the full name of a topic of its node, as it is in a bag."""
        return full_topic(name, "", self.package)


def monitor_of(
    model: Model, config: ConfigFile | None, marks: Sequence[str] = ()
) -> tuple[BoundMonitor | None, list[Problem]]:
    """Join a checked model with its configuration, if it has one.

    The default guarantees that were marked when the model was read are remembered. The monitor is
    ``None`` when a problem is an error.
    """
    kind = kinds()[model.kind]
    if config is not None and not config.config.EDDIOutputs:
        package, parts = package_name(config.config.Model.id), model.separate_outputs()
        outputs = [OutputEntry(**entry) for entry in default_outputs(package, kind, parts)]
        filled = config.config.model_copy(update={"EDDIOutputs": outputs})
        config = replace(config, config=filled)
    configured, problems = model.configure(options_of(config))
    if configured is None and not kind.inputs_of_model:
        return None, problems  # what the inputs are is not known
    model, unconfigured = configured or model, model
    known = known_types(config, {**known_messages(), **EITHER_TIMES})  # a platform binds again
    bindings, problems_of_inputs = bind_inputs(model, config, known)
    problems = [*problems, *problems_of_inputs]
    place, frequency = model.place, USUAL_FREQUENCY
    entries: Sequence[InputEntry] = ()
    package = package_name(model.file_stem or model.name)
    if config is not None:
        used = {source.id for binding in bindings for source in binding.requires}
        problems += check_types(config, used)
        section, place = config.config.Model, config.place("Model", "id")
        if section.type.casefold() not in {name.casefold() for name in kind.config_types}:
            fields = {"kind": kind.title, "declared": section.type}
            problems.append(problem("K010.kind", config.place("Model", "type"), **fields))
        if package_name(section.id) != package_name(model.name):
            problems.append(problem("K012", place, id=section.id, model=model.name))
        place, entries = config.place("Model"), config.config.EDDIInputs
        frequency, package = section.frequency, package_name(section.id)
    first: dict[str, str] = {}
    for binding in bindings:
        name, other = binding.model.id, first.setdefault(binding.attribute, binding.model.id)
        if other != name:
            problems += [problem("K015.inputs", first=other, second=name, name=binding.attribute)]
    if configured is None or has_errors(problems):
        return None, problems
    inputs = {binding.model.id: binding.compiled(package) for binding in bindings}
    accepted: list[Acceptance] = []
    for index, entry in enumerate(entries):
        accepted_here = [*input_rules.of_input(entry, inputs[entry.id], index)]
        keys = dict.fromkeys(acceptance.key for acceptance in accepted_here)
        keys.pop(input_rules.LIMITLESS, None)  # which the runtime sees in another field
        inputs[entry.id] = replace(inputs[entry.id], accepts=tuple(keys))
        accepted += accepted_here
    try:
        compiled, facts = compile_monitor(model, tuple(inputs.values()), accepted, frequency, place)
    except EddiError as refused:
        return None, [*problems, *refused.problems]
    problems += check_reactions(config, facts) if config is not None else ()
    if has_errors(problems):
        return None, problems
    joined = (package, model, kind, config, tuple(bindings), compiled, facts, unconfigured)
    return BoundMonitor(*joined, tuple(inputs.values()), tuple(marks)), problems


def check_reactions(config: ConfigFile, facts: MonitorFacts) -> Iterator[Problem]:
    """Report unknown guarantees of ``Reactions``, and times that are missing (K003)."""
    # one that rests on nothing cannot be lost
    known = [claim.id for claim in facts.claims if claim.id and claim.rests_on]
    similar = SimilarNames(known, "there are")
    for index, reaction in enumerate(config.config.Reactions):
        place, name = config.place("Reactions", index, "guarantee"), reaction.guarantee
        if name not in known:
            yield problem("K003.no_guarantee", place, hint=similar.hint(name), guarantee=name)
        elif reaction.reaction is None:
            yield problem("K003.no_reaction", place)


def known_types(config: ConfigFile | None, known: MessageFields) -> MessageFields:
    """Return all known types, and those that a configuration declares itself; its word counts."""
    own = {}
    for name, fields in (config.config.MessageTypes if config is not None else {}).items():
        rows = ((type_, field) for field, type_ in fields.items())
        own[name] = declared(rows, name.partition("/")[0])
    return {**known, **own}


def bound_to(monitor: BoundMonitor, known: MessageFields) -> tuple[BoundMonitor, list[Problem]]:
    """Return a monitor with the fields of a platform: one that another has may be missing."""
    inputs, problems = bind_inputs(monitor.model, monitor.config, known)
    errors = [problem for problem in problems if problem.level == "error"]  # others are reported
    return replace(monitor, inputs=tuple(inputs)), errors


def bind_inputs(
    model: Model, config: ConfigFile | None, known: MessageFields
) -> tuple[list[InputBinding], list[Problem]]:
    """Return how each input of a configured model gets its value, and what does not fit."""
    unbound = {
        item.id: InputBinding(item, item.attribute or attribute(item.id), unit=item.unit)
        for item in model.inputs()
    }
    if config is None:  # a plain program passes the values in
        return [binding.by_value() for binding in unbound.values()], []
    problems: list[Problem] = []
    bindings: list[InputBinding] = []
    types = {name: binding.model.type for name, binding in unbound.items()}
    similar = SimilarNames([*unbound], "the inputs are")
    for index, entry in enumerate(config.config.EDDIInputs):
        if entry.id not in unbound:
            place, hint = config.place("EDDIInputs", index, "id"), similar.hint(entry.id)
            problems.append(problem("K013.no_input", place, hint=hint, input=entry.id))
            continue
        item = unbound.pop(entry.id).model
        binding, problems_here = InputBinder(item, entry, index, config, known, types).bind()
        bindings.append(binding)
        problems += problems_here
    place, without = config.place("EDDIInputs"), kinds()[model.kind].without_input
    problems += [
        problem("K014.no_entry", place, input=name, without_input=without) for name in unbound
    ]
    return [*bindings, *unbound.values()], problems
