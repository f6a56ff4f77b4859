"""From a model and its configuration to the answers that every platform shares.

Everything that reaches a template as code is made here or in a platform: a checked identifier or a
ready literal. Templates put text in place and loop, nothing else.
"""

from __future__ import annotations

import hashlib
import json
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass

from eddi_runtime import __version__ as runtime_version
from eddi_runtime.model_file import ModelError, canonical, digest_of, parse_model
from eddi_runtime.monitor import build
from eddi_scaffold import __version__, fields
from eddi_scaffold.config import Config, ConfigFile, Input, SimulatorOutput
from eddi_scaffold.identifiers import attribute, package_name
from eddi_scaffold.kinds import JsonValue, Kind, Model, ModelInput, Settings
from eddi_scaffold.problems import Problem, did_you_mean, error, warning
from eddi_scaffold.regions import markers

_DEFAULT_MAINTAINER = "The users of this workspace <noreply@localhost.invalid>"
_PYTHON_TYPES: dict[str, type | tuple[type, ...]] = {
    "bool": bool, "float": (int, float), "int": int, "str": str,
}  # fmt: skip


@dataclass(frozen=True)
class InputBinding:
    """One input of the model, joined with what the configuration says about it.

    Attributes:
        attribute: name in ``EDDIInput``.
        requires: the simulator outputs it is made of; one of its own id without a configuration.
        field: Python expression over the arguments that gives the value, ``None`` when a person
            must write it.
        max_age: seconds, ``"none"`` (never stale, on purpose), or ``None`` (never stale, by default).
        factor: exact factor from the configured unit to the model's, or ``None``.
        renamed_from: former id.
    """

    model: ModelInput
    attribute: str
    requires: tuple[SimulatorOutput, ...]
    arguments: tuple[str, ...]
    expression: str | None
    max_age: float | str | None
    default: bool | int | float | str | None
    factor: tuple[int, int] | None
    renamed_from: str | None
    fields_of_type: str | None


@dataclass(frozen=True)
class Monitor:
    """Everything a platform needs to know of one monitor."""

    package: str
    model: Model
    kind: Kind
    config: ConfigFile | None
    inputs: tuple[InputBinding, ...]
    model_json: str
    default_guarantees: tuple[str, ...] = ()


FieldsOf = Mapping[str, Mapping[str, str]]
"""ROS message type -> field -> ``bool``, ``int``, ``float``, ``str`` or another message type."""


def monitor_of(
    model: Model,
    kind: Kind,
    config: ConfigFile | None,
    known_messages: FieldsOf,
    marks: Sequence[str] = (),
) -> tuple[Monitor | None, list[Problem]]:
    """Join a checked model with its configuration.

    Args:
        model: what is monitored.
        kind: the kind of the model.
        config: how it is connected, if it is.
        known_messages: the fields of the message types that are known.
        marks: the default guarantees that were marked when the model was read; remembered.

    Returns:
        The monitor, ``None`` when a problem is an error, and all problems of the join.
    """
    problems: list[Problem] = []
    inputs = kind.inputs(model)
    if config is not None:
        problems += _check_model_section(model, kind, config)
    bindings, found = _bind(inputs, config, known_messages)
    problems += found
    problems += _repeated_attributes(bindings)
    if any(p.level == "error" for p in problems):
        return None, problems
    identity = config.config.Model.id if config is not None else model.name
    text = _model_json(model, kind, bindings, _settings(config))
    try:
        build(parse_model(text, "the runtime model"))
    except ModelError as refused:  # the runtime that will run it has the last word
        place = config.place("Model") if config else model.place
        return None, [*problems, error("E028", refused.reason, place)]
    package = package_name(identity)
    return Monitor(package, model, kind, config, tuple(bindings), text, tuple(marks)), problems


def shared_answers(monitor: Monitor, template: str) -> dict[str, JsonValue]:
    """Return the answers about identity that the templates of all platforms ask for."""
    config = monitor.config.config if monitor.config else None
    source = monitor.model.source
    title = f"{monitor.kind.title} {one_line(monitor.model.name)}"
    return {
        "template": template,
        **identity_answers(monitor.package, f"Runtime monitor of the {title}", config),
        "kind": monitor.kind.name,
        "model_id_text": comment_text(monitor.model.name),
        "model_file": comment_text(source.file_name),
        "model_sha256": source.sha256,
        "inputs": [_input_answers(binding) for binding in monitor.inputs],
        "runtime_names": _runtime_names(monitor.inputs),
        "default_guarantees": list(monitor.default_guarantees),
        "config_json": config.as_json() if config else "",
        "model_json": monitor.model_json,
    }


