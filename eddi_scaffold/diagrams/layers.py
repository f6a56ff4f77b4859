"""Layers of a graph, and the order of nodes within them, with few crossings of edges.

The steps of Sugiyama, Tagawa and Toda, "Methods for Visual Understanding of Hierarchical System
Structures" (1981): break cycles, assign layers, reduce crossings, place.
"""

from __future__ import annotations

from bisect import bisect_left, insort
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise

Edge = tuple[int, int]
_BENDS = 10
"""Bends for each node and edge; an edge across more layers is drawn as a straight line."""


@dataclass(frozen=True)
class Layers:
    """Nodes and bends by layer.

    Attributes:
        rows: numbers of nodes; bends have numbers from ``count`` on.
        count: how many nodes are not bends.
        chains: for each edge the numbers on its way, in the direction of the layers.
        turned: whether the edge leads against the layers, because it closes a cycle.
    """

    rows: tuple[tuple[int, ...], ...]
    count: int
    chains: tuple[tuple[int, ...], ...]
    turned: tuple[bool, ...]

    def links(self) -> list[Edge]:
        """Return the pieces of all edges between neighbouring layers, each once."""
        pieces = [pair for chain in self.chains for pair in pairwise(chain)]
        return list(dict.fromkeys(pieces))


def layered(count: int, edges: Sequence[Edge]) -> Layers:
    """Assign layers.

    Args:
        count: number of nodes, which are called 0, 1, ...
        edges: from, to; a loop at one node, and an edge across very many layers, has an empty
            chain.
    """
    turned = _turned(count, edges)
    forward = [(b, a) if back else (a, b) for (a, b), back in zip(edges, turned, strict=True)]
    depth = _depths(count, [edge for edge in forward if edge[0] != edge[1]])
    rows: list[list[int]] = [[] for _ in range(max(depth, default=-1) + 1)]
    for node, row in enumerate(depth):
        rows[row].append(node)
    chains: list[tuple[int, ...]] = []
    bends = count
    longest = _longest([depth[end] - depth[start] for start, end in forward], count)
    for start, end in forward:
        if start == end or depth[end] - depth[start] > longest:
            chains.append(())
            continue
        between = []
        for row in range(depth[start] + 1, depth[end]):
            rows[row].append(bends)
            between.append(bends)
            bends += 1
        chains.append((start, *between, end))
    return Layers(tuple(map(tuple, rows)), count, tuple(chains), tuple(turned))


def _longest(spans: Sequence[int], count: int) -> int:
    """Return how many layers an edge may cross: all bends must stay affordable."""
    left = _BENDS * (count + len(spans) + _BENDS)
    for span in sorted(spans):
        left -= span - 1
        if left < 0:
            return span - 1
    return max(spans, default=0)


def _turned(count: int, edges: Sequence[Edge]) -> list[bool]:
    """Mark the edges that lead back to a node from which the walk came."""
    leaving: list[list[int]] = [[] for _ in range(count)]
    for number, (start, _) in enumerate(edges):
        leaving[start].append(number)
    state = [0] * count
    turned = [False] * len(edges)
    for root in range(count):
        if state[root]:
            continue
        state[root] = 1
        walk = [(root, iter(leaving[root]))]
        while walk:
            node, rest = walk[-1]
            edge = next(rest, None)
            if edge is None:
                state[node] = 2
                walk.pop()
                continue
            target = edges[edge][1]
            if state[target] == 1:
                turned[edge] = target != node
            elif not state[target]:
                state[target] = 1
                walk.append((target, iter(leaving[target])))
    return turned


def _depths(count: int, edges: Sequence[Edge]) -> list[int]:
    """Return the longest way to each node; sources then move close to what they lead to."""
    missing = [0] * count
    following: list[list[int]] = [[] for _ in range(count)]
    for start, end in edges:
        missing[end] += 1
        following[start].append(end)
    depth = [0] * count
    order = [node for node in range(count) if not missing[node]]
    for node in order:
        for target in following[node]:
            depth[target] = max(depth[target], depth[node] + 1)
            missing[target] -= 1
            if not missing[target]:
                order.append(target)
    entered = {end for _, end in edges}
    for node in reversed(order):
        if node not in entered and following[node]:
            depth[node] = min(depth[target] for target in following[node]) - 1
    return depth


Rows = list[list[int]]
_SWEEPS = 12


def ordered(layers: Layers) -> Rows:
    """Return the layers, each in an order that gives few crossings.

    Sweeps down and up by the mean place of the neighbours (barycentre), the best order of all is
    kept; the order of the model decides where nothing else does.
    """
    above: dict[int, list[int]] = {}
    below: dict[int, list[int]] = {}
    for start, end in layers.links():
        above.setdefault(end, []).append(start)
        below.setdefault(start, []).append(end)
    rows = [list(row) for row in layers.rows]
    best, fewest = [list(row) for row in rows], crossings(rows, below)
    for sweep in range(_SWEEPS):
        if sweep % 2:
            for row, fixed in zip(rows[-2::-1], rows[:0:-1], strict=True):
                _sort(row, fixed, below)
        else:
            for row, fixed in zip(rows[1:], rows, strict=False):
                _sort(row, fixed, above)
        count = crossings(rows, below)
        if count < fewest:
            best, fewest = [list(row) for row in rows], count
    return best


def crossings(rows: Sequence[Sequence[int]], below: Mapping[int, Sequence[int]]) -> int:
    """Count the pairs of edges that cross between neighbouring layers."""
    total = 0
    for row, following in pairwise(rows):
        place = {node: number for number, node in enumerate(following)}
        ends: list[int] = []
        for node in row:
            targets = sorted(place[target] for target in below.get(node, ()))
            total += sum(len(ends) - bisect_left(ends, target + 1) for target in targets)
            for target in targets:
                insort(ends, target)
    return total


def _sort(row: list[int], fixed: Sequence[int], neighbours: Mapping[int, Sequence[int]]) -> None:
    place = {node: number for number, node in enumerate(fixed)}
    own = {node: number for number, node in enumerate(row)}

    def mean(node: int) -> float:
        near = neighbours.get(node)
        return sum(place[other] for other in near) / len(near) if near else own[node]

    row.sort(key=lambda node: (mean(node), own[node]))
