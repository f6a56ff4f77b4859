"""The message definitions that a bag carries, against the fields that a configuration names."""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping
from typing import Any

from eddi_scaffold.config.field_types import resolve
from eddi_scaffold.config.fields import FieldPath, FieldPathError, parse_field, path_text
from eddi_scaffold.config.file import ConfigFile
from eddi_scaffold.config.message_types import TIMES, Fields, MessageFields
from eddi_scaffold.config.schema import SimulatorOutput
from eddi_scaffold.identifiers import attribute
from eddi_scaffold.language.uses import inputs_of
from eddi_scaffold.monitors.binding import BoundMonitor, InputBinding, fits
from eddi_scaffold.monitors.expression_names import head_of, path_behind
from eddi_scaffold.monitors.expressions import EXPRESSION_KEYS
from eddi_scaffold.problems import Problem, error

_TIMES = {"builtin_interfaces/Time": "time", "builtin_interfaces/Duration": "duration"}


def tables(definitions: Mapping[str, Any]) -> MessageFields:
    """Return message type -> its fields, of the definitions as rosbags has read them."""
    found: dict[str, Fields] = {}
    for name, (_, fields) in definitions.items():
        found[name.replace("/msg/", "/")] = {field: _type(*of) for field, of in fields}
    return {**found, **TIMES}


def _type(node: Any, of: Any) -> str:
    """Return a type in the words of ``.msg`` files."""
    if node.name == "BASE":
        return str(of[0])
    if node.name == "NAME":
        name = str(of).replace("/msg/", "/")
        return _TIMES.get(name, name)
    inner, size = of  # an array or a sequence
    return f"{_type(*inner)}[{size if node.name == 'ARRAY' else ''}]"


def check_fields(
    monitor: BoundMonitor, known: MessageFields, there: Collection[str]
) -> Iterator[Problem]:
    """Report fields that the messages of a bag do not have, or not of that type (I017).

    Args:
        monitor: it has a configuration.
        known: the messages of the bag.
        there: full names of the topics in the bag: others cannot be checked.
    """
    assert monitor.config is not None
    entries = {one.id: k for k, one in enumerate(monitor.config.config.EDDIInputs)}
    for binding in monitor.inputs:
        if binding.model.id not in entries:
            continue
        place = _place(monitor.config, entries[binding.model.id])
        for source, path, is_value in _reads(binding, monitor.config, entries[binding.model.id]):
            if monitor.topic(source.topic) not in there:
                continue
            shown = f"{source.type} in the bag"
            try:
                of = resolve(path, source.type, known.get).type
            except FieldPathError as problem:
                yield error("I017", f"{shown}: {problem}", place, problem.hint)
                continue
            if is_value and of is not None and not fits(of, binding.model.type):
                message = f"{shown}: {path_text(path)!r} is a {of}"
                yield error("I017", f"{message}, the input a {binding.model.type}", place)


def _place(config: ConfigFile, index: int) -> Any:
    entry = config.config.EDDIInputs[index]
    key = next((key for key in ("field", *EXPRESSION_KEYS) if getattr(entry, key)), "requires")
    return config.place("EDDIInputs", index, key)


def _reads(
    binding: InputBinding, config: ConfigFile, index: int
) -> Iterator[tuple[SimulatorOutput, FieldPath, bool]]:
    """Yield message, path, and whether what is there is the value itself."""
    if binding.computed is not None:
        sources = {attribute(one.id): one for one in binding.requires}
        document: Any = binding.computed
        names = (n for p in document["parts"] for v in p["form"]["variables"] for n in inputs_of(v))
        for name in dict.fromkeys(names):
            if head_of(name) in sources:
                yield sources[head_of(name)], path_behind(name), False
        return
    field = config.config.EDDIInputs[index].field
    if not binding.is_given:
        return
    for argument, source in zip(binding.arguments, binding.requires, strict=False):
        believed = (binding.known_fields or {}).get(argument, ())
        taken = believed[0] if field is None and len(believed) == 1 else field
        if taken is not None:
            yield source, parse_field(taken), True