def _runtime_names(inputs: Sequence[InputBinding]) -> list[str]:
    """Return what EDDIInput.py imports from the runtime."""
    uses_lookup = any("by_id(" in (binding.expression or "") for binding in inputs)
    return ["EDDIInputBase", "by_id"] if uses_lookup else ["EDDIInputBase"]


def identity_answers(package: str, description: str, config: Config | None) -> dict[str, JsonValue]:
    """Return the answers that stand in every package.xml."""
    section = config.Package if config else None
    maintainer = (section.maintainer if section else None) or _DEFAULT_MAINTAINER
    name, _, address = maintainer.rstrip(">").partition("<")
    return {
        "generator_version": __version__,
        "package": package,
        "package_version": section.version if section else "0.1.0",
        "description": (section.description if section else None) or description,
        "maintainer_name": name.strip(),
        "maintainer_email": address.strip(),
        "license": section.license if section else "Apache-2.0",
    }


def one_line(text: str) -> str:
    """Fold any text into one line of printable characters."""
    folded = " ".join(text.split())
    return "".join(char if char.isprintable() else "?" for char in folded)


def comment_text(text: str) -> str:
    """Return text that can stand in a Python comment or docstring without ending it."""
    return one_line(text).replace("\\", "/").replace('"', "'").replace("'''", "'")


def _settings(config: ConfigFile | None) -> Settings:
    if config is None:
        return Settings()
    section = config.config.Model
    filtering = section.filter
    if filtering is None and section.debounce is not None:
        filtering = {"kind": "debounce", "regain_after": section.debounce}
    return Settings(guarantee_ids=section.guarantee_ids, filter=filtering)


def _check_model_section(model: Model, kind: Kind, config: ConfigFile) -> Iterable[Problem]:
    section = config.config.Model
    place = config.place("Model", "type")
    if section.type.casefold() not in {name.casefold() for name in kind.config_types}:
        yield error("E010", f"the model is a {kind.title}, the configuration says {section.type!r}", place)
    if section.debounce is not None and section.filter is not None:
        yield error(
            "E011", "debounce and filter exclude each other", config.place("Model", "filter"), "keep one of them"
        )
    if section.id != model.name and package_name(section.id) == package_name(model.name):
        yield warning(
            "E012",
            f"Model id {section.id!r} is spelt {model.name!r} in {model.source.name}",
            config.place("Model", "id"),
        )


def _bind(
    inputs: Sequence[ModelInput], config: ConfigFile | None, known: FieldsOf
) -> tuple[list[InputBinding], list[Problem]]:
    if config is None:
        return [_unconfigured(item) for item in inputs], []
    problems: list[Problem] = []
    by_id = {item.id: item for item in inputs}
    bindings: list[InputBinding] = []
    for index, entry in enumerate(config.config.EDDIInputs):
        item = by_id.pop(entry.id, None)
        if item is None:
            names = [other.id for other in inputs]
            hint = did_you_mean(entry.id, names) or f"the inputs are: {', '.join(names)}"
            place = config.place("EDDIInputs", index, "id")
            problems.append(error("E013", f"the model has no input {entry.id!r}", place, hint))
            continue
        binding, found = _bound(item, entry, index, config, known)
        bindings.append(binding)
        problems += found
    for item in by_id.values():
        problems.append(
            warning(
                "E014",
                f"no entry of EDDIInputs provides {item.id!r}: it stays unknown, and no guarantee that needs it "
                "becomes active",
                config.place("EDDIInputs"),
                f"add `- id: {item.id}` with `requires:`",
            )
        )
        bindings.append(_unprovided(item))
    return bindings, problems


def _unconfigured(item: ModelInput) -> InputBinding:
    """Bind an input to a value of its own id: what a plain program passes in."""
    name = attribute(item.id)
    source = SimulatorOutput.model_construct(id=item.id, type="", topic="", max_age=None)
    return InputBinding(item, name, (source,), (name,), name, None, None, None, None, None)


def _unprovided(item: ModelInput) -> InputBinding:
    return InputBinding(item, attribute(item.id), (), (), None, None, None, None, None, None)


