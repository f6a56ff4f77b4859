"""The join tree of a part of a network: in which order tables are multiplied and summed.

A binary tree (Shenoy 1997, "Binary join trees for computing marginals in the Shenoy-Shafer
architecture"): leaves are the tables of the nodes, the evidence vectors and one place for each
output; each inner node joins two. All is symbolic here: no number is touched, so a network that is
far too wide is recognised without allocating anything.

The order is found greedily: the pair whose result is smallest, less what it replaces (Gray &
Kourtis 2021, "Hyper-optimized tensor network contraction", section 4.1). Some fixed pseudo-random
weightings and two orders of elimination are tried and the cheapest tree is kept. Costs are whole
numbers and ties go by index: the same network gives the same tree on every machine.

The orders of elimination are the two classic greedy rules (Koller & Friedman 2009, section
9.4.3.2): the node whose elimination adds the fewest edges to the graph, or makes the smallest
table. They see the graph as a whole and find narrower orders than the joining of pairs when tables
are large.
"""

from __future__ import annotations

import heapq
import random
from collections.abc import Callable, Collection, Sequence
from itertools import islice
from typing import NamedTuple

from eddi_scaffold.kinds.bayesian_network.structure import Component, Shape, bits, mask_of, size_of

TABLE, EVIDENCE, UNIT = "table", "evidence", "unit"
_SMALL = 64
"""Entries up to which two constant tables are joined in advance in any case."""
_TRIALS = 1_200
"""Leaves that are tried in all; a large network gets fewer trials."""
_PAIRS = 6_000
_MOST, _LEAST = 24, 8
"""How many partners of a table are compared: a node with a thousand children is no reason for
comparing each of their tables with each."""
_GAINS = (256, 77)
"""In 256ths: how much the size of the replaced tables counts; neither is best for all networks."""


class Leaf(NamedTuple):
    """A leaf of the tree.

    Attributes:
        kind: ``table``: the probabilities of a node; ``evidence``: what was seen of it, with its
            prior if it is a root that is no output; ``unit``: the place of an output.
        node: number of the node.
        mask: the nodes that it has an axis for.
        seen: the observable nodes whose states select its numbers.
    """

    kind: str
    node: int
    mask: int
    seen: int


class Tree(NamedTuple):
    """A binary join tree.

    Attributes:
        leaves: numbers 0 to n - 1 of the tree.
        joins: the two below each further number.
        masks: nodes on both sides of the edge above each number.
        top: the two numbers that the last edge connects; equal when there is one leaf only.
    """

    leaves: tuple[Leaf, ...]
    joins: tuple[tuple[int, int], ...]
    masks: tuple[int, ...]
    top: tuple[int, int]


def make_leaves(shape: Shape, part: Component, narrow: int = 0) -> tuple[Leaf, ...]:
    """Return the leaves of a part.

    Tables with narrow nodes depend on their states, too, although they have an axis for them.
    The prior of an observable root goes with its evidence, so that it cancels exactly when the
    node is observed.
    """
    inputs, outputs, given = set(part.inputs), set(part.outputs), mask_of(part.given)
    leaves = []
    for node in part.nodes:
        if node in outputs or node not in inputs or shape.parents[node]:
            family = mask_of((*shape.parents[node], node))
            leaves.append(Leaf(TABLE, node, family & ~given, family & (given | narrow)))
    leaves += [Leaf(EVIDENCE, node, 1 << node, 1 << node) for node in part.inputs]
    leaves += [Leaf(UNIT, node, 1 << node, 0) for node in part.outputs if node not in inputs]
    return tuple(leaves)


