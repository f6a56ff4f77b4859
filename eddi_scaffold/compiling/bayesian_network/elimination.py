"""In which order to sum out the nodes of a wide network.

The two classic greedy rules (Koller & Friedman 2009, section 9.4.3.2): the node whose elimination
adds the fewest edges to the graph, or makes the smallest table. They see the graph as a whole and
find narrower orders than the joining of pairs when tables are large.
"""

from __future__ import annotations

import heapq
from collections.abc import Callable, Sequence

from eddi_scaffold.compiling.bayesian_network.graph import bits, size_of

_WIDE = 64
"""Neighbours beyond which no table over them can be made: they need not be counted one by one."""
Rule = Callable[[int, dict[int, int], Sequence[int]], int]


def fewest_edges(node: int, around: dict[int, int], cards: Sequence[int]) -> int:
    """Return how many edges the elimination of a node adds, twice, weighted by their tables."""
    mask = around[node]
    count = (mask).bit_count()
    if count > _WIDE:
        return 1 << count
    added = 0
    for other in bits(mask):
        missing = mask & ~around[other] & ~(1 << other)
        added += cards[other] * sum(cards[bit] for bit in bits(missing))
    return added


def smallest_table(node: int, around: dict[int, int], cards: Sequence[int]) -> int:
    """Return the entries of the table that the elimination of a node needs."""
    return size_of(around[node] | 1 << node, cards)


def elimination_order(masks: Sequence[int], cards: Sequence[int], rule: Rule) -> tuple[int, ...]:
    """Return the nodes of some tables in a good order; ties go to the lower number.

    Args:
        masks: the nodes of each table.
        cards: number of states of each node.
        rule: the node with the smallest value is next.
    """
    around: dict[int, int] = {}
    for mask in masks:
        for node in bits(mask):
            around[node] = around.get(node, 0) | mask & ~(1 << node)
    price = {node: rule(node, around, cards) for node in sorted(around)}
    cheapest = [(value, node) for node, value in price.items()]
    heapq.heapify(cheapest)
    order: list[int] = []
    while price:
        value, node = heapq.heappop(cheapest)
        if price.get(node) != value:
            continue  # eliminated, or priced anew since
        order.append(node)
        del price[node]
        for other in bits(_without(node, around)):
            price[other] = rule(other, around, cards)
            heapq.heappush(cheapest, (price[other], other))
    return tuple(order)


def _without(node: int, around: dict[int, int]) -> int:
    """Take a node out and connect its neighbours; return the nodes whose price may be another."""
    near = around.pop(node)
    changed, added = near, False
    for other in bits(near):
        before = around[other] & ~(1 << node)
        around[other] = (before | near) & ~(1 << other)
        added = added or around[other] != before
    for other in bits(near) if added else ():
        changed |= around[other]
    return changed
