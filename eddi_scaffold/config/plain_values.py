"""Nodes of a YAML document as plain values, with the place of each."""

from __future__ import annotations

from typing import Any

from eddi_scaffold.config.file import KEY
from eddi_scaffold.positioned_yaml.nodes import (
    Items,
    Map,
    Node,
    differs_between_versions,
    number_for_11,
    value_11,
)
from eddi_scaffold.problems import Place, Problem, warning

Places = dict[tuple[str | int, ...], Place]
"""Path of a value -> its place; with KEY at the end, that of its key."""


def plain_values(
    node: Node, places: Places, problems: list[Problem], path: tuple[str | int, ...] = ()
) -> Any:
    """Turn a node graph into plain values of YAML 1.1; note the place of each.

    Args:
        node: where to begin.
        places: gets the places.
        problems: gets what YAML 1.1 and 1.2 read differently (K008).
        path: of the node.
    """
    places[path] = node.place
    if isinstance(node, Map):
        result = {}
        for key, value in node.entries:
            inner = (*path, key.text)
            result[key.text] = plain_values(value, places, problems, inner)
            places[(*inner, KEY)] = key.place
            if isinstance(value, Map | Items):
                places[inner] = key.place
        return result
    if isinstance(node, Items):
        return [
            plain_values(item, places, problems, (*path, i)) for i, item in enumerate(node.items)
        ]
    if differs_between_versions(node):
        value = value_11(node)
        number = number_for_11(node) if isinstance(value, str) else None
        read = repr(value) if number is None else f"the text {value!r}"
        message = f"{node.text!r} is read as {read} (YAML 1.1)"
        hint = "write it in quotes if a text is meant"
        hint = hint if number is None else f"write {number} for the number, or quotes for the text"
        problems.append(warning("K008", message, node.place, hint))
    return value_11(node)
