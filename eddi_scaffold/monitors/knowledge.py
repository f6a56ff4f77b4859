"""Which values of a monitor's message state what it knows: any other one is UNKNOWN for a reader.

A message tells that a claim is not made, but rarely that it is known not to hold. Who took the one
for the other, and read it through NOT, would claim something because a sensor is silent.
"""

from __future__ import annotations

from eddi_scaffold.claims import Meaning
from eddi_scaffold.config.fields import Attribute, Every, FieldPath, expression, pattern, plain_step
from eddi_scaffold.escaping import python_literal
from eddi_scaffold.kinds import JsonValue, Kind, Model, kinds


def kind_of_message(type_: str) -> Kind[Model] | None:
    """Return the kind whose monitors publish a message type, ``None`` for other types."""
    package, _, name = type_.partition("/")
    if package != "eddi_messages":
        return None
    return next((kind for kind in kinds().values() if name in kind.all_messages), None)


def taken(argument: str, path: FieldPath, message: str) -> str:
    """Return the Python expression that takes a field of a message, where that is known."""
    parts = [expression(argument, path)]
    for beside, values in _known(path, message):
        literals = [python_literal(one) for one in values]
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
    meaning = kind.functions.meanings(None, None).get(name, {}).get(field, Meaning())
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
