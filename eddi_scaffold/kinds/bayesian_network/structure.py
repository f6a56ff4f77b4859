"""Which nodes of a network can matter, and which of them belong together.

Sets of nodes are bits of an int: fast, and without an order that a hash seed could change.
"""

from __future__ import annotations

from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from typing import NamedTuple

from eddi_scaffold.kinds.bayesian_network.network import Network, node_attributes


class Shape(NamedTuple):
    """A network without its numbers: all that the cost of inference depends on."""

    names: tuple[str, ...]  # of the nodes, in file order
    cards: tuple[int, ...]  # number of states of each node
    # numbers of the parents of each node, in the order of its table
    parents: tuple[tuple[int, ...], ...]

    def family(self, node: int) -> tuple[int, ...]:
        """Return the axes of the table of a node."""
        return (*self.parents[node], node)


class NumberedNetwork(NamedTuple):
    """A network with its numbers."""

    shape: Shape
    states: tuple[tuple[str, ...], ...]
    # P(node | parents) of each node: first parent slowest, own state fastest
    tables: tuple[tuple[float, ...], ...]
    attributes: tuple[str, ...]  # identifier of each node: its method is `node_<attribute>`


class Component(NamedTuple):
    """Nodes whose probabilities depend on each other for some evidence; nothing else does."""

    nodes: tuple[int, ...]  # numbers of those whose tables belong here, ascending
    inputs: tuple[int, ...]  # those that may be observed
    outputs: tuple[int, ...]  # those whose posterior is asked for
    # nodes observed in each step: their states select numbers, tables have no axis for them, and
    # what only they connect falls apart
    always_observed: tuple[int, ...] = ()


def numbered(network: Network) -> NumberedNetwork:
    """Return a network by numbers of its nodes."""
    number = {name: k for k, name in enumerate(network.names())}
    nodes = network.nodes
    cards = tuple(len(node.states) for node in nodes)
    parents = tuple(tuple(number[parent] for parent in node.parents) for node in nodes)
    return NumberedNetwork(
        Shape(tuple(number), cards, parents),
        tuple(node.states for node in nodes),
        tuple(node.table for node in nodes),
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
    relevant, waiting = 0, [*outputs, *observable]
    while waiting:
        node = waiting.pop()
        if not relevant >> node & 1:
            relevant |= 1 << node
            waiting += shape.parents[node]
    return _split(shape, tuple(bits(relevant)), {*observable}, {*outputs})


def with_all_observed(shape: Shape, part: Component) -> tuple[Component, ...]:
    """Split a part for the steps in which each of its inputs is observed.

    An input that is an output too keeps its axis: its row gives the probabilities of its states.
    """
    fixed = frozenset(part.inputs).difference(part.outputs)
    return _split(shape, part.nodes, part.inputs, part.outputs, fixed)


def _split(
    shape: Shape,
    nodes: Sequence[int],
    inputs: Collection[int],
    outputs: Collection[int],
    fixed: frozenset[int] = frozenset(),
) -> tuple[Component, ...]:
    """Group nodes whose tables share a node that is not observed in each step."""
    joined_with = [*range(len(shape.cards))]

    def root(node: int) -> int:
        while joined_with[node] != node:
            joined_with[node] = joined_with[joined_with[node]]
            node = joined_with[node]
        return node

    # A table belongs to any of its nodes that are not fixed: they are all in one group.
    member_of: dict[int, int] = {}
    for node in nodes:
        free = [member for member in shape.family(node) if member not in fixed]
        member_of[node] = free[0] if free else node
        for member in free[1:]:
            first, second = sorted((root(free[0]), root(member)))
            joined_with[second] = first
    groups: dict[int, list[int]] = {}
    for node in nodes:
        groups.setdefault(root(member_of[node]), []).append(node)
    return tuple(
        Component(
            tuple(group),
            tuple(node for node in group if node in inputs and node not in fixed),
            tuple(node for node in group if node in outputs),
            tuple(sorted(fixed & {member for node in group for member in shape.family(node)})),
        )
        for _, group in sorted(groups.items())
    )
