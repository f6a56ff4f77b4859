"""Walks over graphs: what feeds what, in one order, without recursion.

A chain of 50,000 nodes is as good as one of two, and shared nodes are visited once.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Container, Hashable, Iterable, Mapping, Sequence
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


def cycles(inputs: Mapping[str, Sequence[str]]) -> list[list[str]]:
    """Return one shortest cycle for each knot of nodes that feed each other.

    Returns:
        Cycles as ids in the direction of support, the first id of the file first, not repeated
        at the end; empty when there is none.
    """
    place = {id_: index for index, id_ in enumerate(inputs)}
    targets = reversed_graph(inputs)
    starts = [(min(knot, key=place.__getitem__), knot) for knot in _knots(inputs, targets)]
    shortest = [_shortest_cycle(targets, start, knot) for start, knot in starts]
    return sorted(filter(None, shortest), key=lambda cycle: place[cycle[0]])


def _knots(graph: Mapping[str, Sequence[str]], targets: Graph) -> list[set[str]]:
    """Return the strongly connected components (Kosaraju, with a stack of its own)."""
    finished: list[str] = []
    seen: set[str] = set()
    for root in graph:
        calls = [(root, False)]
        while calls:
            id_, is_done = calls.pop()
            if is_done:
                finished.append(id_)
            elif id_ not in seen:
                seen.add(id_)
                calls += [(id_, True), *((following, False) for following in graph[id_])]
    knots: list[set[str]] = []
    for root in reversed(finished):  # what leads to it, and is in no knot yet
        knot, waiting = set[str](), [root]
        while waiting:
            id_ = waiting.pop()
            if id_ in seen:
                seen.remove(id_)
                knot.add(id_)
                waiting += targets[id_]
        knots += [knot] if knot else []
    return knots


def _shortest_cycle(
    targets: Mapping[str, Sequence[str]], start: str, knot: Container[str]
) -> list[str]:
    came_from: dict[str, str] = {}
    waiting = deque([start])
    while waiting:
        id_ = waiting.popleft()
        for target in targets[id_]:
            if target == start:
                path = [id_]
                while path[-1] != start:
                    path.append(came_from[path[-1]])
                return path[::-1]
            if target in knot and target not in came_from:
                came_from[target] = id_
                waiting.append(target)
    return []
