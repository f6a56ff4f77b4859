"""The join tree of a part of a network: in which order tables are multiplied and summed.

A binary tree (Shenoy 1997, "Binary join trees for computing marginals in the Shenoy-Shafer
architecture"): leaves are the tables of the nodes, the evidence vectors and one place for each
output; each inner node joins two. No number of a table is touched, so a network that is far too
wide is recognised without allocating anything.

The order is found greedily: the pair whose result is smallest, less what it replaces (Gray &
Kourtis 2021, "Hyper-optimized tensor network contraction", section 4.1), in some trials with fixed
pseudo-random weights. Costs are whole numbers and ties go by index: the same network gives the same
tree on every machine.
"""

from __future__ import annotations

import heapq
import random
from collections.abc import Callable, Iterator, Sequence
from functools import cache, partial
from itertools import islice
from typing import NamedTuple

from eddi_scaffold.kinds.bayesian_network.network import Component, Shape, bits, mask_of, size_of

TABLE, EVIDENCE, PRIOR, UNIT = "table", "evidence", "prior", "unit"
_SMALL = 64  # Entries up to which two constant tables are joined in advance in any case
_TRIALS = 8  # 50 find trees with 20 % fewer operations, in six times the time
_LEAVES_IN_ALL_TRIALS = 1_200  # A large network gets fewer trials
_PAIRS = 6_000
_MOST, _LEAST = 24, 8
"""How many partners of a table are compared: a node with a thousand children is no reason for
comparing each of their tables with each."""
_GAINS = (256, 77)
"""In 256ths: how much the size of the replaced tables counts; neither is best for all networks."""


class Leaf(NamedTuple):
    """A leaf of the tree."""

    # `table`: the probabilities of a node; `evidence`: what was seen of it; `prior`: of a root that
    # is no output, with its prior, which then cancels exactly; `unit`: the place of an output
    kind: str
    node: int  # number of the node
    mask: int  # the nodes that it has an axis for


class Tree(NamedTuple):
    """A binary join tree."""

    leaves: tuple[Leaf, ...]  # numbers 0 to n - 1 of the tree
    joins: tuple[tuple[int, int], ...]  # the two below each further number
    masks: tuple[int, ...]  # nodes on both sides of the edge above each number
    top: tuple[int, int]  # the two numbers that the last edge connects


def trees_of(shape: Shape, part: Component) -> Iterator[Tree]:
    """Yield the trees of some trials."""
    priors = [k for k in part.inputs if not shape.parents[k] and k not in part.outputs]
    own = [Leaf(TABLE, k, mask_of(shape.family(k))) for k in part.nodes if k not in priors]
    own += [Leaf(PRIOR if k in priors else EVIDENCE, k, 1 << k) for k in part.inputs]
    own += [Leaf(UNIT, node, 1 << node) for node in part.outputs if node not in part.inputs]
    leaves = tuple(own)
    for trial in range(max(1, min(_TRIALS, _LEAVES_IN_ALL_TRIALS // len(leaves)))):
        weight = random.Random(trial).random if trial else lambda: 0.5  # noqa: S311 - no secret
        search = _Search(leaves, shape.cards, _GAINS[trial % 2], weight)
        search.join_pairs(constants_only=True)
        while len(search.active) > 2:  # once, unless there are more partners than are compared
            search.join_pairs(constants_only=False)
        yield search.tree()


class _Search:
    """One greedy search: numbers are joined until two are active."""

    def __init__(
        self, leaves: tuple[Leaf, ...], cards: Sequence[int], gain: int, weight: Callable[[], float]
    ) -> None:
        self._leaves, self._gain, self._weight = leaves, gain, weight
        self._size = cache(partial(size_of, cards=cards))
        self._most = max(_LEAST, min(_MOST, _PAIRS // len(leaves)))
        self._masks = [leaf.mask for leaf in leaves]
        self._constant = [leaf.kind == TABLE for leaf in leaves]
        self._joins: list[tuple[int, int]] = []
        self.active = dict.fromkeys(range(len(leaves)))
        self._holders: dict[int, list[int]] = {}
        for number, mask in enumerate(self._masks):
            for node in bits(mask):
                self._holders.setdefault(node, []).append(number)

    def tree(self) -> Tree:
        first, second = self.active
        return Tree(self._leaves, tuple(self._joins), tuple(self._masks), (first, second))

    def join_pairs(self, *, constants_only: bool) -> None:
        """Join the best pair, again and again."""
        heap: list[tuple[int, int, int]] = []

        def offer(number: int, *, from_: int) -> None:
            if constants_only and not self._constant[number]:
                return
            partners = {
                partner
                for node in bits(self._masks[number])
                for partner in islice(
                    (h for h in self._holders[node] if h >= from_), self._most + 1
                )
            }
            for partner in sorted(partners - {number})[: self._most]:
                if self._constant[partner] or not constants_only:
                    replaced = sum(self._size(self._masks[n]) for n in (number, partner))
                    factor = 64 + int(self._weight() * 384)
                    size = self._size(self._outside(number, partner))
                    score = size * factor - replaced * self._gain
                    heapq.heappush(heap, (score, number, partner))

        for number in list(self.active):
            offer(number, from_=number + 1)
        while heap and len(self.active) > 2:
            _, *pair = heapq.heappop(heap)
            if not self.active.keys() >= {*pair}:
                continue
            if constants_only:
                replaced = sum(self._size(self._masks[number]) for number in pair)
                if self._size(self._outside(*pair)) > max(_SMALL, replaced):
                    continue
            offer(self._join(*pair), from_=0)

    def _outside(self, *pair: int) -> int:
        """Return the nodes of a joined pair that something else has as well."""
        first, second = pair
        return mask_of(
            node
            for node in bits(self._masks[first] | self._masks[second])
            if any(holder not in pair for holder in self._holders[node])
        )

    def _join(self, *pair: int) -> int:
        first, second = pair
        mask, number = self._outside(first, second), len(self._masks)
        for node in bits(self._masks[first] | self._masks[second]):
            holders = self._holders[node]
            holders[:] = [holder for holder in holders if holder not in pair]
            if mask >> node & 1:
                holders.append(number)
        del self.active[first], self.active[second]
        self.active[number] = None
        self._masks.append(mask)
        self._constant.append(self._constant[first] and self._constant[second])
        self._joins.append((first, second))
        return number
