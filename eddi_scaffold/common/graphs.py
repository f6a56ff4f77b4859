"""Walks over graphs: what feeds what, in one order, without recursion.

A chain of 50,000 nodes is as good as one of two, and shared nodes are visited once.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Hashable, Iterable, Mapping, Sequence
from graphlib import CycleError, TopologicalSorter
from typing import TypeVar

T = TypeVar("T", bound=Hashable)
Graph = dict[str, tuple[str, ...]]  # node -> nodes next to it, without repetitions


def reversed_graph(graph: Mapping[T, Sequence[T]]) -> dict[T, tuple[T, ...]]:
    """Return the graph with every edge turned round."""
    targets: dict[T, list[T]] = {id_: [] for id_ in graph}
    for id_, sources in graph.items():
        for source in sources:
            targets[source].append(id_)
    return {id_: tuple(following) for id_, following in targets.items()}


def reached(graph: Mapping[T, Sequence[T]], starts: Iterable[T]) -> set[T]:
    """Return every node that a walk from ``starts`` along the graph comes to, starts included."""
    seen = set(starts)
    waiting = list(seen)
    while waiting:
        for following in graph[waiting.pop()]:
            if following not in seen:
                seen.add(following)
                waiting.append(following)
    return seen


def in_order(inputs: Mapping[str, Sequence[str]]) -> list[str]:
    """Return the nodes so that each follows its inputs; nodes in or behind a cycle are left out.

    Ties are broken by the order of ``inputs``, that is of the file.
    """
    missing = {id_: len(sources) for id_, sources in inputs.items()}
    targets = reversed_graph(inputs)
    waiting = deque(id_ for id_, count in missing.items() if not count)
    ordered: list[str] = []
    while waiting:
        id_ = waiting.popleft()
        ordered.append(id_)
        for target in targets[id_]:
            missing[target] -= 1
            if not missing[target]:
                waiting.append(target)
    return ordered


_MOST_CYCLES = 20


def cycles(inputs: Mapping[str, Sequence[str]]) -> list[list[str]]:
    """Return cycles that share no node, :data:`_MOST_CYCLES` at most.

    Each has its ids in the direction of support, the first id of the file first, not repeated.
    """
    place = {id_: index for index, id_ in enumerate(inputs)}
    remaining, circles = dict(inputs), list[list[str]]()
    while len(circles) < _MOST_CYCLES:
        try:
            TopologicalSorter(remaining).prepare()
            break
        except CycleError as failure:
            cycle = failure.args[1][1:]
        start = cycle.index(min(cycle, key=place.__getitem__))
        circles.append(cycle[start:] + cycle[:start])
        for id_ in cycle:
            del remaining[id_]
    return sorted(circles, key=lambda cycle: place[cycle[0]])
