"""Binary decision diagrams of fault trees: exact however often an event is shared.

Nodes are triples (variable, high, low); 0 and 1 are the leaves false and true, node ``i`` has the
number ``i + 2``. Source: Bryant 1986. Nothing here recurses, since trees may be deep.
"""

from __future__ import annotations

import itertools
from collections import Counter
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import suppress
from typing import NamedTuple

from eddi_scaffold.kinds.reliability.fault_tree import (
    ALWAYS,
    COHERENT,
    NEVER,
    Gate,
    Tree,
    reached,
    simplified,
)

FALSE, TRUE = 0, 1
NODE_LIMIT = 2_000_000
_FIRST_LIMIT = 20_000
"""Nodes up to which all orders of the variables are tried; ten times more as long as none fits."""
_LARGEST = 2**60


class TooLargeError(ValueError):
    """The diagram of a gate, by its number behind the events, has more nodes than the limit."""

    def __init__(self, gate: int, count: int) -> None:
        super().__init__(f"the diagram has {count} nodes")
        self.gate, self.count = gate, count


class Module(NamedTuple):
    """The diagram of one independent part of a tree."""

    variable: int  # number of the pseudo-event that it gives
    # (event or pseudo-event, high, low), lower ones first, those of a variable together
    nodes: tuple[tuple[int, int, int], ...]
    root: int


class Diagram(NamedTuple):
    """The diagrams of a tree, inner modules first; the last one is the top event."""

    events: int
    modules: tuple[Module, ...]
    coherent: bool

    @property
    def size(self) -> int:
        """Number of nodes."""
        return sum(len(module.nodes) for module in self.modules)


def build(
    events: int,
    gates: Sequence[Gate],
    top: int,
    first: frozenset[int] = frozenset(),
    limit: int = NODE_LIMIT,
    known: Sequence[tuple[int, bool]] = (),
) -> Diagram:
    """Return the diagram of a tree; each gate refers to so many events and to gates before it.

    ``first`` may be unknown at run time: they come first where the tree is not coherent, so that
    their intervals are exact. ``known`` are certain, or cannot happen.

    Raises:
        TooLargeError: there would be more nodes than the limit, also on the way.
    """
    tree = simplified(events, gates, top, known, split=True)
    used = reached(tree.gates, tree.top)
    coherent = all(tree.gates[n].type in COHERENT for n in used if n in tree.gates)
    if not coherent and first.intersection(used):  # the intervals of modules are none of events
        tree = simplified(events, gates, top, known, split=False)
    else:
        first = frozenset()
    if tree.top not in tree.gates:  # a basic event, or a constant
        leaf = {NEVER: FALSE, ALWAYS: TRUE}.get(tree.top)
        nodes = ((tree.top, TRUE, FALSE),) if leaf is None else ()
        module = Module(events + len(gates), nodes, 2 if leaf is None else leaf)
        return Diagram(events, (module,), coherent)
    modules: list[Module] = []
    borders = frozenset(tree.modules)
    for number in tree.modules:
        modules.append(_smallest(tree, number, borders, first, limit))
        limit -= len(modules[-1].nodes)
    return Diagram(events, tuple(modules), coherent)


def _smallest(
    tree: Tree, top: int, borders: frozenset[int], first: frozenset[int], limit: int
) -> Module:
    inner = reached(tree.gates, top, borders, behind=True)
    gates = {n: tree.gates[n] for n in inner if n in tree.gates and (n == top or n not in borders)}
    orders = list(dict.fromkeys(_orders(gates, top, first)))
    allowed = min(_FIRST_LIMIT, limit)
    while True:
        diagrams = []
        for order in orders:
            with suppress(TooLargeError):
                diagrams.append(_Builder(gates, order, allowed).module(top))
        if diagrams:
            return min(diagrams, key=lambda module: len(module.nodes))
        if allowed == limit:
            raise TooLargeError(tree.origin.get(top, top), limit)
        allowed = min(10 * allowed, limit)


def _orders(
    gates: Mapping[int, Gate], top: int, first: frozenset[int]
) -> Iterator[tuple[int, ...]]:
    """Yield orders of variables by their first visit: as they stand, small or shared ones first."""
    size: dict[int, int] = {}
    for number, gate in gates.items():
        size[number] = min(sum(size.get(n, 1) for n in gate.of), _LARGEST)
    uses = Counter(n for gate in gates.values() for n in gate.of)
    keys: tuple[Callable[[int], tuple[int, ...]], ...] = (
        lambda _: (),
        lambda n: (size.get(n, 1),),
        lambda n: (-uses[n], size.get(n, 1)),
    )
    for key in keys:
        ordered = {n: Gate(gate.type, tuple(sorted(gate.of, key=key))) for n, gate in gates.items()}
        order = (n for n in reached(ordered, top) if n not in gates)
        yield tuple(sorted(order, key=lambda n: n not in first))


