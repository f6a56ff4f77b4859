"""Binary decision diagrams of fault trees: exact however often an event is shared.

Nodes of a diagram are triples (variable, high, low); 0 and 1 are the leaves false and true, node
``i`` has the number ``i + 2``. Source: Bryant 1986; modules: Dutuit and Rauzy 1996. Nothing here
recurses, since trees may be deep.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

FALSE, TRUE = 0, 1
NODE_LIMIT = 200_000
COHERENT = frozenset({"OR", "AND", "VOTE"})


class Gate(NamedTuple):
    """A gate: ``of`` are numbers of events, or of gates counted behind the events."""

    type: str
    of: tuple[int, ...]
    k: int = 0


class TooLargeError(ValueError):
    """A diagram has more nodes than the limit.

    Attributes:
        gate: number of the gate of the module concerned, counted behind the events.
        count: nodes reached.
    """

    def __init__(self, gate: int, count: int) -> None:
        super().__init__(f"the diagram has {count} nodes")
        self.gate, self.count = gate, count


class Module(NamedTuple):
    """The diagram of one independent part of a tree.

    Attributes:
        variable: number of the pseudo-event that it gives.
        nodes: (event or pseudo-event, high, low), lower ones first.
        root: number of the node at the top.
    """

    variable: int
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
) -> Diagram:
    """Return the diagram of a tree.

    Args:
        events: how many basic events there are.
        gates: each refers to events and to gates before it.
        top: number of the top event.
        first: events that come first in the order of a tree that is not coherent: those that may
            be unknown at run time, so that their intervals are exact.
        limit: how many nodes there may be.

    Raises:
        TooLargeError: there would be more.
    """
    used = reached(events, gates, top)
    coherent = all(gates[n - events].type in COHERENT for n in used if n >= events)
    order = [n for n in used if n < events]
    if not coherent:
        order.sort(key=lambda n: n not in first)
    exact = not coherent and bool(first.intersection(order))
    tops = frozenset({top}) if exact else _modules(events, gates, top)
    modules: list[Module] = []
    count = 0
    for node in sorted(n for n in used if n in tops):
        module = _Builder(events, gates, node, tops - {node}, order, limit - count).module()
        modules.append(module)
        count += len(module.nodes)
    if not modules:  # the top event is a basic event
        modules.append(Module(events + len(gates), ((top, TRUE, FALSE),), 2))
    return Diagram(events, tuple(modules), coherent)


def reached(events: int, gates: Sequence[Gate], top: int) -> list[int]:
    """Return the numbers below the top in the order of their first visit, depth first."""
    found: dict[int, None] = {}
    waiting = [top]
    while waiting:
        node = waiting.pop()
        if node not in found:
            found[node] = None
            if node >= events:
                waiting += reversed(gates[node - events].of)
    return list(found)


def _modules(events: int, gates: Sequence[Gate], top: int) -> frozenset[int]:
    """Return the gates whose events occur nowhere else, the top among them (Dutuit, Rauzy)."""
    enter: dict[int, int] = {}
    leave: dict[int, int] = {}
    last: dict[int, int] = {}
    clock = 0
    waiting: list[tuple[int, bool]] = [(top, False)]
    while waiting:
        node, done = waiting.pop()
        clock += 1
        last[node] = clock
        if done:
            leave[node] = clock
        elif node not in enter:
            enter[node] = clock
            if node >= events:
                waiting.append((node, True))
                waiting += [(below, False) for below in reversed(gates[node - events].of)]
    low: dict[int, int] = {}
    high: dict[int, int] = {}
    found = {top} if top >= events else set()
    for node in sorted(enter):  # lower numbers first: gates refer backwards
        if node >= events:
            below = gates[node - events].of
            low[node] = min((min(enter[b], low.get(b, enter[b])) for b in below), default=clock)
            high[node] = max((max(last[b], high.get(b, 0)) for b in below), default=0)
            if len(below) > 1 and low[node] > enter[node] and high[node] < leave[node]:
                found.add(node)
    return frozenset(found)


class _Builder:
    """Builds one module; variables are ranks in the order of the tree."""

    def __init__(
        self,
        events: int,
        gates: Sequence[Gate],
        top: int,
        borders: frozenset[int],
        order: Sequence[int],
        limit: int,
    ) -> None:
        self._events, self._gates, self._top = events, gates, top
        self._borders, self._limit = borders, limit
        self._variables, self._inner = self._visit(order)
        self._level = {variable: i for i, variable in enumerate(self._variables)}
        self._nodes: list[tuple[int, int, int]] = []
        self._unique: dict[tuple[int, int, int], int] = {}
        self._memo: dict[tuple[int, int, int], int] = {}
        self._keys: list[tuple[int, int, int]] = []

    def _visit(self, order: Sequence[int]) -> tuple[list[int], list[int]]:
        """Return the variables in their order, and the gates of this module, lower ones first."""
        found: dict[int, None] = {}
        waiting = [self._top]
        while waiting:
            node = waiting.pop()
            if node in found:
                continue
            found[node] = None
            if node >= self._events and node not in self._borders:
                waiting += reversed(self._gates[node - self._events].of)
        leaves = [n for n in found if n < self._events or n in self._borders]
        if not self._borders:
            rank = {variable: i for i, variable in enumerate(order)}
            leaves.sort(key=lambda n: rank[n])
        return leaves, sorted(n for n in found if n >= self._events and n not in self._borders)

    def module(self) -> Module:
        done = {v: self._node(level, TRUE, FALSE) for v, level in self._level.items()}
        for node in self._inner:
            done[node] = self._gate(self._gates[node - self._events], done)
        nodes, root = self._kept(done[self._top])
        return Module(self._top, nodes, root)

    def _gate(self, gate: Gate, done: dict[int, int]) -> int:
        below = [done[n] for n in gate.of]
        # from behind: later inputs are deeper, so each step only adds nodes on top
        if gate.type == "NOT":
            return self._ite(below[0], FALSE, TRUE) if below else FALSE
        if gate.type == "VOTE":
            return self._vote(gate.k, below)
        result = TRUE if gate.type == "AND" and below else FALSE
        for one in reversed(below):
            if gate.type == "AND":
                result = self._ite(one, result, FALSE)
            elif gate.type == "XOR":
                result = self._ite(one, self._ite(result, FALSE, TRUE), result)
            else:
                result = self._ite(one, TRUE, result)
        return result

    def _vote(self, k: int, below: Sequence[int]) -> int:
        """Return at least k of below; ``row[j]``: at least j of those behind."""
        row = [TRUE] + [FALSE] * k
        for one in reversed(below):
            row = [TRUE] + [self._ite(one, row[j - 1], row[j]) for j in range(1, k + 1)]
        return row[k]

    def _node(self, level: int, high: int, low: int) -> int:
        if high == low:
            return high
        key = (level, high, low)
        found = self._unique.get(key)
        if found is None:
            if len(self._nodes) >= self._limit:
                raise TooLargeError(self._top, len(self._nodes))
            self._nodes.append(key)
            found = self._unique[key] = len(self._nodes) + 1
        return found

    def _ite(self, f: int, g: int, h: int) -> int:
        """Return if f then g else h, with a stack of its own."""
        results: list[int] = []
        tasks: list[tuple[int, int, int, int]] = [(0, f, g, h)]
        while tasks:
            kind, f, g, h = tasks.pop()
            if kind:  # combine: f is the level, (g, h) the key of the memo by its position
                low, high = results.pop(), results.pop()
                node = self._node(f, high, low)
                self._memo[self._keys[g]] = node
                results.append(node)
                continue
            simple = _simple(f, g, h)
            if simple is None:
                simple = self._memo.get((f, g, h))
            if simple is not None:
                results.append(simple)
                continue
            level = min(self._top_level(f), self._top_level(g), self._top_level(h))
            self._keys.append((f, g, h))
            tasks.append((1, level, len(self._keys) - 1, 0))
            tasks.append((0, *self._branches(f, g, h, level, 2)))
            tasks.append((0, *self._branches(f, g, h, level, 1)))
        self._keys.clear()
        return results[0]

    def _top_level(self, node: int) -> int:
        return self._nodes[node - 2][0] if node > 1 else len(self._variables)

    def _branches(self, f: int, g: int, h: int, level: int, which: int) -> tuple[int, int, int]:
        return (
            self._branch(f, level, which),
            self._branch(g, level, which),
            self._branch(h, level, which),
        )

    def _branch(self, node: int, level: int, which: int) -> int:
        if node <= 1 or self._nodes[node - 2][0] != level:
            return node
        return self._nodes[node - 2][which]

    def _kept(self, root: int) -> tuple[tuple[tuple[int, int, int], ...], int]:
        """Return the nodes below the root, lower ones first, with events as variables."""
        below = set()
        waiting = [root]
        while waiting:
            node = waiting.pop()
            if node > 1 and node not in below:
                below.add(node)
                waiting += self._nodes[node - 2][1:]
        number = {FALSE: FALSE, TRUE: TRUE}
        kept = []
        for node in sorted(below):
            level, high, low = self._nodes[node - 2]
            kept.append((self._variables[level], number[high], number[low]))
            number[node] = len(kept) + 1
        return tuple(kept), number[root]


def _simple(f: int, g: int, h: int) -> int | None:
    if f == TRUE or g == h:
        return g
    if f == FALSE:
        return h
    return f if (g, h) == (TRUE, FALSE) else None
