"""Minimal cut sets of coherent trees, from their diagrams (after Rauzy 1993)."""

from __future__ import annotations

from itertools import product
from typing import Dict, FrozenSet, List, Optional, Tuple

from .diagram import Diagram, Module

LIMIT = 10_000
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
