"""What a person has still to decide in a configuration that ``connect`` drafted."""

from __future__ import annotations

from collections.abc import Iterator

from eddi_scaffold.common.problems import Place, Problem, problem
from eddi_scaffold.kinds import TODO
from eddi_scaffold.yaml_text.nodes import Items, Map, Node, as_text

_AGE = "write seconds, about 2.5 periods of the topic, or give `connect` a recording: --bag"
_OTHER = "write it in place of TODO; comments of `connect` say what fits"


def undecided(root: Node) -> list[Problem]:
    """Return an error for each value that is still the word TODO, without quotes (K059)."""
    return [
        problem("K059", place, hint=_AGE if name.endswith("max_age") else _OTHER, name=name)
        for name, place in _open(root, "")
    ]


def _open(node: Node, name: str) -> Iterator[tuple[str, Place]]:
    """Yield name and place of each value; an entry of a list is called by its id."""
    if isinstance(node, Map):
        for key, value in node.entries:
            yield from _open(value, f"{name}.{key.text}" if name else key.text)
    elif isinstance(node, Items):
        for item in node.items:
            id_ = as_text(item.get("id") or item) if isinstance(item, Map) else None
            yield from _open(item, f"{name}.{id_}" if id_ else name)
    elif node.plain and node.text == TODO:
        yield name, node.place
