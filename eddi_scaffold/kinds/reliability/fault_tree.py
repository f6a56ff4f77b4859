"""Fault trees as binary decision diagrams: exact however often an event is shared.

A tree is made smaller first: constants, chains of gates, modules. Nodes of a diagram are triples
(variable, high, low); 0 and 1 are the leaves false and true, node ``i`` has the number ``i + 2``.
Sources: Bryant 1986, Dutuit and Rauzy 1996 (modules), Niemelä 1997 (simplification). Nothing here
recurses, since trees may be deep.
"""

from __future__ import annotations

import itertools
from collections import Counter
from collections.abc import Callable, Iterator, Mapping, Sequence
from functools import lru_cache
from itertools import count
from typing import NamedTuple

NEVER, ALWAYS = -1, -2
"""Numbers of what cannot happen, and of what is certain."""


class Gate(NamedTuple):
    """A gate: ``of`` are numbers of events, or of gates counted behind the events."""

    type: str
    of: tuple[int, ...]
    k: int = 0


class Tree(NamedTuple):
    """A tree that was made smaller.

    Attributes:
        gates: by number, each behind those that it refers to; what was not there before has
            numbers above all others.
        top: number of a gate or event, ``NEVER`` or ``ALWAYS``.
        modules: gates whose events occur nowhere else, inner ones first, the top among them.
        origin: gate with a new number -> the one of the tree as it was given.
    """

    gates: dict[int, Gate]
    top: int
    modules: tuple[int, ...]
    origin: dict[int, int]


def simplified(
    events: int, gates: Sequence[Gate], top: int, known: Mapping[int, bool], *, split: bool
) -> Tree:
    """Return a tree of the same value.

    Args:
        events: how many basic events there are.
        gates: each refers to events and to gates before it.
        top: number of the top event.
        known: events that are certain, or cannot happen.
        split: find modules; else the top is the only one.
    """
    below = {events + i: gate for i, gate in enumerate(gates)}
    parents = Counter(
        n for number in reached(below, top) if number in below for n in below[number].of
    )
    meaning = {i: i for i in range(events)}
    meaning.update((event, ALWAYS if sure else NEVER) for event, sure in known.items())
    fresh, origin = count(events + len(gates)), dict[int, int]()
    made: dict[int, Gate] = {}
    same: dict[Gate, int] = {}

    def numbered(gate: Gate, number: int) -> int:
        """Return the number of a gate; one input of OR or AND is that input."""
        if len(gate.of) == 1 and gate.type in ("OR", "AND"):
            return gate.of[0]
        found = same.setdefault(gate, number)
        made.setdefault(found, gate)
        return found

    def negated(node: int, number: int) -> int:
        if node in (NEVER, ALWAYS):
            return NEVER + ALWAYS - node
        inner = made.get(node)
        return (
            inner.of[0] if inner and inner.type == "NOT" else numbered(Gate("NOT", (node,)), number)
        )

    for number in sorted(n for n in reached(below, top) if n in below):
        gate = below[number]
        inputs = [meaning[n] for n in gate.of]
        left = [n for n in inputs if n not in (NEVER, ALWAYS)]
        sure = inputs.count(ALWAYS)
        if gate.type == "NOT":
            meaning[number] = negated(inputs[0], number) if inputs else NEVER
        elif gate.type == "XOR":
            odd = (
                numbered(Gate("XOR", tuple(left)), number)
                if len(left) > 1
                else (left or [NEVER])[0]
            )
            meaning[number] = odd
            if sure % 2:  # the opposite, which is a gate of its own
                origin[new := next(fresh)] = number
                meaning[number] = negated(odd, new)
        else:
            needed = {"OR": 1, "AND": max(1, len(inputs))}.get(gate.type, gate.k) - sure
            kind = "OR" if needed == 1 else "AND" if needed == len(left) else "VOTE"
            if needed <= 0 or needed > len(left):
                meaning[number] = ALWAYS if needed <= 0 else NEVER
            elif kind == "VOTE":
                meaning[number] = numbered(Gate(kind, tuple(left), needed), number)
            else:
                flat: dict[int, None] = {}
                for n, given in zip(inputs, gate.of, strict=True):
                    inner = made.get(n)
                    if inner and inner.type == kind and parents[given] == 1:
                        flat.update(dict.fromkeys(inner.of))
                    elif n >= 0:
                        flat[n] = None
                meaning[number] = numbered(Gate(kind, tuple(flat)), number)
    tree = Tree(made, meaning[top], (meaning[top],), origin)
    return _split(tree, fresh) if split and tree.top in made else tree


