"""Which nodes of a network can matter, and which of them belong together.

Sets of nodes are bits of an int: fast, and without an order that a hash seed could change.
"""

from __future__ import annotations

from typing import Iterable, Iterator, List, NamedTuple, Sequence, Tuple


class Shape(NamedTuple):
    """A network without its numbers: all that the cost of inference depends on.

    Attributes:
        names: of the nodes, in file order.
        cards: number of states of each node.
        parents: numbers of the parents of each node, in the order of its table.
    """

    names: Tuple[str, ...]
    cards: Tuple[int, ...]
    parents: Tuple[Tuple[int, ...], ...]


class Component(NamedTuple):
    """Nodes whose probabilities depend on each other for some evidence; nothing else does.

    Attributes:
        nodes: numbers, ascending.
        inputs: those that may be observed.
        outputs: those whose posterior is wanted.
    """

    nodes: Tuple[int, ...]
    inputs: Tuple[int, ...]
    outputs: Tuple[int, ...]


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


def size_of(mask: int, cards: Sequence[int]) -> int:
    """Return the number of entries of a table over a set of nodes."""
    size = 1
    while mask:
        low = mask & -mask
        size *= cards[low.bit_length() - 1]
        mask ^= low
    return size


def components(
    shape: Shape, outputs: Sequence[int], observable: Sequence[int]
) -> Tuple[Component, ...]:
    """Split a network into parts that no evidence connects.

    Descendants that are neither observable nor an output sum to one and are left out ("barren"
    nodes). The rest falls into the connected parts of the moral graph: the probability of the
    evidence is the product over the parts, so each is inferred for itself, and a contradiction is
    found in a part without outputs as well.
    """
    wanted = _with_ancestors(shape, [*outputs, *observable])
    part = list(range(len(shape.cards)))

    def find(node: int) -> int:
        while part[node] != node:
            part[node] = part[part[node]]
            node = part[node]
        return node

    for node in bits(wanted):
        for parent in shape.parents[node]:
            one, other = sorted((find(node), find(parent)))
            part[other] = one
    groups: List[List[int]] = [[] for _ in part]
    for node in bits(wanted):
        groups[find(node)].append(node)
    seen, asked = set(observable), set(outputs)
    return tuple(
        Component(
            nodes=tuple(group),
            inputs=tuple(node for node in group if node in seen),
            outputs=tuple(node for node in group if node in asked),
        )
        for group in groups
        if group
    )


def _with_ancestors(shape: Shape, nodes: Sequence[int]) -> int:
    found, todo = 0, list(nodes)
    while todo:
        node = todo.pop()
        if not found >> node & 1:
            found |= 1 << node
            todo.extend(shape.parents[node])
    return found
