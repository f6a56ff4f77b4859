"""Minimal cut sets of coherent trees: from their diagrams, or from their gates.

Sources: Rauzy 1993 (diagrams), Fussell and Vesely 1972 (gates).
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from itertools import product
from typing import Any

from eddi_scaffold.kinds.reliability.fault_tree import COHERENT, Diagram, Gate, Module, reached

LIMIT = 10_000
WORK = 8_000_000
"""Sets that are made and compared for one tree, about half a second."""
CutSet = frozenset[int]


class _TooMuchError(Exception):
    """More sets, or more work on them, than there may be."""


class _Budget:
    """Counts the work on one tree.

    Args:
        sets: how many sets one gate or node may have.
        work: how many sets may be made and compared in all.
    """

    def __init__(self, sets: int, work: int) -> None:
        self._sets = sets
        self._left = work

    def spend(self, work: int) -> None:
        """Count sets that are about to be made or compared."""
        self._left -= work
        if self._left < 0:
            raise _TooMuchError

    def checked(self, sets: list[Any]) -> list[Any]:
        """Return the sets of a gate or node when there are not too many."""
        if len(sets) > self._sets:
            raise _TooMuchError
        return sets


def minimal_cut_sets(
    diagram: Diagram, limit: int = LIMIT, work: int = WORK
) -> tuple[CutSet, ...] | None:
    """Return the minimal cut sets as sets of events, shortest first.

    Args:
        diagram: of a coherent tree.
        limit: how many there may be.
        work: how many sets may be made and compared on the way.

    Returns:
        The sets; None when there are more than ``limit`` on the way, or it takes more work.

    Raises:
        ValueError: the tree is not coherent, so that a set of events is not sufficient.
    """
    if not diagram.coherent:
        raise ValueError("a tree with NOT or XOR has no minimal cut sets")
    known: dict[int, list[CutSet]] = {}
    found: list[CutSet] = []
    budget = _Budget(limit, work)
    try:
        for module in diagram.modules:
            found = _expanded(_of_module(module, budget), known, budget)
            known[module.variable] = found
    except _TooMuchError:
        return None
    return tuple(sorted(found, key=lambda one: (len(one), sorted(one))))


def _of_module(module: Module, budget: _Budget) -> list[CutSet]:
    sets: list[list[CutSet]] = [[], [frozenset()]]
    for variable, high, low in module.nodes:
        without = sets[low]
        budget.spend(len(without))
        extra = []
        for one in sets[high]:
            budget.spend(1 + len(without))
            if not any(other <= one for other in without):
                extra.append(one | {variable})
        sets.append(budget.checked(without + extra))
    return sets[module.root]


def _expanded(sets: list[CutSet], known: dict[int, list[CutSet]], budget: _Budget) -> list[CutSet]:
    """Replace pseudo-events by the cut sets of their modules, which share no event."""
    result: list[CutSet] = []
    for set_ in sets:
        choices = [known.get(event, [frozenset({event})]) for event in sorted(set_)]
        for choice in product(*choices):
            budget.spend(len(choice))
            result.append(frozenset().union(*choice))
            budget.checked(result)
    return result


def cut_sets_of_gates(
    events: int, gates: Sequence[Gate], top: int, limit: int = LIMIT, work: int = WORK
) -> tuple[CutSet, ...] | None:
    """Return the minimal cut sets of a tree whose diagram would be too large, shortest first.

    Args:
        events: how many basic events there are.
        gates: each refers to events and to gates before it.
        top: number of the top event.
        limit: how many sets there may be, also below each gate.
        work: how many sets may be made and compared on the way.

    Returns:
        The complete list; None when there are more than ``limit`` on the way, or it takes more
        work.

    Raises:
        ValueError: the tree is not coherent, so that a set of events is not sufficient.
    """
    used = sorted(reached({events + i: gate for i, gate in enumerate(gates)}, top))
    if any(gates[n - events].type not in COHERENT for n in used if n >= events):
        raise ValueError("a tree with NOT or XOR has no minimal cut sets")
    known = {n: [1 << n] for n in used if n < events}  # bit i: event i
    budget = _Budget(limit, work)
    try:
        for node in used:
            if node >= events:
                gate = gates[node - events]
                known[node] = _of_gate(gate, [known[n] for n in gate.of], budget)
    except _TooMuchError:
        return None
    sets = [frozenset(_bits(one)) for one in known[top]]
    return tuple(sorted(sets, key=lambda one: (len(one), sorted(one))))


def _of_gate(gate: Gate, below: list[list[int]], budget: _Budget) -> list[int]:
    needed = {"OR": 1, "AND": len(below)}.get(gate.type, gate.k)
    if not below:
        return []
    if needed == 1:
        budget.spend(sum(len(sets) for sets in below))
        return budget.checked(_minimal((set_ for sets in below for set_ in sets), budget))
    # rows[j]: at least j of the inputs so far
    rows: list[list[int]] = [[0]] + [[] for _ in range(needed)]
    for one in below:
        for j in range(needed, 0, -1):
            budget.spend(len(rows[j - 1]) * len(one) + len(rows[j]))
            both = [a | b for a in rows[j - 1] for b in one]
            rows[j] = budget.checked(_minimal(rows[j] + both, budget))
    return rows[needed]


def _minimal(sets: Iterable[int], budget: _Budget) -> list[int]:
    """Return the sets that hold no other one."""
    by_size: dict[int, list[int]] = {}
    for one in sorted(set(sets)):
        by_size.setdefault(one.bit_count(), []).append(one)
    kept: list[int] = []
    by_first: dict[int, list[int]] = {}
    for size in sorted(by_size):
        found = [one for one in by_size[size] if not _covered(one, by_first, budget)]
        kept += found
        for one in found:  # sets of one size do not cover each other
            by_first.setdefault(one & -one, []).append(one)
    return kept


def _covered(one: int, by_first: dict[int, list[int]], budget: _Budget) -> bool:
    rest = one
    while rest:
        first = rest & -rest
        rest ^= first
        others = by_first.get(first, ())
        budget.spend(1 + len(others))
        if any(other & one == other for other in others):
            return True
    return False


def _bits(number: int) -> list[int]:
    found = []
    while number:
        first = number & -number
        found.append(first.bit_length() - 1)
        number ^= first
    return found
