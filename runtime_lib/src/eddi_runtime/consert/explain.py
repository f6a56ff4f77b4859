"""Why a guarantee is inactive and what would activate it; what would end an active one.

The trees have no negation, so these are minimal path and cut sets. They are found by MOCUS, the
method of fault tree analysis (union for Or, collection for And, absorption after each step), over
sets that are kept as the bits of whole numbers.
"""

from __future__ import annotations

from typing import Dict, List, Mapping, NamedTuple, Sequence, Set, Tuple

from .values import FALSE, TRUE

MAX_SETS = 256
"""Sets kept per node; the smallest are kept, and the result is marked as truncated."""

_BUDGET = 2_000_000
"""Comparisons of sets per explanation, about 0.5 s; beyond it nodes keep ``_FEW_SETS`` each."""

_FEW_SETS = 4


class Reason(NamedTuple):
    """Why an input is not TRUE now.

    Attributes:
        kind: ``false``, ``missing``, ``stale``, ``invalid``, ``nan``, ``fault`` or ``debouncing``.
        text: the same for people, with value and range or age.
    """

    kind: str
    text: str


class Explanation(NamedTuple):
    """Why one guarantee is as it is after the last step.

    Attributes:
        guarantee: id as in the model.
        active: it is active.
        verdict: ``TRUE``, ``UNKNOWN`` or ``FALSE``.
        missing: inactive: each minimal set of inputs that are not TRUE now and that would
            activate it by becoming TRUE, by size, then by ids. Empty when nothing can.
        single_losses: active: each input whose loss alone would deactivate it, by id.
        loss_sets: active, when asked for: the minimal sets of inputs that would do so together.
        reasons: for each input in ``missing``, why it is not TRUE.
        truncated: there are more sets than are listed; the listed ones suffice but one may then
            be larger than needed.
        robots: each input that rests on the words of other robots, with their names.
    """

    guarantee: str
    active: bool
    verdict: str
    missing: Tuple[Tuple[str, ...], ...]
    single_losses: Tuple[str, ...]
    loss_sets: Tuple[Tuple[str, ...], ...]
    reasons: Mapping[str, Reason]
    truncated: bool
    robots: Mapping[str, Tuple[str, ...]] = {}

    def text(self) -> str:
        """Return the explanation as lines for people, without a line end behind the last."""
        if self.active:
            losses = ", ".join(map(self._named, self.single_losses)) or "no single input"
            others = sorted(set(self.robots) - set(self.single_losses))
            granted = f"; granted: {', '.join(map(self._named, others))}" if others else ""
            return f"{self.guarantee} is active; its loss would end it: {losses}{granted}"
        lines = [f"{self.guarantee} is {self.verdict}, not active"]
        if not self.missing:
            lines.append("  nothing can activate it")
        for group in self.missing:
            needs = [f"{one} ({self.reasons[one].text})" for one in group]
            lines += [f"  needs {' and '.join(needs)}"]
        if self.truncated:
            lines.append("  ... and more")
        return "\n".join(lines)

    def _named(self, name: str) -> str:
        robots = self.robots.get(name)
        return f"{name} by the word of {' and '.join(robots)}" if robots else name


class Node(NamedTuple):
    """An And or Or over other nodes; without inputs an And is TRUE and an Or is FALSE.

    Attributes:
        is_and: And, else Or. A guarantee is an And.
        inputs: numbers of the nodes it reads, in edge order.
    """

    is_and: bool
    inputs: Tuple[int, ...]


class Graph(NamedTuple):
    """Nodes by number: first the leaves (numbers of the inputs), then gates and guarantees.

    Attributes:
        names: number -> id.
        leaves: how many of the nodes are leaves.
        nodes: gates and guarantees in topological order; node ``k`` has number ``leaves + k``.
        guarantees: numbers of the guarantees in file order.
    """

    names: Tuple[str, ...]
    leaves: int
    nodes: Tuple[Node, ...]
    guarantees: Tuple[int, ...]

    def evaluate(self, leaf_values: Sequence[int]) -> List[int]:
        """Return the truth value of every node by number, from those of the leaves."""
        values = list(leaf_values)
        for is_and, inputs in self.nodes:
            if is_and:
                values.append(min([values[k] for k in inputs], default=TRUE))
            else:
                values.append(max([values[k] for k in inputs], default=FALSE))
        return values


class _Family(NamedTuple):
    """Minimal sets of leaves: (size, bits) by size, then by ids."""

    sets: Tuple[Tuple[int, int], ...]
    truncated: bool


_IMPOSSIBLE = _Family((), truncated=False)
_ALREADY = _Family(((0, 0),), truncated=False)


