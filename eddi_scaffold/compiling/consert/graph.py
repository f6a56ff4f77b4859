"""The graph of a ConSert: one node per id, in an order in which inputs come before their users.

A directed acyclic graph is never expanded to trees, so shared gates cost once, and everything
here is a loop, so that a chain of any length is no recursion.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

from eddi_scaffold.compiling.consert.model import ConSertData
from eddi_scaffold.compiling.document import ModelError


class Node(NamedTuple):
    """An And or Or over other nodes; without inputs an And is TRUE and an Or is FALSE.

    Attributes:
        is_and: And, else Or. A guarantee is an And.
        inputs: numbers of the nodes it reads, in edge order.
    """

    is_and: bool
    inputs: tuple[int, ...]


@dataclass(frozen=True)
class Graph:
    """Nodes by number: first the leaves (numbers of the inputs), then gates and guarantees.

    Attributes:
        names: number -> id.
        leaves: how many of the nodes are leaves.
        nodes: gates and guarantees in topological order; node ``k`` has number ``leaves + k``.
        guarantees: numbers of the guarantees in file order.
        unsupported: ids of guarantees without support that are not default, of default guarantees
            with support, and of needed gates without input: constants that no author meant.
        needed: numbers of the nodes that some guarantee depends on.
    """

    names: tuple[str, ...]
    leaves: int
    nodes: tuple[Node, ...]
    guarantees: tuple[int, ...]
    unsupported: tuple[str, ...]
    needed: frozenset[int]


def build_graph(data: ConSertData) -> Graph:
    """Number the elements of a ConSert and check that the edges make a graph without cycle.

    Ties are broken by first appearance in the file, so the same file gives the same code.

    Raises:
        ModelError: an edge names nothing, leads into a leaf, or closes a cycle.
    """
    leaves = [leaf.id for leaf in data.leaves]
    inner = [*data.gates, *(g.id for g in data.guarantees)]
    inputs = _inputs_of(data.edges, set(leaves), inner)
    order = _topological(leaves, inner, inputs)
    names = (*leaves, *order)
    number = {name: k for k, name in enumerate(names)}
    nodes = tuple(
        Node(data.gates.get(name, True), tuple(number[source] for source in inputs[name]))
        for name in order
    )
    guarantees = tuple(number[g.id] for g in data.guarantees)
    needed = _needed(guarantees, nodes, len(leaves))
    default = {g.id: g.default for g in data.guarantees}
    # Without support: wrong for a gate and a common guarantee, right for a default guarantee.
    unsupported = tuple(
        name
        for name in inner
        if number[name] in needed and bool(inputs[name]) == default.get(name, False)
    )
    return Graph(names, len(leaves), nodes, guarantees, unsupported, needed)


def _needed(guarantees: tuple[int, ...], nodes: tuple[Node, ...], leaves: int) -> frozenset[int]:
    needed = set(guarantees)
    for k in range(leaves + len(nodes) - 1, leaves - 1, -1):
        if k in needed:
            needed.update(nodes[k - leaves].inputs)
    return frozenset(needed)


def _inputs_of(
    edges: Sequence[tuple[str, str]], leaves: set[str], inner: list[str]
) -> dict[str, list[str]]:
    inputs: dict[str, list[str]] = {name: [] for name in inner}
    for source, target in edges:
        if target in leaves:
            raise ModelError("", f"an edge leads into {target!r}, which is evidence or a demand")
        for end in (source, target):
            if end not in inputs and end not in leaves:
                raise ModelError("", f"an edge names {end!r}, which does not exist")
        inputs[target].append(source)
    return inputs


def _topological(leaves: list[str], inner: list[str], inputs: dict[str, list[str]]) -> list[str]:
    users: dict[str, list[str]] = {name: [] for name in (*leaves, *inner)}
    waiting = {name: len(inputs[name]) for name in inner}
    for name in inner:
        for source in inputs[name]:
            users[source].append(name)
    for name in leaves:
        for user in users[name]:
            waiting[user] -= 1
    ready = [name for name in inner if waiting[name] == 0]
    order: list[str] = []
    while len(order) < len(ready):
        name = ready[len(order)]
        order.append(name)
        for user in users[name]:
            waiting[user] -= 1
            if waiting[user] == 0:
                ready.append(user)
    if len(order) < len(inner):
        left = next(name for name in inner if waiting[name] > 0)
        raise ModelError("", f"the edges close a cycle that {left!r} is on or waits for")
    return order