def reached(
    gates: Mapping[int, Gate],
    top: int,
    borders: frozenset[int] = frozenset(),
    *,
    behind: bool = False,
) -> list[int]:
    """Return the numbers below the top, depth first.

    Args:
        gates: by number.
        top: where to begin.
        borders: gates below which nothing is visited, if they are not the top.
        behind: each behind those that it refers to; else in the order of their first visit.
    """
    found: dict[int, None] = {}
    left: dict[int, None] = {}
    waiting = [top]
    while waiting:
        node = waiting.pop()
        if node < 0:
            left[~node] = None
        elif node not in found:
            found[node] = None
            waiting.append(~node)
            if node in gates and (node == top or node not in borders):
                waiting += reversed(gates[node].of)
    return list(left if behind else found)


def _split(tree: Tree, fresh: count[int]) -> Tree:
    """Find the modules; inputs of an OR or AND that only share events among each other are one."""
    gates, origin = dict(tree.gates), dict(tree.origin)
    found = _modules(gates, tree.top)
    modules: list[int] = []
    for module in (n for n in tree.gates if n in found):
        gate = gates[module]
        parts: list[tuple[set[int], list[int]]] = []
        if gate.type in ("OR", "AND"):
            for n in gate.of:
                events = {
                    one for one in reached(gates, n, found) if one not in gates or one in found
                }
                if n in found:
                    events = {n}
                inputs = [n]
                apart = []
                for other in parts:
                    if events.isdisjoint(other[0]):
                        apart.append(other)
                    else:
                        events |= other[0]
                        inputs = other[1] + inputs
                parts = [*apart, (events, inputs)]
        if len(parts) > 1:
            place = {n: i for i, n in enumerate(gate.of)}
            of = []
            for inputs in sorted(
                (sorted(part[1], key=place.__getitem__) for part in parts),
                key=lambda one: place[one[0]],
            ):
                if len(inputs) > 1:
                    origin[new := next(fresh)] = module
                    gates[new] = Gate(gate.type, tuple(inputs))
                    modules.append(new)
                    of.append(new)
                else:
                    of += inputs
            gates[module] = Gate(gate.type, tuple(of))
        modules.append(module)
    return Tree(gates, tree.top, tuple(modules), origin)


def _modules(gates: Mapping[int, Gate], top: int) -> frozenset[int]:
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
            if node in gates:
                waiting.append((node, True))
                waiting += [(below, False) for below in reversed(gates[node].of)]
    low: dict[int, int] = {}
    high: dict[int, int] = {}
    found = {top}
    for node, gate in gates.items():
        if node in enter:
            low[node] = min(min(enter[b], low.get(b, enter[b])) for b in gate.of)
            high[node] = max(max(last[b], high.get(b, 0)) for b in gate.of)
            if len(gate.of) > 1 and low[node] > enter[node] and high[node] < leave[node]:
                found.add(node)
    return frozenset(found)


FALSE, TRUE = 0, 1
NODE_LIMIT = 2_000_000
_FIRST_LIMIT = 20_000
"""Nodes up to which all orders of the variables are tried; ten times more as long as none fits."""
_LARGEST = 2**60
COHERENT = frozenset({"OR", "AND", "VOTE"})


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
        nodes: (event or pseudo-event, high, low), lower ones first, those of a variable together.
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
    known: Mapping[int, bool] | None = None,
) -> Diagram:
    """Return the diagram of a tree.

    Args:
        events: how many basic events there are.
        gates: each refers to events and to gates before it.
        top: number of the top event.
        first: events that come first in the order of a tree that is not coherent: those that may
            be unknown at run time, so that their intervals are exact.
        limit: how many nodes there may be, also on the way.
        known: events that are certain, or cannot happen.

    Raises:
        TooLargeError: there would be more.
    """
    return _built(events, tuple(gates), top, first, limit, tuple((known or {}).items()))


@lru_cache(maxsize=8)
def _built(
    events: int,
    gates: tuple[Gate, ...],
    top: int,
    first: frozenset[int],
    limit: int,
    known: tuple[tuple[int, bool], ...],
) -> Diagram:
    tree = simplified(events, gates, top, dict(known), split=True)
    used = reached(tree.gates, tree.top)
    coherent = all(tree.gates[n].type in COHERENT for n in used if n in tree.gates)
    if not coherent and first.intersection(used):  # the intervals of modules are none of events
        tree = simplified(events, gates, top, dict(known), split=False)
    else:
        first = frozenset()
    modules: list[Module] = []
    left, borders = limit, frozenset(tree.modules)
    if tree.top not in tree.gates:  # a basic event, or a constant
        leaf = {NEVER: FALSE, ALWAYS: TRUE}.get(tree.top)
        nodes = ((tree.top, TRUE, FALSE),) if leaf is None else ()
        return Diagram(
            events, (Module(events + len(gates), nodes, 2 if leaf is None else leaf),), coherent
        )
    for module in tree.modules:
        modules.append(_smallest(tree, module, borders, first, left))
        left -= len(modules[-1].nodes)
    return Diagram(events, tuple(modules), coherent)


