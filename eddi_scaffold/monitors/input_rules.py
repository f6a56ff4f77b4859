"""What counts as known of an input: by its configuration, and by what a message states.

The same list goes two ways: ``check``, ``show`` and ``trace`` name the claims that rest on it, and
the monitor reports at run time which are in use.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

from eddi_runtime.inputs import UNSAFE_DEFAULT

from eddi_scaffold.common.claims import Acceptance, Meaning
from eddi_scaffold.common.escaping import python_literal
from eddi_scaffold.conditions.uses import accepted
from eddi_scaffold.config.field_paths import (
    Attribute,
    Every,
    FieldPath,
    expression,
    pattern,
    plain_step,
)
from eddi_scaffold.config.schema import InputEntry
from eddi_scaffold.kinds import JsonValue, Kind, kinds
from eddi_scaffold.program.input_expressions import BoundInput

LIMITLESS = "max_age: none"


def of_input(entry: InputEntry, bound: BoundInput, index: int) -> Iterator[Acceptance]:
    """Yield what an entry of ``EDDIInputs`` accepts."""
    path = ("EDDIInputs", index)
    if bound.max_age == "none":
        yield Acceptance(LIMITLESS, "the last value", input=entry.id, path=(*path, "max_age"))
    if entry.allow_unsafe_default and entry.default not in (None, False):
        text, key = f"the default {entry.default!r}", UNSAFE_DEFAULT.partition(":")[0]
        until = "until the first message"
        yield Acceptance(UNSAFE_DEFAULT, text, until, input=entry.id, path=(*path, key))
    key = "expression" if entry.expression is not None else "expression_file"
    for part in bound.expression["parts"] if bound.expression is not None else ():
        (result,) = part["program"].results
        for silence in accepted(part["program"], result.operation):
            yield replace(silence, input=entry.id, path=(*path, key), at=None)


def kind_of_message(type_: str) -> Kind | None:
    """Return the kind whose monitors publish a message type, ``None`` for other types."""
    package, _, name = type_.partition("/")
    if package != "eddi_messages":
        return None
    return next((kind for kind in kinds().values() if name in kind.all_messages), None)


def taken(argument: str, path: FieldPath, message: str) -> str:
    """Return the Python expression that takes a field of a message, where that is known."""
    parts = [expression(argument, path)]
    for deciding, values in _known(path, message):
        literals = ", ".join(map(python_literal, values))
        parts.append(
            literals if deciding == path else f"({expression(argument, deciding)}, {literals})"
        )
    return f"given({', '.join(parts)})" if parts[1:] else parts[0]


def check(path: FieldPath, message: str) -> list[JsonValue]:
    """Return the same for the runtime of expressions, empty where every value counts."""
    checks: list[JsonValue] = []
    for deciding, values in _known(path, message):
        if deciding == path:
            checks += values
        elif not any(isinstance(step, Every) for step in path):  # of a list, each by itself
            checks.append([[*map(plain_step, deciding)], *values])
    return ["given", *checks] if checks else []


def _known(path: FieldPath, message: str) -> Iterator[tuple[FieldPath, list[JsonValue]]]:
    """Yield the fields of which one must have one of some values, that itself among them."""
    kind, name = kind_of_message(message), message.partition("/")[2]
    if kind is None:
        return
    field = "".join(pattern(path)).removeprefix(".")
    meaning = kind.model_class.meanings(None).get(name, {}).get(field, Meaning())
    for value in meaning.silent or ():
        if isinstance(value, bool):
            yield path, [not value]
    for known in meaning.known:
        if isinstance(known, tuple):  # a field of the same message, or of the same element
            other, values = str(known[0]), list[JsonValue](known[1:])
            element = path[:-1] if other.startswith(".") else ()
            yield (*element, Attribute(other.removeprefix("."))), values
        else:
            yield path, [known]
