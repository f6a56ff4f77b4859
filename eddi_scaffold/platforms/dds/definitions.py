"""The messages of ROS 2 that a node needs; types match by name alone, so all must be known."""

from __future__ import annotations

from collections.abc import Iterator

from eddi_scaffold.config.message_types import (
    Fields,
    MessageFields,
    element,
    is_primitive,
)
from eddi_scaffold.kinds import JsonValue
from eddi_scaffold.monitors.nodes import MonitorNode
from eddi_scaffold.platforms.dds.hashes import type_hash
from eddi_scaffold.problems import Place, Problem, error


def definitions_of(
    node: MonitorNode, known: MessageFields
) -> tuple[list[JsonValue], list[Problem]]:
    """Return the types of a node, each after those that it is made of, and those that lack (K070).

    Args:
        node: of the monitor.
        known: type -> its fields.
    """
    problems: list[Problem] = []
    found: dict[str, Fields] = {}
    places = {
        one.type: node.config.place("SimulatorOutputs", index, "type")
        for index, one in enumerate(node.config.config.SimulatorOutputs)
    }
    for type_ in _wanted(node):
        for name in with_parts(type_, known):
            if name in known:
                found.setdefault(name, known[name])
                continue
            message = f"{name} is not known in ROS 2"
            if name != type_:
                message += f", and {type_} is made of it"
            hint = "write its fields under MessageTypes, as the graph has them"
            problems.append(error("K070", message, places.get(type_, Place()), hint))
    written = [
        {"name": name, "fields": ", ".join(f"{of} {field}" for field, of in fields.items())}
        for name, fields in found.items()
    ]
    return [*written], problems


def hashes_of(node: MonitorNode, known: MessageFields) -> list[JsonValue]:
    """Return the types of the node's topics with their hashes; the unknown are refused anyway."""
    whole = [one for one in sorted(_wanted(node)) if known.keys() >= set(with_parts(one, known))]
    return [{"name": one, "hash": type_hash(one, known)} for one in whole]


def _wanted(node: MonitorNode) -> dict[str, None]:
    """Return the types of the node's topics, each once."""
    types = [one.type for one in node.heard] + [one.type for one in node.found]
    return dict.fromkeys([*types, *node.between_robots.values()])


def with_parts(type_: str, known: MessageFields, above: tuple[str, ...] = ()) -> Iterator[str]:
    """Yield the types that a type is made of, then itself; a type inside itself is not known."""
    for of in known.get(type_, {}).values():
        name = element(of) or of
        if name in above:
            yield f"{name} in itself"
        elif not is_primitive(name):
            yield from with_parts(name, known, (*above, type_))
    yield type_