def _bound(
    item: ModelInput, entry: Input, index: int, config: ConfigFile, known: FieldsOf
) -> tuple[InputBinding, list[Problem]]:
    problems: list[Problem] = []
    sources = {source.id: source for source in reversed(config.config.SimulatorOutputs)}
    requires = tuple(sources[name] for name in dict.fromkeys(entry.requires))
    arguments = tuple(attribute(source.id) for source in requires)
    if len(set(arguments)) != len(arguments):
        message = f"the ids that {entry.id!r} requires give the same name in Python: {', '.join(arguments)}"
        problems.append(error("E015", message, config.place("EDDIInputs", index, "requires"), "rename one"))
    if entry.type is not None and entry.type != item.type and not {entry.type, item.type} <= {"int", "float"}:
        message = f"input {entry.id!r} is a {item.type} in the model, not a {entry.type}"
        problems.append(error("E016", message, config.place("EDDIInputs", index, "type")))
    expression, found = _expression(item, entry, index, config, known, requires, arguments)
    problems += found
    factor, found = _factor(item, entry, index, config)
    problems += found
    problems += _check_default(item, entry, index, config)
    max_age = entry.max_age if entry.max_age is not None else _shortest(requires)
    if max_age is None and item.safety:
        topics = ", ".join(source.topic for source in requires) or "nothing"
        message = (
            f"input {entry.id!r} (from {topics}) has no max_age: it stays as it was if its publisher dies"
        )
        hint = "write `max_age:` in seconds, about 2.5 periods of the publisher, or `max_age: none`"
        problems.append(warning("E017", message, config.place("EDDIInputs", index), hint))
    return (
        InputBinding(
            item,
            attribute(item.id),
            requires,
            arguments,
            expression,
            max_age,
            entry.default,
            factor,
            entry.renamed_from,
            _fields_hint(requires, known),
        ),
        problems,
    )


def _shortest(requires: Sequence[SimulatorOutput]) -> float | str | None:
    ages = [source.max_age for source in requires if source.max_age is not None]
    numbers = [age for age in ages if not isinstance(age, str)]
    return min(numbers) if numbers else (ages[0] if ages else None)


def _expression(
    item: ModelInput,
    entry: Input,
    index: int,
    config: ConfigFile,
    known: FieldsOf,
    requires: Sequence[SimulatorOutput],
    arguments: Sequence[str],
) -> tuple[str | None, list[Problem]]:
    """Return the expression of `field:`, or of the only field of the only message that fits."""
    place = config.place("EDDIInputs", index, "field")
    if len(requires) != 1:
        if entry.field is None:
            return None, []
        message = f"`field:` of {entry.id!r} needs exactly one message in `requires`, not {len(requires)}"
        return None, [error("E018", message, place, "write the region in EDDIInput.py by hand instead")]
    of_type = known.get(requires[0].type)
    if entry.field is None:
        only = list(of_type.items()) if of_type is not None and len(of_type) == 1 else []
        fits = only and (only[0][1] == item.type or (only[0][1], item.type) == ("int", "float"))
        return (f"{arguments[0]}.{only[0][0]}" if fits else None), []
    try:
        path = fields.parse_field(entry.field)
    except ValueError as problem:
        return None, [error("E019", str(problem), place)]
    first = path[0]
    if of_type is not None and isinstance(first, fields.Attribute) and first.name not in of_type:
        hint = did_you_mean(first.name, of_type) or f"its fields: {', '.join(of_type)}"
        return None, [error("E020", f"{requires[0].type} has no field {first.name!r}", place, hint)]
    return fields.expression(arguments[0], path), []


def _factor(
    item: ModelInput, entry: Input, index: int, config: ConfigFile
) -> tuple[tuple[int, int] | None, list[Problem]]:
    if entry.unit is None or entry.unit == (item.unit or ""):
        return None, []
    place = config.place("EDDIInputs", index, "unit")
    if item.type not in {"float", "int"}:
        return None, [error("E021", f"input {entry.id!r} is no number and has no unit", place)]
    factor = (item.units or {}).get(entry.unit)
    if factor is None:
        fitting = ", ".join(unit or '""' for unit in item.units or {})
        message = f"the unit {entry.unit!r} cannot be converted to {item.unit or 'a ratio'!r}"
        return None, [error("E022", message, place, f"units that can: {fitting}")]
    return (None if factor[0] == factor[1] else factor), []


def _check_default(item: ModelInput, entry: Input, index: int, config: ConfigFile) -> Iterable[Problem]:
    if entry.default is None:
        return
    place = config.place("EDDIInputs", index, "default")
    fits = isinstance(entry.default, _PYTHON_TYPES[item.type])
    if not fits or (item.type != "bool" and isinstance(entry.default, bool)):
        yield error("E023", f"the default of {entry.id!r} is {entry.default!r}, a {item.type} is expected", place)
    elif item.is_good is not None and item.is_good(entry.default) and not entry.allow_unsafe_default:
        yield error(
            "E024",
            f"the default {entry.default!r} of {entry.id!r} counts as good evidence before any message has come",
            place,
            "leave it out, or write `allow_unsafe_default: true` beside it",
        )