class _Builder:
    """Builds one module, whose first variable is at the top; the leaves are below all levels."""

    def __init__(self, gates: Mapping[int, Gate], order: Sequence[int], limit: int) -> None:
        self._gates, self._variables, self._limit = gates, order, limit
        self._level = [len(order)] * 2
        self._high, self._low = [FALSE, TRUE], [FALSE, TRUE]
        self._unique: list[dict[int, int]] = [{} for _ in order]
        self._memo: dict[tuple[int, int, int], int] = {}

    def module(self, top: int) -> Module:
        done = {v: self._node(level, TRUE, FALSE) for level, v in enumerate(self._variables)}
        for number, gate in self._gates.items():
            done[number] = self._gate(gate, [done[n] for n in gate.of])
            if len(self._memo) > self._limit:
                self._memo.clear()
        used = {FALSE, TRUE}
        waiting = [done[top]]
        while waiting:
            node = waiting.pop()
            if node not in used:
                used.add(node)
                waiting += (self._high[node], self._low[node])
        number_of = {FALSE: FALSE, TRUE: TRUE}
        nodes = []
        for node in sorted(used - {FALSE, TRUE}, key=lambda node: (-self._level[node], node)):
            number_of[node] = len(number_of)
            variable = self._variables[self._level[node]]
            nodes.append((variable, number_of[self._high[node]], number_of[self._low[node]]))
        return Module(top, tuple(nodes), number_of[done[top]])

    def _gate(self, gate: Gate, below: list[int]) -> int:
        # from behind: each step mostly adds nodes on top
        below.sort(key=lambda node: self._level[node], reverse=True)
        if gate.type == "NOT":
            return self._ite(below[0], FALSE, TRUE)
        if gate.type == "VOTE":
            row = [TRUE] + [FALSE] * gate.k  # at least j of those so far
            for node in below:
                pairs = itertools.pairwise(row)
                row = [TRUE, *(self._ite(node, fewer, same) for fewer, same in pairs)]
            return row[gate.k]
        result = TRUE if gate.type == "AND" else FALSE
        for node in below:
            if gate.type == "AND":
                result = self._ite(node, result, FALSE)
            elif gate.type == "XOR":
                result = self._ite(node, self._ite(result, FALSE, TRUE), result)
            else:
                result = self._ite(node, TRUE, result)
        return result

    def _node(self, level: int, high: int, low: int) -> int:
        if high == low:
            return high
        key = high << 32 | low
        node = self._unique[level].get(key)
        if node is None:
            node = self._unique[level][key] = len(self._level)
            if node - 2 >= self._limit:
                raise TooLargeError(0, self._limit)
            self._level.append(level)
            self._high.append(high)
            self._low.append(low)
        return node

    def _ite(self, f: int, g: int, h: int) -> int:
        level, high, low, memo = self._level, self._high, self._low, self._memo
        results: list[int] = []
        keys: list[tuple[int, int, int]] = []
        tasks: list[tuple[int, int, int] | int] = [(f, g, h)]
        while tasks:
            task = tasks.pop()
            if isinstance(task, int):  # the level of a node whose branches are done
                down, up = results.pop(), results.pop()
                memo[keys.pop()] = node = self._node(task, up, down)
                results.append(node)
                continue
            f, g, h = task
            g, h = TRUE if g == f else g, FALSE if h == f else h
            if f <= TRUE or g == h:
                results.append(g if f else h)
                continue
            if (g, h) == (TRUE, FALSE):
                results.append(f)
                continue
            if h == FALSE and TRUE < g < f:  # both ways round are one
                f, g = g, f
            elif g == TRUE and h < f:
                f, h = h, f
            task = (f, g, h)
            known = memo.get(task)
            if known is not None:
                results.append(known)
                continue
            of_f, of_g, of_h = level[f], level[g], level[h]
            top = min(of_f, of_g, of_h)
            f1, f0 = (high[f], low[f]) if of_f == top else (f, f)
            g1, g0 = (high[g], low[g]) if of_g == top else (g, g)
            h1, h0 = (high[h], low[h]) if of_h == top else (h, h)
            keys.append(task)
            tasks += top, (f0, g0, h0), (f1, g1, h1)
        return results[0]
