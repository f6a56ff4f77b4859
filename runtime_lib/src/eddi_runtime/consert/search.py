"""The sets of a ConSert that has too many of them for ``compiled.py``: searched on the robot.

The trees have no negation, so these are minimal path and cut sets, found by MOCUS (union for Or,
collection for And, absorption after each step) over sets as bits of whole numbers.
"""

from __future__ import annotations

from typing import NamedTuple, Sequence

from ..inputs import InputSpec
from .verdicts import FALSE, MAX_SETS, TRUE, Group, Guarantee, Sets

_BUDGET = 2_000_000
"""Comparisons of sets per explanation, about 0.5 s; beyond it nodes keep ``_FEW_SETS`` each."""

_FEW_SETS = 4


class Node(NamedTuple):
    """An And or Or over other nodes; without inputs an And is TRUE and an Or is FALSE."""

    is_and: bool  # And, else Or. A guarantee is an And.
    inputs: tuple[int, ...]  # numbers of the nodes it reads, in edge order


class Graph:
    """The gates of a ConSert. Nodes have numbers: first the inputs, then gates and guarantees.

    The bit of a leaf is the higher the earlier its id sorts, so among sets of equal size the
    larger number is the one whose ids come first. ``nodes``: (id, ``And`` or ``Or``, what it
    reads), which come first.
    """

    def __init__(
        self, inputs: Sequence[InputSpec], nodes: Sequence[tuple[str, str, tuple[int, ...]]]
    ) -> None:
        self.names = tuple(spec.id for spec in inputs)  # ids of the leaves
        self.leaves = len(inputs)  # how many of the nodes are leaves
        # gates and guarantees in topological order; node ``k`` has number ``leaves + k``
        self.nodes = tuple(Node(gate == "And", read) for _, gate, read in nodes)
        # leaves by the number of their bit
        self.by_bit = sorted(range(self.leaves), key=lambda k: self.names[k])[::-1]
        # leaf -> number of its bit
        self.position = {k: position for position, k in enumerate(self.by_bit)}

    def evaluate(self, leaf_values: Sequence[int]) -> list[int]:
        """Return the truth value of every node by number, from those of the leaves."""
        values = list(leaf_values)
        for is_and, inputs in self.nodes:
            if is_and:
                values.append(min([values[k] for k in inputs], default=TRUE))
            else:
                values.append(max([values[k] for k in inputs], default=FALSE))
        return values

    def sets(self, leaf_values: Sequence[int]) -> Sets:
        """Return what follows of the guarantees in a state of the inputs."""
        return Search(self, leaf_values)


class _Family(NamedTuple):
    """Minimal sets of leaves: (size, bits) by size, then by ids."""

    sets: tuple[tuple[int, int], ...]
    truncated: bool


_IMPOSSIBLE = _Family((), truncated=False)
_ALREADY = _Family(((0, 0),), truncated=False)