def find_tree(
    shape: Shape,
    part: Component,
    cost: Callable[[Tree], int],
    trials: int = 8,
    narrow: Collection[int] = (),
) -> Tree:
    """Return the cheapest tree of a fixed number of trials.

    Args:
        shape: the network.
        part: one of its components.
        cost: of a tree; smaller is better.
        trials: 50 trials find trees with 20 % fewer operations than 8, in six times the time;
            large parts get fewer.
        narrow: inputs that mostly have no axis.
    """
    leaves = make_leaves(shape, part, mask_of(narrow))
    cards = tuple(1 if node in narrow else card for node, card in enumerate(shape.cards))
    trees = []
    for trial in range(max(1, min(trials, _TRIALS // len(leaves)))):
        weight = random.Random(trial).random if trial else None  # noqa: S311 - no secret
        search = _Search(leaves, cards, weight, gain=_GAINS[trial % 2])
        _join_while(search, constants_only=True)
        while len(search.active) > 2:  # once, unless there are more partners than are compared
            _join_while(search, constants_only=False)
        trees.append(search.tree())
    masks = [leaf.mask for leaf in leaves]
    for rule in (fewest_edges, smallest_table):
        order = elimination_order(masks, cards, rule)
        search = _Search(leaves, cards, None, gain=_GAINS[0])
        trees.append(_by_elimination(search, order))
    return min(trees, key=cost)  # the first of equals


class _Search:
    """The state of one greedy search."""

    def __init__(
        self,
        leaves: Sequence[Leaf],
        cards: Sequence[int],
        weight: Callable[[], float] | None,
        *,
        gain: int,
    ) -> None:
        self.leaves = leaves
        self.cards = cards
        self.gain = gain
        self.weight = weight
        self.most = max(_LEAST, min(_MOST, _PAIRS // len(leaves)))
        self.masks = [leaf.mask for leaf in leaves]
        self.constant = [leaf.kind == TABLE and not leaf.seen for leaf in leaves]
        self.joins: list[tuple[int, int]] = []
        self.active = dict.fromkeys(range(len(leaves)))
        self.holders: dict[int, list[int]] = {}
        for number, mask in enumerate(self.masks):
            for node in bits(mask):
                self.holders.setdefault(node, []).append(number)
        self.sizes: dict[int, int] = {}

    def size(self, mask: int) -> int:
        found = self.sizes.get(mask)
        if found is None:
            found = self.sizes[mask] = size_of(mask, self.cards)
        return found

    def outside(self, one: int, other: int) -> int:
        """Return the nodes of a joined pair that something else has as well."""
        kept = 0
        for node in bits(self.masks[one] | self.masks[other]):
            if any(holder not in (one, other) for holder in self.holders[node]):
                kept |= 1 << node
        return kept

    def join(self, one: int, other: int) -> int:
        mask, number = self.outside(one, other), len(self.masks)
        for node in bits(self.masks[one] | self.masks[other]):
            holders = self.holders[node]
            holders[:] = [holder for holder in holders if holder not in (one, other)]
            if mask >> node & 1:
                holders.append(number)
        del self.active[one], self.active[other]
        self.active[number] = None
        self.masks.append(mask)
        self.constant.append(self.constant[one] and self.constant[other])
        self.joins.append((one, other))
        return number

    def partners(self, number: int, *, only_later: bool) -> list[int]:
        first = number if only_later else -1
        found = {
            one
            for node in bits(self.masks[number])
            for one in islice((h for h in self.holders[node] if h > first), self.most + 1)
        }
        found.discard(number)
        return sorted(found)[: self.most]

    def joint(self, one: int, other: int) -> int:
        return self.size(self.masks[one] | self.masks[other])

    def score(self, one: int, other: int) -> int:
        gain = self.size(self.masks[one]) + self.size(self.masks[other])
        factor = 256 if self.weight is None else 64 + int(self.weight() * 384)
        return self.size(self.outside(one, other)) * factor - gain * self.gain

    def tree(self) -> Tree:
        left = list(self.active)
        masks = tuple(self.masks)
        return Tree(tuple(self.leaves), tuple(self.joins), masks, (left[0], left[-1]))


def _by_elimination(search: _Search, order: Sequence[int]) -> Tree:
    _join_while(search, constants_only=True)
    for node in order:
        while len(search.holders[node]) > 1 and len(search.active) > 2:
            holders = search.holders[node][: search.most]  # ascending: a new number is the largest
            pairs = ((holder, other) for holder in holders for other in holders if holder < other)
            search.join(*min(pairs, key=lambda pair: (search.joint(*pair), pair)))
    return search.tree()


def _join_while(search: _Search, *, constants_only: bool) -> None:
    heap: list[tuple[int, int, int]] = []

    def offer(number: int, *, all_partners: bool) -> None:
        if constants_only and not search.constant[number]:
            return
        for other in search.partners(number, only_later=not all_partners):
            if search.constant[other] or not constants_only:
                heapq.heappush(heap, (search.score(number, other), number, other))

    for number in list(search.active):
        offer(number, all_partners=False)
    while heap and len(search.active) > 2:
        _, one, other = heapq.heappop(heap)
        if one not in search.active or other not in search.active:
            continue
        if constants_only:
            replaced = search.size(search.masks[one]) + search.size(search.masks[other])
            if search.size(search.outside(one, other)) > max(_SMALL, replaced):
                continue
        offer(search.join(one, other), all_partners=True)


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
