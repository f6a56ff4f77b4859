"""Coordinates: neighbours above and below each other as far as the widths allow."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from itertools import pairwise

_ROUNDS = 16


def placed(
    rows: Sequence[Sequence[int]],
    widths: Mapping[int, float],
    links: Sequence[tuple[int, int]],
    gap: float,
) -> dict[int, float]:
    """Return the middle of every node and bend along its row; the leftmost edge is at 0.

    Args:
        rows: in their order.
        widths: of nodes and bends.
        links: pieces of edges between neighbouring rows.
        gap: between two neighbours of a row.
    """
    near: dict[int, list[int]] = {node: [] for row in rows for node in row}
    for start, end in links:
        near[start].append(end)
        near[end].append(start)
    middle: dict[int, float] = {}
    for row in rows:
        left = 0.0
        for node in row:
            middle[node] = left + widths[node] / 2
            left += widths[node] + gap
    for number in range(_ROUNDS):
        for row in rows if number % 2 else reversed(rows):
            wanted = [_mean([middle[other] for other in near[node]], middle[node]) for node in row]
            spans = [widths[node] for node in row]
            middle.update(zip(row, _spread(wanted, spans, gap), strict=True))
    least = min((middle[node] - widths[node] / 2 for node in middle), default=0.0)
    return {node: value - least for node, value in middle.items()}


def _mean(values: Sequence[float], otherwise: float) -> float:
    return sum(values) / len(values) if values else otherwise


def _spread(wanted: Sequence[float], widths: Sequence[float], gap: float) -> list[float]:
    """Move places as little as possible (least squares) until no two overlap.

    Pool adjacent violators: what would overlap becomes a block around its common mean.
    """
    offsets = [0.0]
    for before, after in pairwise(widths):
        offsets.append(offsets[-1] + (before + after) / 2 + gap)
    blocks: list[tuple[float, int]] = []
    for want, offset in zip(wanted, offsets, strict=True):
        total, count = want - offset, 1
        while blocks and blocks[-1][0] / blocks[-1][1] >= total / count:
            before, number = blocks.pop()
            total, count = total + before, count + number
        blocks.append((total, count))
    starts = [total / count for total, count in blocks for _ in range(count)]
    return [start + offset for start, offset in zip(starts, offsets, strict=True)]
