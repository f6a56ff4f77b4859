"""Minimal cut sets of coherent trees: from their diagrams, or from their gates; and bounds of them.

Sources: Rauzy 1993 (diagrams), Fussell and Vesely 1972 (gates), Esary and Proschan 1963 (bounds).
"""

from __future__ import annotations

from itertools import product
from typing import Dict, FrozenSet, Iterable, List, Optional, Sequence, Tuple

import numpy as np

from .diagram import COHERENT, Diagram, Gate, Module, reached

LIMIT = 10_000
_PRODUCTS = 1_000_000
CutSet = FrozenSet[int]


def minimal_cut_sets(diagram: Diagram, limit: int = LIMIT) -> Optional[Tuple[CutSet, ...]]:
    """Return the minimal cut sets as sets of events, shortest first.

    Args:
        diagram: of a coherent tree.
        limit: how many there may be.

    Returns:
        The sets; None when there are more than ``limit`` on the way.

    Raises:
        ValueError: the tree is not coherent, so that a set of events does not say enough.
    """
    if not diagram.coherent:
        raise ValueError("a tree with NOT or XOR has no minimal cut sets")
    known: Dict[int, List[CutSet]] = {}
    found: Optional[List[CutSet]] = []
    for module in diagram.modules:
        found = _of_module(module, limit)
        if found is not None:
            found = _expanded(found, known, limit)
        if found is None:
            return None
        known[module.variable] = found
    return tuple(sorted(found or (), key=lambda one: (len(one), sorted(one))))


def _of_module(module: Module, limit: int) -> Optional[List[CutSet]]:
    sets: List[List[CutSet]] = [[], [frozenset()]]
    for variable, high, low in module.nodes:
        without = sets[low]
        extra = [one for one in sets[high] if not any(other <= one for other in without)]
        sets.append(without + [one | {variable} for one in extra])
        if len(sets[-1]) > limit:
            return None
    return sets[module.root]


def _expanded(
    sets: List[CutSet], known: Dict[int, List[CutSet]], limit: int
) -> Optional[List[CutSet]]:
    """Replace pseudo-events by the cut sets of their modules, which share no event."""
    result: List[CutSet] = []
    for one in sets:
        choices = [known.get(event, [frozenset({event})]) for event in sorted(one)]
        for choice in product(*choices):
            result.append(frozenset().union(*choice))
            if len(result) > limit:
                return None
    return result


def cut_sets_of_gates(
    events: int, gates: Sequence[Gate], top: int, limit: int = LIMIT
) -> Optional[Tuple[CutSet, ...]]:
    """Return the minimal cut sets of a tree whose diagram would be too large, shortest first.

    Args:
        events: how many basic events there are.
        gates: each refers to events and to gates before it.
        top: number of the top event.
        limit: how many sets there may be, also below each gate.

    Returns:
        The complete list; None when there are more than ``limit`` on the way.

    Raises:
        ValueError: the tree is not coherent, so that a set of events does not say enough.
    """
    used = sorted(reached(events, gates, top))
    if any(gates[n - events].type not in COHERENT for n in used if n >= events):
        raise ValueError("a tree with NOT or XOR has no minimal cut sets")
    known = {n: [1 << n] for n in used if n < events}  # bit i: event i
    for node in used:
        if node < events:
            continue
        gate = gates[node - events]
        found = _of_gate(gate, [known[n] for n in gate.of], limit)
        if found is None:
            return None
        known[node] = found
    sets = [frozenset(_bits(one)) for one in known[top]]
    return tuple(sorted(sets, key=lambda one: (len(one), sorted(one))))


def _of_gate(gate: Gate, below: List[List[int]], limit: int) -> Optional[List[int]]:
    needed = {"OR": 1, "AND": len(below)}.get(gate.type, gate.k)
    if not below:
        return []
    if needed == 1:
        found = _minimal(one for sets in below for one in sets)
        return found if len(found) <= limit else None
    # rows[j]: at least j of the inputs so far
    rows: List[List[int]] = [[0]] + [[] for _ in range(needed)]
    for one in below:
        for j in range(needed, 0, -1):
            if len(rows[j - 1]) * len(one) > _PRODUCTS:
                return None
            both = [a | b for a in rows[j - 1] for b in one]
            rows[j] = _minimal(rows[j] + both)
            if len(rows[j]) > limit:
                return None
    return rows[needed]


def _minimal(sets: Iterable[int]) -> List[int]:
    """Return the sets that hold no other one."""
    by_size: Dict[int, List[int]] = {}
    for one in sorted(set(sets)):
        by_size.setdefault(bin(one).count("1"), []).append(one)
    kept: List[int] = []
    by_first: Dict[int, List[int]] = {}
    for size in sorted(by_size):
        found = [one for one in by_size[size] if not _covered(one, by_first)]
        kept += found
        for one in found:  # sets of one size do not cover each other
            by_first.setdefault(one & -one, []).append(one)
    return kept


def _covered(one: int, by_first: Dict[int, List[int]]) -> bool:
    rest = one
    while rest:
        first = rest & -rest
        rest ^= first
        if any(other & one == other for other in by_first.get(first, ())):
            return True
    return False


def _bits(number: int) -> List[int]:
    found = []
    while number:
        first = number & -number
        found.append(first.bit_length() - 1)
        number ^= first
    return found


class CutSetBounds:
    """Bounds of a coherent tree's probability: max P(cut) <= p <= 1 - prod(1 - P(cut)).

    Args:
        sets: all minimal cut sets, numbers of events.
    """

    def __init__(self, sets: Iterable[Sequence[int]]) -> None:
        by_size: Dict[int, List[List[int]]] = {}
        for one in sets:
            by_size.setdefault(len(one), []).append(sorted(one))
        self._groups = [np.array(group, dtype=int) for group in by_size.values()]

    def lower(self, q: Sequence[float]) -> float:
        """Return the probability of the most probable cut set."""
        return max((float(p.max()) for p in self._products(q)), default=0.0)

    def upper(self, q: Sequence[float]) -> float:
        """Return the probability that some cut set occurs, as if they shared no event."""
        return float(-np.expm1(self._log_survival(q)))

    def survival(self, q: Sequence[float]) -> float:
        """Return one minus the upper bound, without cancellation."""
        return float(np.exp(self._log_survival(q)))

    def _products(self, q: Sequence[float]) -> List[np.ndarray]:
        values = np.array(q)
        return [values[group].prod(axis=1) for group in self._groups]

    def _log_survival(self, q: Sequence[float]) -> float:
        with np.errstate(divide="ignore"):  # a cut set that is certain
            return float(sum(np.log1p(-p).sum() for p in self._products(q)))
