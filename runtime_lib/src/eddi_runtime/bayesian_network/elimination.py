"""In which order to sum out the nodes of a wide network.

The two classic greedy rules (Koller & Friedman 2009, section 9.4.3.2): the node whose elimination
adds the fewest edges to the graph, or makes the smallest table. They see the graph as a whole and
find narrower orders than the joining of pairs when tables are large.
"""

from __future__ import annotations

from typing import Callable, Dict, List, Sequence, Tuple

from .graph import bits, size_of

Rule = Callable[[int, Dict[int, int], Sequence[int]], int]


def fewest_edges(node: int, around: Dict[int, int], cards: Sequence[int]) -> int:
    """Return how many edges the elimination of a node adds, twice, weighted by their tables."""
    mask = around[node]
    added = 0
    for other in bits(mask):
        missing = mask & ~around[other] & ~(1 << other)
        added += cards[other] * sum(cards[one] for one in bits(missing))
    return added


def smallest_table(node: int, around: Dict[int, int], cards: Sequence[int]) -> int:
    """Return the entries of the table that the elimination of a node needs."""
    return size_of(around[node] | 1 << node, cards)


def elimination_order(masks: Sequence[int], cards: Sequence[int], rule: Rule) -> Tuple[int, ...]:
    """Return the nodes of some tables in a good order; ties go to the lower number.

    Args:
        masks: the nodes of each table.
        cards: number of states of each node.
        rule: the node with the smallest value is next.
    """
    around: Dict[int, int] = {}
    for mask in masks:
        for node in bits(mask):
            around[node] = around.get(node, 0) | mask & ~(1 << node)
    price = {node: rule(node, around, cards) for node in sorted(around)}
    order: List[int] = []
    while price:
        node = min(price, key=lambda one: (price[one], one))
        order.append(node)
        del price[node]
        near = around.pop(node)
        changed = 0
        for other in bits(near):
            around[other] = (around[other] | near) & ~(1 << other) & ~(1 << node)
            changed |= around[other] | 1 << other
        for other in bits(changed):
            price[other] = rule(other, around, cards)
    return tuple(order)
