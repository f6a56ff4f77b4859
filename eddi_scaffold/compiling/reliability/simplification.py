"""Fault trees made smaller before a diagram is built: constants, chains of gates, modules.

Sources: Dutuit and Rauzy 1996 (modules), Niemelä 1997 (simplification). Nothing here recurses.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence
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