class Sets:
    """Path and cut sets of one state of a graph.

    The bit of a leaf is the higher the earlier its id sorts, so among sets of equal size the
    larger number is the one whose ids come first.

    Args:
        graph: the graph.
        leaf_values: truth values of its leaves.
    """

    def __init__(self, graph: Graph, leaf_values: Sequence[int]) -> None:
        self._graph, self.leaf_values = graph, leaf_values
        self.values = graph.evaluate(leaf_values)
        self._missing: Dict[int, Tuple[List[Tuple[str, ...]], bool]] = {}
        by_id = sorted(range(graph.leaves), key=lambda k: graph.names[k])
        self._by_bit = by_id[::-1]
        self._position = {k: position for position, k in enumerate(self._by_bit)}

    def missing(self, node: int) -> Tuple[List[Tuple[str, ...]], bool]:
        """Return the minimal sets of leaves that would make the node TRUE, and "truncated".

        None for a node that is TRUE. They cost more than a step, and are found once.
        """
        if self.values[node] == TRUE:
            return [], False
        if node not in self._missing:
            self._missing[node] = self._named(self._mocus(node, paths=True))
        return self._missing[node]

    def loss_sets(self, node: int) -> Tuple[List[Tuple[str, ...]], bool]:
        """Return the minimal sets of TRUE leaves whose loss ends the node, and "truncated"."""
        return self._named(self._mocus(node, paths=False))

    def single_losses(self, node: int) -> Tuple[str, ...]:
        """Return the leaves whose single loss makes a TRUE node not TRUE, by id.

        Exact also with shared gates: an And falls with any of its inputs, an Or with a leaf that
        all of its TRUE inputs fall with.
        """
        critical: Dict[int, int] = {}
        for k in self._gates_below(node):
            if self.values[k] != TRUE:
                continue
            is_and, inputs = self._graph.nodes[k - self._graph.leaves]
            bits = -1 if inputs and not is_and else 0
            for one in inputs:
                if self.values[one] == TRUE:
                    found = critical[one] if one in critical else self._bit(one)
                    bits = bits | found if is_and else bits & found
            critical[k] = bits
        return self._ids(critical.get(node, 0))

    def unknown_below(self, node: int, unknown: Set[int]) -> List[int]:
        """Return the given leaves that are reached from the node through nodes not TRUE."""
        found, seen, stack = [], {node}, [node]
        while stack:
            k = stack.pop()
            if self.values[k] == TRUE:
                continue
            if k < self._graph.leaves:
                if k in unknown:
                    found.append(k)
                continue
            for one in self._graph.nodes[k - self._graph.leaves].inputs:
                if one not in seen:
                    seen.add(one)
                    stack.append(one)
        return found

    def leaves_below(self, node: int) -> List[int]:
        """Return the leaves that a node is made of, in the order of the inputs."""
        nodes = (self._graph.nodes[k - self._graph.leaves] for k in self._gates_below(node))
        return sorted({one for _, inputs in nodes for one in inputs if one < self._graph.leaves})

    def _bit(self, leaf: int) -> int:
        return 1 << self._position[leaf]  # made when needed: with 100,000 leaves each has 12 kB

    def _gates_below(self, node: int) -> List[int]:
        """Return the node and the gates that it depends on; inputs come before their users."""
        seen, stack = {node}, [node]
        while stack:
            for one in self._graph.nodes[stack.pop() - self._graph.leaves].inputs:
                if one >= self._graph.leaves and one not in seen:
                    seen.add(one)
                    stack.append(one)
        return sorted(seen)

    def _mocus(self, node: int, *, paths: bool) -> _Family:
        """Return the minimal sets that reach (paths) or end (cuts) the node.

        Cuts are the paths of the dual graph: And and Or change places, and what is already lost
        takes the place of what is already there.
        """
        gates = self._gates_below(node)
        users = self._users(gates)
        work = _Work()
        families: Dict[int, _Family] = {}
        for k in gates:
            is_and, inputs = self._graph.nodes[k - self._graph.leaves]
            family = _ALREADY if is_and == paths else _IMPOSSIBLE
            combine = work.both if is_and == paths else work.either
            if (self.values[k] == TRUE) == paths:
                family, inputs = _ALREADY, ()
            for one in inputs:
                found = families.get(one)
                if found is None:
                    there = (self.values[one] == TRUE) == paths
                    found = _ALREADY if there else _Family(((1, self._bit(one)),), truncated=False)
                family = combine(family, found)
            families[k] = family
            for one in self._graph.nodes[k - self._graph.leaves].inputs:
                users[one] -= 1
                if not users[one]:  # a long chain would else hold every set on the way
                    families.pop(one, None)
        return families[node]

    def _users(self, gates: List[int]) -> Dict[int, int]:
        """Return how often each node is an input of one of the gates."""
        users: Dict[int, int] = {}
        for k in gates:
            for one in self._graph.nodes[k - self._graph.leaves].inputs:
                users[one] = users.get(one, 0) + 1
        return users

    def _named(self, family: _Family) -> Tuple[List[Tuple[str, ...]], bool]:
        return [self._ids(bits) for _, bits in family.sets], family.truncated

    def _ids(self, bits: int) -> Tuple[str, ...]:
        ids = []
        while bits:
            top = bits.bit_length() - 1
            ids.append(self._graph.names[self._by_bit[top]])
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

    def _minimal(self, sets: List[Tuple[int, int]], *, truncated: bool) -> _Family:
        """Return the smallest sets without those that contain another one (absorption)."""
        limit = MAX_SETS if self._done <= _BUDGET else _FEW_SETS
        kept: List[Tuple[int, int]] = []
        smaller: List[int] = []  # only a smaller set can be inside; equal ones are equal
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