def _smallest(
    tree: Tree, top: int, borders: frozenset[int], first: frozenset[int], limit: int
) -> Module:
    """Return the smallest diagram of a module in several orders of its variables."""
    inner = reached(tree.gates, top, borders, behind=True)
    gates = {n: tree.gates[n] for n in inner if n in tree.gates and (n == top or n not in borders)}
    orders = list(dict.fromkeys(_orders(gates, top, first)))
    allowed = min(_FIRST_LIMIT, limit)
    while True:
        found = [one for order in orders if (one := _module(gates, order, top, allowed))]
        if found:
            return min(found, key=lambda one: len(one.nodes))
        if allowed == limit:
            raise TooLargeError(tree.origin.get(top, top), limit)
        allowed = min(10 * allowed, limit)


def _module(gates: Mapping[int, Gate], order: Sequence[int], top: int, limit: int) -> Module | None:
    """Return the diagram of a module in one order; None: it is above the limit."""
    try:
        return _Builder(gates, order, limit).module(top)
    except TooLargeError:
        return None


def _orders(
    gates: Mapping[int, Gate], top: int, first: frozenset[int]
) -> Iterator[tuple[int, ...]]:
    """Yield orders of the variables below a gate: first visit of the inputs.

    These as given, small ones first, and those that most gates share first.
    """
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
        sorted_gates = {
            number: Gate(gate.type, tuple(sorted(gate.of, key=key)))
            for number, gate in gates.items()
        }
        order = (n for n in reached(sorted_gates, top) if n not in gates)
        yield tuple(sorted(order, key=lambda n: n not in first) if first else order)


class _Builder:
    """Builds one module; the leaves are below all levels.

    Args:
        gates: of the module, each behind those that it refers to.
        order: of the variables, the top one first.
        limit: how many nodes there may be.
    """

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
        nodes, root = self._kept(done[top])
        return Module(top, nodes, root)

    def _gate(self, gate: Gate, below: list[int]) -> int:
        # from behind: each step mostly adds nodes on top
        below.sort(key=lambda node: self._level[node], reverse=True)
        if gate.type == "NOT":
            return self._ite(below[0], FALSE, TRUE)
        if gate.type == "VOTE":
            row = [TRUE] + [FALSE] * gate.k  # at least j of those so far
            for one in below:
                pairs = itertools.pairwise(row)
                row = [TRUE, *(self._ite(one, fewer, same) for fewer, same in pairs)]
            return row[gate.k]
        result = TRUE if gate.type == "AND" else FALSE
        for one in below:
            if gate.type == "AND":
                result = self._ite(one, result, FALSE)
            elif gate.type == "XOR":
                result = self._ite(one, self._ite(result, FALSE, TRUE), result)
            else:
                result = self._ite(one, TRUE, result)
        return result

    def _node(self, level: int, high: int, low: int) -> int:
        if high == low:
            return high
        key = high << 32 | low
        found = self._unique[level].get(key)
        if found is None:
            found = self._unique[level][key] = len(self._level)
            if found - 2 >= self._limit:
                raise TooLargeError(0, self._limit)
            self._level.append(level)
            self._high.append(high)
            self._low.append(low)
        return found

    def _ite(self, f: int, g: int, h: int) -> int:
        """Return if f then g else h, with a stack of its own."""
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

    def _kept(self, root: int) -> tuple[tuple[tuple[int, int, int], ...], int]:
        """Return the nodes below the root, lower ones first, with events as variables."""
        below = set()
        waiting = [root]
        while waiting:
            node = waiting.pop()
            if node > TRUE and node not in below:
                below.add(node)
                waiting += (self._high[node], self._low[node])
        number = {FALSE: FALSE, TRUE: TRUE}
        kept = []
        for node in sorted(below, key=lambda one: (-self._level[one], one)):
            number[node] = len(number)
            variable = self._variables[self._level[node]]
            kept.append((variable, number[self._high[node]], number[self._low[node]]))
        return tuple(kept), number[root]
