"""The sets of a ConSert that has too many of them for ``compiled.py``: searched on the robot.

They are minimal path sets, found by MOCUS (with absorption after each step) over bits of numbers.
"""

from __future__ import annotations

from collections import Counter
from typing import NamedTuple, Sequence

from ..inputs import InputSpec
from ..why import FALSE, TRUE
from .verdicts import Group, Guarantee, Sets

_BUDGET = 2_000_000
"""Comparisons of sets per explanation, about 0.5 s; beyond it nodes keep ``_FEW_SETS`` each."""
_FEW_SETS = 4
_MOST_SETS = 256  # the smallest are kept, and the result is marked as truncated


class Node(NamedTuple):
    """An And or Or over other nodes; without inputs an And is TRUE and an Or is FALSE."""

    is_and: bool  # And, else Or. A guarantee is an And.
    inputs: tuple[int, ...]  # numbers of the nodes it reads, in edge order


class Graph:
    """The gates of a ConSert. Nodes have numbers: first the inputs, then gates and guarantees.

    The bit of a leaf is the higher the earlier its id sorts, so among sets of equal size the
    larger number is the one whose ids come first.
    """

    def __init__(
        self, inputs: Sequence[InputSpec], nodes: Sequence[tuple[str, str, tuple[int, ...]]]
    ) -> None:
        self.names = tuple(spec.id for spec in inputs)  # ids of the leaves
        self.leaves = len(inputs)  # how many of the nodes are leaves
        # gates and guarantees in topological order; node ``k`` has number ``leaves + k``
        self.nodes = tuple(Node(gate == "And", read) for _, gate, read in nodes)
        # leaves by the number of their bit, and back
        self.by_bit = sorted(range(self.leaves), key=lambda k: self.names[k])[::-1]
        self.position = {k: position for position, k in enumerate(self.by_bit)}

    def evaluate(self, leaf_values: Sequence[int]) -> list[int]:
        values = list(leaf_values)
        for is_and, inputs in self.nodes:
            if is_and:
                values.append(min([values[k] for k in inputs], default=TRUE))
            else:
                values.append(max([values[k] for k in inputs], default=FALSE))
        return values

    def sets(self, leaf_values: Sequence[int]) -> Sets:
        return Search(self, leaf_values)


class _Family(NamedTuple):
    """Minimal sets of leaves: (size, bits) by size, then by ids."""

    sets: tuple[tuple[int, int], ...]
    truncated: bool = False


_IMPOSSIBLE = _Family(())
_ALREADY = _Family(((0, 0),))


class Search(Sets):
    """Path sets of one state of a graph."""

    def __init__(self, graph: Graph, leaf_values: Sequence[int]) -> None:
        super().__init__(graph.names, leaf_values)
        self._graph, self._values = graph, graph.evaluate(leaf_values)
        self._true_nodes = [value == TRUE for value in self._values]
        self._done = 0  # comparisons, so that no model makes a search endless

    def value(self, guarantee: Guarantee) -> int:
        return self._values[guarantee.node]

    # Exact: an And falls with any of its inputs, an Or with what all of its TRUE inputs fall with.
    def single_losses(self, guarantee: Guarantee) -> Group:
        critical: dict[int, int] = {}
        for k in self._gates_below(guarantee.node):
            if self._true_nodes[k]:
                is_and, inputs = self._node(k)
                bits = -1 if inputs and not is_and else 0
                for read in inputs:
                    if self._true_nodes[read]:
                        lost = critical[read] if read in critical else self._bit(read)
                        bits = bits | lost if is_and else bits & lost
                critical[k] = bits
        return self._ids(critical.get(guarantee.node, 0))

    def granting(self, guarantee: Guarantee) -> Group:
        read = {k for gate in self._gates_below(guarantee.node) for k in self._node(gate).inputs}
        below = sorted(k for k in read if k < self._graph.leaves and self._true_nodes[k])
        return tuple(self._graph.names[k] for k in below)

    def _node(self, number: int) -> Node:
        return self._graph.nodes[number - self._graph.leaves]

    def _bit(self, leaf: int) -> int:
        # made when needed: with 100,000 leaves each has 12 kB
        return 1 << self._graph.position[leaf]

    def _gates_below(self, node: int) -> list[int]:
        """Return the node and the gates that it depends on; inputs come before their users."""
        seen, stack = {node}, [node]
        while stack:
            for read in self._node(stack.pop()).inputs:
                if read >= self._graph.leaves and read not in seen:
                    seen.add(read)
                    stack.append(read)
        return sorted(seen)

    def _lacking(self, guarantee: Guarantee) -> tuple[list[Group], bool]:
        gates = self._gates_below(guarantee.node)
        users = Counter(read for k in gates for read in self._node(k).inputs)
        self._done = 0
        families: dict[int, _Family] = {}
        for k in gates:
            is_and, inputs = self._node(k)
            family = _ALREADY if is_and or self._true_nodes[k] else _IMPOSSIBLE
            for read in () if self._true_nodes[k] else inputs:
                leaf = _ALREADY if self._true_nodes[read] else None
                below = families.get(read) or leaf or _Family(((1, self._bit(read)),))
                family = self._both(family, below) if is_and else self._either(family, below)
            families[k] = family
            for read in inputs:
                users[read] -= 1
                if not users[read]:  # a long chain would else hold every set on its path
                    families.pop(read, None)
        sets, truncated = families[guarantee.node]
        return [self._ids(bits) for _, bits in sets], truncated

    def _ids(self, bits: int) -> Group:
        ids = []
        while bits:
            top = bits.bit_length() - 1
            ids.append(self._graph.names[self._graph.by_bit[top]])
            bits ^= 1 << top
        return tuple(ids)

    def _either(self, first: _Family, second: _Family) -> _Family:
        if not first.sets or not second.sets:
            return second if not first.sets else first
        return self._minimal([*first.sets, *second.sets], first.truncated or second.truncated)

    def _both(self, left: _Family, right: _Family) -> _Family:
        if _ALREADY in (left, right):
            return right if left == _ALREADY else left
        if not left.sets or not right.sets:
            return _IMPOSSIBLE
        truncated, first, second = left.truncated or right.truncated, left.sets, right.sets
        self._done += len(first) * len(second)
        if self._done > _BUDGET:
            truncated = truncated or max(len(first), len(second)) > _FEW_SETS
            first, second = first[:_FEW_SETS], second[:_FEW_SETS]
        unions = {some | more for _, some in first for _, more in second}
        return self._minimal([(bin(bits).count("1"), bits) for bits in unions], truncated)

    def _minimal(self, sets: list[tuple[int, int]], truncated: bool) -> _Family:
        """Return the smallest sets without those that contain another one (absorption)."""
        limit = _MOST_SETS if self._done <= _BUDGET else _FEW_SETS
        kept: list[tuple[int, int]] = []
        smaller: list[int] = []  # only a smaller set can be inside; equal ones are equal
        size_now = 0
        for size, bits in sorted(sets, key=lambda row: (row[0], -row[1])):
            if kept and kept[-1][1] == bits:  # cheaper than a set: hashing reads all bits
                continue
            if size != size_now:
                smaller, size_now = [kept_bits for _, kept_bits in kept], size
            self._done += len(smaller) + 1
            if any(inside & bits == inside for inside in smaller):
                continue
            if len(kept) == limit:
                return _Family(tuple(kept), truncated=True)
            kept.append((size, bits))
        return _Family(tuple(kept), truncated)
