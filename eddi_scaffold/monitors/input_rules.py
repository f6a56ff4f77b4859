"""What counts as known of an input: by its configuration, and by what a message states.

The same list goes two ways: ``check``, ``show`` and ``trace`` name the claims that rest on it, and
the monitor reports at run time which are in use.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import replace

from eddi_runtime.inputs import UNSAFE_DEFAULT

from eddi_scaffold.common.claims import Acceptance, Meaning
from eddi_scaffold.common.escaping import python_literal
from eddi_scaffold.conditions.uses import accepted, lasts
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

_LIMITLESS = "max_age: none"


def of_input(entry: InputEntry, bound: BoundInput, index: int) -> Iterator[Acceptance]:
    """Return what an entry of ``EDDIInputs`` accepts.

    Args:
        entry: as it is configured.
        bound: the same, bound.
        index: of the entry.
    """
    path = ("EDDIInputs", index)
    if bound.max_age == "none":
        yield Acceptance(_LIMITLESS, "the last value", input=entry.id, path=(*path, "max_age"))
    if entry.allow_unsafe_default and entry.default not in (None, False):
        text, key = f"the default {entry.default!r}", UNSAFE_DEFAULT.partition(":")[0]
        until = "until the first message"
        yield Acceptance(UNSAFE_DEFAULT, text, until, input=entry.id, path=(*path, key))
    computed = bound.expression
    key = "expression" if entry.expression is not None else "expression_file"
    for part in computed["parts"] if computed is not None else ():
        (output,) = part["form"]["outputs"]
        for one in accepted(part["form"], output["node"]):
            found = Acceptance(one.word, one.accepts, lasts(one), one.seconds, path=(*path, key))
            yield replace(found, input=entry.id)


def keys(accepted: Iterable[Acceptance]) -> tuple[str, ...]:
    """Return the keys of an input that the runtime cannot see in its other fields."""
    return tuple(dict.fromkeys(one.key for one in accepted if one.key != _LIMITLESS))


def kind_of_message(type_: str) -> Kind | None:
    """Return the kind whose monitors publish a message type, ``None`` for other types."""
    package, _, name = type_.partition("/")
    if package != "eddi_messages":
        return None
    return next((kind for kind in kinds().values() if name in kind.all_messages), None)


def taken(argument: str, path: FieldPath, message: str) -> str:
    """Return the Python expression that takes a field of a message, where that is known."""
    parts = [expression(argument, path)]
    for beside, values in _known(path, message):
        literals = [python_literal(value) for value in values]
        told = [] if beside == path else [expression(argument, beside)]
        parts.append(f"({', '.join([*told, *literals])})" if told else ", ".join(literals))
    return f"given({', '.join(parts)})" if parts[1:] else parts[0]


def check(path: FieldPath, message: str) -> list[JsonValue]:
    """Return the same for the runtime of expressions, empty where every value counts."""
    found: list[JsonValue] = []
    for beside, values in _known(path, message):
        if beside == path:
            found += values
        elif not any(isinstance(step, Every) for step in path):  # of a list, each by itself
            found.append([[*map(plain_step, beside)], *values])
    return ["given", *found] if found else []


def _known(path: FieldPath, message: str) -> list[tuple[FieldPath, list[JsonValue]]]:
    """Return the fields of which one must have one of some values, that itself among them."""
    kind, name = kind_of_message(message), message.partition("/")[2]
    if kind is None:
        return []
    field = "".join(pattern(path)).removeprefix(".")
    meaning = kind.model_class.meanings(None).get(name, {}).get(field, Meaning())
    found: list[tuple[FieldPath, list[JsonValue]]] = [
        (path, [not value]) for value in meaning.silent or () if isinstance(value, bool)
    ]
    for one in meaning.known:
        if not isinstance(one, tuple):
            found.append((path, [one]))
            continue
        beside, values = str(one[0]), list[JsonValue](one[1:])
        around = path[:-1] if beside.startswith(".") else ()
        found.append(((*around, Attribute(beside.removeprefix("."))), values))
    return found
