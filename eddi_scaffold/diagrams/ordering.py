"""The order of nodes within their layers, with few crossings of edges."""

from __future__ import annotations

from bisect import bisect_left, insort
from collections.abc import Mapping, Sequence
from itertools import pairwise

from eddi_scaffold.diagrams.layers import Layers

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
