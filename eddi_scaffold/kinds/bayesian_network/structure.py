"""Which nodes of a network can matter, and which of them belong together.

Sets of nodes are bits of an int: fast, and without an order that a hash seed could change.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from typing import NamedTuple

from eddi_scaffold.kinds.bayesian_network.network import Network, node_attributes


class Shape(NamedTuple):
    """A network without its numbers: all that the cost of inference depends on.

    Attributes:
        names: of the nodes, in file order.
        cards: number of states of each node.
        parents: numbers of the parents of each node, in the order of its table.
    """

    names: tuple[str, ...]
    cards: tuple[int, ...]
    parents: tuple[tuple[int, ...], ...]


class NumberedNetwork(NamedTuple):
    """A network with its numbers.

    Attributes:
        shape: names, numbers of states, parents.
        states: names of the states of each node.
        tables: P(node | parents) of each node: first parent slowest, own state fastest.
        attributes: identifier of each node: its method is ``node_<attribute>``.
    """

    shape: Shape
    states: tuple[tuple[str, ...], ...]
    tables: tuple[tuple[float, ...], ...]
    attributes: tuple[str, ...]


class Component(NamedTuple):
    """Nodes whose probabilities depend on each other for some evidence; nothing else does.

    Attributes:
        nodes: numbers of those whose tables belong here, ascending.
        inputs: those that may be observed.
        outputs: those whose posterior is wanted.
        given: nodes observed in each step: their states select numbers, tables have no axis for
            them, and what only they connect falls apart.
    """

    nodes: tuple[int, ...]
    inputs: tuple[int, ...]
    outputs: tuple[int, ...]
    given: tuple[int, ...] = ()


def shape_of(network: Network) -> Shape:
    """Return a network by numbers of its nodes, without its tables."""
    number = {name: k for k, name in enumerate(network.names())}
    return Shape(
        tuple(number),
        tuple(len(node.states) for node in network.nodes),
        tuple(tuple(number[parent] for parent in node.parents) for node in network.nodes),
    )


def numbered(network: Network) -> NumberedNetwork:
    """Return a network by numbers of its nodes."""
    return NumberedNetwork(
        shape_of(network),
        tuple(node.states for node in network.nodes),
        tuple(node.table for node in network.nodes),
        tuple(node_attributes(network).values()),
    )


def bits(mask: int) -> Iterator[int]:
    """Yield the numbers in a set, ascending."""
    while mask:
        low = mask & -mask
        yield low.bit_length() - 1
        mask ^= low


def mask_of(numbers: Iterable[int]) -> int:
    """Return the set of some numbers."""
    mask = 0
    for number in numbers:
        mask |= 1 << number
    return mask


def size_of(mask: int, cards: Sequence[int] | Mapping[int, int]) -> int:
    """Return the number of entries of a table over a set of nodes."""
    size = 1
    while mask:
        low = mask & -mask
        size *= cards[low.bit_length() - 1]
        mask ^= low
    return size


def components(
    shape: Shape, outputs: Sequence[int], observable: Sequence[int]
) -> tuple[Component, ...]:
    """Split a network into parts that no evidence connects.

    Descendants that are neither observable nor an output sum to one and are left out ("barren"
    nodes). The rest falls into the connected parts of the moral graph: the probability of the
    evidence is the product over the parts, so each is inferred for itself, and a contradiction is
    found in a part without outputs as well.
    """
    wanted = tuple(bits(_with_ancestors(shape, [*outputs, *observable])))
    seen, asked = set(observable), set(outputs)
    return tuple(
        Component(
            nodes=group,
            inputs=tuple(node for node in group if node in seen),
            outputs=tuple(node for node in group if node in asked),
        )
        for group in _groups(shape, wanted, frozenset())
    )


def with_all_observed(shape: Shape, part: Component) -> tuple[Component, ...]:
    """Split a part for the steps in which each of its inputs is observed.

    An input that is an output too keeps its axis: its row gives the probabilities of its states.
    """
    given = frozenset(part.inputs).difference(part.outputs)
    return tuple(
        Component(
            nodes=group,
            inputs=tuple(n for n in group if n in part.inputs and n not in given),
            outputs=tuple(n for n in group if n in part.outputs),
            given=tuple(
                sorted(
                    given.intersection(
                        one for node in group for one in (node, *shape.parents[node])
                    )
                )
            ),
        )
        for group in _groups(shape, part.nodes, given)
    )


def _groups(shape: Shape, nodes: Sequence[int], given: frozenset[int]) -> list[tuple[int, ...]]:
    """Return nodes whose tables share a node, other than the given ones, in groups."""
    part = list(range(len(shape.cards)))

    def find(node: int) -> int:
        while part[node] != node:
            part[node] = part[part[node]]
            node = part[node]
        return node

    # A table belongs to any of its nodes that are not given: they are all in one group.
    homes: dict[int, int] = {}
    for node in nodes:
        free = [one for one in (node, *shape.parents[node]) if one not in given]
        homes[node] = free[0] if free else node
        for one in free[1:]:
            first, second = sorted((find(free[0]), find(one)))
            part[second] = first
    groups: dict[int, list[int]] = {}
    for node in nodes:
        groups.setdefault(find(homes[node]), []).append(node)
    return [tuple(groups[first]) for first in sorted(groups)]


def _with_ancestors(shape: Shape, nodes: Sequence[int]) -> int:
    found, todo = 0, list(nodes)
    while todo:
        node = todo.pop()
        if not found >> node & 1:
            found |= 1 << node
            todo.extend(shape.parents[node])
    return found
