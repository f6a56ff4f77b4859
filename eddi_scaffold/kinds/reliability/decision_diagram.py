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
    COHERENT,
    Gate,
    TooLargeError,
    order,
    used_gates,
)

FALSE, TRUE = 0, 1
NODE_LIMIT = 2_000_000
_FIRST_LIMIT = 20_000
"""Nodes up to which all orders of the variables are tried; ten times more as long as none fits."""
_LARGEST = 2**60


class Diagram(NamedTuple):
    """The diagram of a tree."""

    # (event, high, low), lower ones first, those of an event together
    nodes: tuple[tuple[int, int, int], ...]
    root: int
    coherent: bool


def build(
    events: int,
    gates: Sequence[Gate],
    top: int,
    first: frozenset[int] = frozenset(),
    limit: int = NODE_LIMIT,
    known: Sequence[tuple[int, bool]] = (),
) -> Diagram:
    """Return the diagram of a tree; each gate refers to so many events and to gates.

    ``first`` may be unknown at run time: they come first where the tree is not coherent, so that
    their intervals are exact. ``known`` are certain, or cannot happen.

    Raises:
        TooLargeError: there would be more nodes than the limit, also on the way.
    """
    used = _flattened(used_gates(events, gates, top))
    coherent = all(gate.type in COHERENT for gate in used.values())
    orders = list(dict.fromkeys(_orders(used, top, frozenset() if coherent else first)))
    allowed = min(_FIRST_LIMIT, limit)
    while True:
        diagrams = []
        for variables in orders:
            with suppress(TooLargeError):
                diagrams.append(_Builder(used, variables, allowed, dict(known)).nodes(top))
        if diagrams:
            nodes, root = min(diagrams, key=lambda of: len(of[0]))
            return Diagram(nodes, root, coherent or not nodes)
        if allowed == limit:
            raise TooLargeError
        allowed = min(10 * allowed, limit)


def _flattened(gates: Mapping[int, Gate]) -> dict[int, Gate]:
    """Return gates of which an OR or AND takes the inputs of one that is its input alone."""
    uses = Counter(n for gate in gates.values() for n in gate.of)
    flat: dict[int, Gate] = {}
    for number, gate in gates.items():
        of: list[int] = []
        for n in gate.of:
            inner = flat.get(n) if gate.type in ("OR", "AND") and uses[n] == 1 else None
            of += flat.pop(n).of if inner and inner.type == gate.type else [n]
        flat[number] = gate._replace(of=tuple(of))
    return flat


def _orders(
    gates: Mapping[int, Gate], top: int, first: frozenset[int]
) -> Iterator[tuple[int, ...]]:
    """Yield orders of events by their first visit: as they stand, small or shared ones first."""
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
        below = {number: sorted(gate.of, key=key) for number, gate in gates.items()}
        reached = (n for n in order(top, below)[0] if n not in gates)
        yield tuple(sorted(reached, key=lambda n: n not in first))


class _Builder:
    """Builds the diagram for an order of the events; the leaves are below all levels."""

    def __init__(
        self,
        gates: Mapping[int, Gate],
        variables: Sequence[int],
        limit: int,
        known: Mapping[int, bool],
    ) -> None:
        self._gates, self._variables, self._limit, self._known = gates, variables, limit, known
        self._level = [len(variables)] * 2
        self._high, self._low = [FALSE, TRUE], [FALSE, TRUE]
        self._unique: list[dict[int, int]] = [{} for _ in variables]
        self._memo: dict[tuple[int, int, int], int] = {}

    def nodes(self, top: int) -> tuple[tuple[tuple[int, int, int], ...], int]:
        """Return the nodes, and which of them is at the top."""
        done = {v: self._node(level, TRUE, FALSE) for level, v in enumerate(self._variables)}
        done |= self._known  # true and false are the leaves
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
        return tuple(nodes), number_of[done[top]]

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
        result = TRUE if gate.type == "AND" and below else FALSE
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
                raise TooLargeError
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
