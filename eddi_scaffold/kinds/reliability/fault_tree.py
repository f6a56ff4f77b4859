"""Fault trees made smaller (constants, chains of gates, modules), and their minimal cut sets.

Sources: Dutuit and Rauzy 1996 (modules), Niemelä 1997 (simplification), Fussell and Vesely 1972
(cut sets). Nothing here recurses, since trees may be deep.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from itertools import count, groupby
from typing import NamedTuple

NEVER, ALWAYS = -1, -2  # Numbers of what cannot happen, and of what is certain


COHERENT = frozenset({"OR", "AND", "VOTE"})
CUT_SETS = 10_000  # Sets below any gate
WORK = 8_000_000  # Sets that are made and compared for one tree, about half a second


class Gate(NamedTuple):
    """A gate: ``of`` are numbers of events, or of gates counted behind the events."""

    type: str
    of: tuple[int, ...]
    k: int = 0


class Tree(NamedTuple):
    """A tree that was made smaller."""

    gates: dict[int, Gate]  # by number, each behind those that it refers to
    top: int  # number of a gate or event, `NEVER` or `ALWAYS`
    # gates whose events occur nowhere else, inner ones first, the top among them
    modules: tuple[int, ...]
    origin: dict[int, int]  # new gate, above all others -> the gate of the original tree


def simplified(
    events: int, gates: Sequence[Gate], top: int, known: Sequence[tuple[int, bool]], *, split: bool
) -> Tree:
    """Return a tree of the same value, as ``build`` takes it; unless split, of one module."""
    below = {events + i: gate for i, gate in enumerate(gates)}
    used = [n for n in sorted(reached(below, top)) if n in below]
    parents = Counter(n for number in used for n in below[number].of)
    meaning = {i: i for i in range(events)}
    meaning.update((event, ALWAYS if sure else NEVER) for event, sure in known)
    fresh, origin = count(events + len(gates)), dict[int, int]()
    kept: dict[int, Gate] = {}
    number_of: dict[Gate, int] = {}

    def numbered(gate: Gate, number: int) -> int:
        """Return the number of a gate, which may exist; one input of OR or AND is that input."""
        if len(gate.of) == 1 and gate.type in ("OR", "AND"):
            return gate.of[0]
        first = number_of.setdefault(gate, number)
        kept.setdefault(first, gate)
        return first

    def negated(node: int, number: int) -> int:
        if node in (NEVER, ALWAYS):
            return NEVER + ALWAYS - node
        inner = kept.get(node)
        is_negation = inner is not None and inner.type == "NOT"
        return inner.of[0] if inner and is_negation else numbered(Gate("NOT", (node,)), number)

    for number in used:
        gate = below[number]
        inputs = [meaning[n] for n in gate.of]
        unsure = tuple(n for n in inputs if n not in (NEVER, ALWAYS))
        sure = inputs.count(ALWAYS)
        if gate.type == "NOT":
            meaning[number] = negated(inputs[0], number) if inputs else NEVER
        elif gate.type == "XOR":
            several = len(unsure) > 1
            odd = numbered(Gate("XOR", unsure), number) if several else (*unsure, NEVER)[0]
            meaning[number] = odd
            if sure % 2:  # the opposite, which is a gate of its own
                origin[new := next(fresh)] = number
                meaning[number] = negated(odd, new)
        else:
            needed = {"OR": 1, "AND": max(1, len(inputs))}.get(gate.type, gate.k) - sure
            kind = "OR" if needed == 1 else "AND" if needed == len(unsure) else "VOTE"
            if not 0 < needed <= len(unsure):
                meaning[number] = ALWAYS if needed <= 0 else NEVER
            elif kind == "VOTE":
                meaning[number] = numbered(Gate(kind, unsure, needed), number)
            else:
                flat: dict[int, None] = {}
                for n, original in zip(inputs, gate.of, strict=True):
                    inner = kept.get(n)
                    is_flat = inner and inner.type == kind and parents[original] == 1
                    flat.update(dict.fromkeys(inner.of if inner and is_flat else (n,)))
                flat = {n: None for n in flat if n >= 0}
                meaning[number] = numbered(Gate(kind, tuple(flat)), number)
    tree = Tree(kept, meaning[top], (meaning[top],), origin)
    return _split(tree, fresh) if split and tree.top in kept else tree


def reached(
    gates: Mapping[int, Gate],
    top: int,
    borders: frozenset[int] = frozenset(),
    *,
    behind: bool = False,
) -> list[int]:
    """Return the numbers below the top, but not below ``borders``, in the order of the first visit.

    Or, with ``behind``, each behind those that it refers to.
    """
    entered: dict[int, None] = {}
    finished: dict[int, None] = {}
    waiting = [top]
    while waiting:
        node = waiting.pop()
        if node < 0:
            finished[~node] = None
        elif node not in entered:
            entered[node] = None
            waiting.append(~node)
            if node in gates and (node == top or node not in borders):
                waiting += reversed(gates[node].of)
    return list(finished if behind else entered)


def _split(tree: Tree, fresh: count[int]) -> Tree:
    """Find the modules; inputs of an OR or AND that only share events among each other are one."""
    gates, origin = dict(tree.gates), dict(tree.origin)
    borders = _modules(gates, tree.top)
    modules: list[int] = []
    for module in (n for n in tree.gates if n in borders):
        gate = gates[module]
        groups = _groups(gates, gate, borders) if gate.type in ("OR", "AND") else []
        if len(groups) > 1:
            of = []
            for group in groups:
                if len(group) > 1:
                    origin[new := next(fresh)] = module
                    gates[new] = Gate(gate.type, tuple(group))
                    modules.append(new)
                of.append(new if len(group) > 1 else group[0])
            gates[module] = Gate(gate.type, tuple(of))
        modules.append(module)
    return Tree(gates, tree.top, tuple(modules), origin)


def _groups(gates: Mapping[int, Gate], gate: Gate, borders: frozenset[int]) -> list[list[int]]:
    """Return the inputs of a gate, those that share an event in one group."""
    first = list(range(len(gate.of)))  # input -> an earlier one of its group, or itself
    user: dict[int, int] = {}  # event -> the first input above it

    def leader(place: int) -> int:
        while first[place] != place:
            first[place] = place = first[first[place]]
        return place

    for place, n in enumerate(gate.of):
        for event in (n,) if n in borders else reached(gates, n, borders):
            if event not in gates or event in borders:
                early, late = sorted((leader(user.setdefault(event, place)), leader(place)))
                first[late] = early
    groups: dict[int, list[int]] = {}
    for place, n in enumerate(gate.of):
        groups.setdefault(leader(place), []).append(n)
    return list(groups.values())


def _modules(gates: Mapping[int, Gate], top: int) -> frozenset[int]:
    """Return the gates whose events occur nowhere else, the top among them (Dutuit, Rauzy)."""
    enter: dict[int, int] = {}
    leave: dict[int, int] = {}
    last: dict[int, int] = {}
    waiting = [top]
    clock = 0
    while waiting:
        clock += 1
        node = waiting.pop()
        if node < 0:
            last[~node] = leave[~node] = clock
            continue
        last[node] = clock
        if node not in enter:
            enter[node] = clock
            if node in gates:
                waiting += [~node, *reversed(gates[node].of)]
    low: dict[int, int] = {}
    high: dict[int, int] = {}
    modules = {top}
    for node, gate in gates.items():
        if node in enter:
            low[node] = min(min(enter[b], low.get(b, enter[b])) for b in gate.of)
            high[node] = max(max(last[b], high.get(b, 0)) for b in gate.of)
            if len(gate.of) > 1 and enter[node] < low[node] and high[node] < leave[node]:
                modules.add(node)
    return frozenset(modules)


class _TooMuchError(Exception):
    """More sets, or more work on them, than there may be."""


def minimal_cut_sets(
    events: int,
    gates: Sequence[Gate],
    top: int,
    known: Iterable[tuple[int, bool]] = (),
    *,
    work: int = WORK,
) -> tuple[frozenset[int], ...] | None:
    """Return the minimal cut sets as sets of events, shortest first; known events are in none.

    None where the tree has NOT or XOR, so that no set of events is sufficient, where a gate has
    more than ``CUT_SETS`` sets, or where more than so many are made and compared.
    """
    used = sorted(reached({events + i: gate for i, gate in enumerate(gates)}, top))
    if any(gates[n - events].type not in COHERENT for n in used if n >= events):
        return None
    sets_of = {n: [1 << n] for n in used if n < events}
    sets_of.update((n, [0] if is_certain else []) for n, is_certain in known)
    search = _Search(work)
    try:
        for n in used:
            if n >= events:
                gate = gates[n - events]
                sets_of[n] = search.sets_of_gate(gate, [sets_of[below] for below in gate.of])
    except _TooMuchError:
        return None
    sets = [_members(cut_set) for cut_set in sets_of[top]]
    return tuple(frozenset(cut_set) for cut_set in sorted(sets, key=lambda s: (len(s), s)))


class _Search:
    """Combines cut sets, whose bit ``i`` is event ``i``, with at most so much work."""

    def __init__(self, work: int) -> None:
        self._work = work

    def sets_of_gate(self, gate: Gate, below: list[list[int]]) -> list[int]:
        needed = {"OR": 1, "AND": len(below)}.get(gate.type, gate.k)
        if needed == 1 or not below:
            self._spend(sum(map(len, below)))
            return self._minimal(cut_set for sets in below for cut_set in sets)
        rows: list[list[int]] = [[0]] + [[] for _ in range(needed)]  # at least j of those so far
        for done, sets in enumerate(below, 1):
            # a row that the inputs that remain cannot fill up is of no use
            for j in range(min(needed, done), max(0, needed - (len(below) - done) - 1), -1):
                self._spend(len(rows[j - 1]) * len(sets) + len(rows[j]))
                both = [fewer | cut_set for fewer in rows[j - 1] for cut_set in sets]
                rows[j] = self._minimal(rows[j] + both)
        return rows[needed]

    def _spend(self, work: int) -> None:
        self._work -= work
        if self._work < 0:
            raise _TooMuchError

    def _minimal(self, sets: Iterable[int]) -> list[int]:
        kept: list[int] = []
        by_lowest: dict[int, list[int]] = {}
        ordered = sorted(set(sets), key=lambda cut_set: (cut_set.bit_count(), cut_set))
        for _, same_size in groupby(ordered, int.bit_count):  # none of them contains another
            new = []
            for cut_set in same_size:
                rest, is_minimal = cut_set, True
                while is_minimal:  # whether it contains another one, by its lowest event
                    lowest = rest & -rest
                    others = by_lowest.get(lowest, ())
                    self._spend(1 + len(others))
                    is_minimal = not any(other & cut_set == other for other in others)
                    if not rest:
                        break
                    rest ^= lowest
                new += [cut_set] if is_minimal else []
            kept += new
            for cut_set in new:
                by_lowest.setdefault(cut_set & -cut_set, []).append(cut_set)
        if len(kept) > CUT_SETS:
            raise _TooMuchError
        return kept


def _members(cut_set: int) -> list[int]:
    events = []
    while cut_set:
        lowest = cut_set & -cut_set
        events.append(lowest.bit_length() - 1)
        cut_set ^= lowest
    return events