class Search(Sets):
    """Path and cut sets of one state of a graph."""

    def __init__(self, graph: Graph, leaf_values: Sequence[int]) -> None:
        super().__init__(graph.names, leaf_values)
        self._graph = graph
        self._values = graph.evaluate(leaf_values)

    def value(self, one: Guarantee) -> int:
        return self._values[one.node]

    def _lacking(self, one: Guarantee) -> tuple[list[Group], bool]:
        return self._named(self._mocus(one.node, paths=True))

    def loss_sets(self, one: Guarantee) -> tuple[list[Group], bool]:
        return self._named(self._mocus(one.node, paths=False))

    def single_losses(self, one: Guarantee) -> Group:
        critical: dict[int, int] = {}
        for k in self._gates_below(one.node):
            if self._values[k] != TRUE:
                continue
            is_and, inputs = self._graph.nodes[k - self._graph.leaves]
            bits = -1 if inputs and not is_and else 0
            for read in inputs:
                if self._values[read] == TRUE:
                    found = critical[read] if read in critical else self._bit(read)
                    bits = bits | found if is_and else bits & found
            critical[k] = bits
        return self._ids(critical.get(one.node, 0))

    def blocking(self, one: Guarantee) -> frozenset[str]:
        found, seen, stack = [], {one.node}, [one.node]
        while stack:
            k = stack.pop()
            if self._values[k] == TRUE:
                continue
            if k < self._graph.leaves:
                found.append(self._graph.names[k])
                continue
            for read in self._graph.nodes[k - self._graph.leaves].inputs:
                if read not in seen:
                    seen.add(read)
                    stack.append(read)
        return frozenset(found)

    def granting(self, one: Guarantee) -> Group:
        nodes = (self._graph.nodes[k - self._graph.leaves] for k in self._gates_below(one.node))
        below = sorted({k for _, inputs in nodes for k in inputs if k < self._graph.leaves})
        return tuple(self._graph.names[k] for k in below if self._values[k] == TRUE)

    def _bit(self, leaf: int) -> int:
        # made when needed: with 100,000 leaves each has 12 kB
        return 1 << self._graph.position[leaf]

    def _gates_below(self, node: int) -> list[int]:
        """Return the node and the gates that it depends on; inputs come before their users."""
        seen, stack = {node}, [node]
        while stack:
            for input_ in self._graph.nodes[stack.pop() - self._graph.leaves].inputs:
                if input_ >= self._graph.leaves and input_ not in seen:
                    seen.add(input_)
                    stack.append(input_)
        return sorted(seen)

    def _mocus(self, node: int, *, paths: bool) -> _Family:
        """Return the minimal sets that reach (paths) or end (cuts) the node.

        Cuts are the paths of the dual graph: And and Or, lost and there change places.
        """
        gates = self._gates_below(node)
        users = self._users(gates)
        work = _Work()
        families: dict[int, _Family] = {}
        for k in gates:
            is_and, inputs = self._graph.nodes[k - self._graph.leaves]
            family = _ALREADY if is_and == paths else _IMPOSSIBLE
            combine = work.both if is_and == paths else work.either
            if (self._values[k] == TRUE) == paths:
                family, inputs = _ALREADY, ()
            for input_ in inputs:
                found = families.get(input_)
                if found is None:
                    there = (self._values[input_] == TRUE) == paths
                    found = (
                        _ALREADY if there else _Family(((1, self._bit(input_)),), truncated=False)
                    )
                family = combine(family, found)
            families[k] = family
            for input_ in self._graph.nodes[k - self._graph.leaves].inputs:
                users[input_] -= 1
                if not users[input_]:  # a long chain would else hold every set on the way
                    families.pop(input_, None)
        return families[node]

    def _users(self, gates: list[int]) -> dict[int, int]:
        users: dict[int, int] = {}
        for k in gates:
            for input_ in self._graph.nodes[k - self._graph.leaves].inputs:
                users[input_] = users.get(input_, 0) + 1
        return users

    def _named(self, family: _Family) -> tuple[list[Group], bool]:
        return [self._ids(bits) for _, bits in family.sets], family.truncated

    def _ids(self, bits: int) -> Group:
        ids = []
        while bits:
            top = bits.bit_length() - 1
            ids.append(self._graph.names[self._graph.by_bit[top]])
            bits ^= 1 << top
        return tuple(ids)


class _Work:
    """Combines families of sets and counts the work, so that no model makes it endless."""

    def __init__(self) -> None:
        self._done = 0

    def either(self, one: _Family, other: _Family) -> _Family:
        """Return the minimal sets of an Or."""
        if not one.sets or not other.sets:
            return other if not one.sets else one
        return self._minimal([*one.sets, *other.sets], truncated=one.truncated or other.truncated)

    def both(self, one: _Family, other: _Family) -> _Family:
        """Return the minimal sets of an And."""
        if one == _ALREADY:
            return other
        if other == _ALREADY:
            return one
        if not one.sets or not other.sets:
            return _IMPOSSIBLE
        truncated = one.truncated or other.truncated
        self._done += len(one.sets) * len(other.sets)
        if self._done > _BUDGET:
            truncated = truncated or max(len(one.sets), len(other.sets)) > _FEW_SETS
            one = _Family(one.sets[:_FEW_SETS], truncated)
            other = _Family(other.sets[:_FEW_SETS], truncated)
        unions = {first | second for _, first in one.sets for _, second in other.sets}
        return self._minimal([(_size(bits), bits) for bits in unions], truncated=truncated)

    def _minimal(self, sets: list[tuple[int, int]], *, truncated: bool) -> _Family:
        """Return the smallest sets without those that contain another one (absorption)."""
        limit = MAX_SETS if self._done <= _BUDGET else _FEW_SETS
        kept: list[tuple[int, int]] = []
        smaller: list[int] = []  # only a smaller set can be inside; equal ones are equal
        size_now = 0
        for size, bits in sorted(sets, key=lambda one: (one[0], -one[1])):
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
        return _Family(tuple(kept), truncated=truncated)


def _size(bits: int) -> int:
    return bin(bits).count("1")