def _fields_hint(requires: Sequence[SimulatorOutput], known: FieldsOf) -> str | None:
    """Return a comment line that shows the fields to choose from, where they are known."""
    shown = [
        f"{attribute(source.id)} has {', '.join(f'.{name}' for name in known[source.type])}"
        for source in requires
        if source.type in known
    ]
    return "; ".join(shown) or None


def _repeated_attributes(bindings: Sequence[InputBinding]) -> Iterable[Problem]:
    first: dict[str, str] = {}
    for binding in bindings:
        other = first.setdefault(binding.attribute, binding.model.id)
        if other != binding.model.id:
            message = f"the inputs {other!r} and {binding.model.id!r} give the same name {binding.attribute!r}"
            yield error("E025", message, hint="rename one of them in the model")


def _input_answers(binding: InputBinding) -> dict[str, JsonValue]:
    item = binding.model
    title = comment_text(item.id)
    region = f"input:{item.id}"
    was = [f"input:{binding.renamed_from}"] if binding.renamed_from else []
    return {
        "id": ascii(item.id),
        "title": title,
        "attribute": binding.attribute,
        "type": item.type,
        "default": ascii(binding.default),
        "arguments": list(binding.arguments),
        "requires": tuple_literal(source.id for source in binding.requires),
        "comments": _comments(binding),
        "region_begin": markers.begin_marker(region, was=was, sig=_signature(binding)),
        "region_end": markers.end_marker(region),
        "body": _body(binding),
        "sources": ", ".join(f"`{one_line(s.topic or s.id)}`" for s in binding.requires) or "nothing",
        "covered": table_cell(item.covered or "-"),
        "age_text": "never" if binding.max_age in {None, "none"} else f"{binding.max_age} s",
    }


def _comments(binding: InputBinding) -> list[str]:
    item = binding.model
    lines = []
    if item.description:
        lines.append(comment_text(item.description))
    unit = f" in {item.unit}" if item.unit else ""
    good = f", good when {comment_text(item.covered)}" if item.covered else ""
    lines.append(f"{item.type}{unit}{good}")
    return lines


def _body(binding: InputBinding) -> list[str]:
    if binding.expression is not None:
        return [f"self.{binding.attribute} = {binding.expression}"]
    hint = f" ({comment_text(binding.fields_of_type)})" if binding.fields_of_type else ""
    arguments = ", ".join(binding.arguments) or "what you know"
    return [
        f"# TODO: set self.{binding.attribute} from {arguments}{hint}; None means unknown",
        f"self.{binding.attribute} = None",
    ]


def _signature(binding: InputBinding) -> str:
    """Hash what the body may use: a changed one asks for a look at a hand-written body."""
    uses = [binding.attribute, binding.model.type, binding.model.unit]
    uses += [f"{name}: {source.type}" for name, source in zip(binding.arguments, binding.requires, strict=True)]
    return hashlib.sha256(json.dumps(uses).encode()).hexdigest()[:8]


def tuple_literal(texts: Iterable[str]) -> str:
    """Return the Python literal of a tuple of texts."""
    items = [ascii(text) for text in texts]
    return f"({', '.join(items)}{',' if len(items) == 1 else ''})"


def table_cell(text: str) -> str:
    """Return text for a cell of a Markdown table."""
    return one_line(text).replace("|", "\\|")


def _model_json(
    model: Model, kind: Kind, bindings: Sequence[InputBinding], settings: Settings
) -> str:
    data: dict[str, JsonValue] = {
        "format": 1,
        "kind": kind.name,
        "id": model.name,
        "requires_runtime": ".".join(runtime_version.split(".")[:2]),
        "source": {
            "file": model.source.file_name,
            "sha256": model.source.sha256,
            "path": model.place.path,
        },
        "inputs": [
            {
                "id": binding.model.id,
                "attribute": binding.attribute,
                "requires": [source.id for source in binding.requires],
                "max_age": binding.max_age,
                "factor": list(binding.factor) if binding.factor else None,
                "default": binding.default,
            }
            for binding in bindings
        ],
        "model": kind.runtime_model(model, settings),
        "settings": {
            "guarantee_ids": settings.guarantee_ids,
            "filter": dict(settings.filter or {"kind": "none"}),
        },
    }
    data["sha256"] = digest_of(data)
    return canonical(data).rstrip("\n")

