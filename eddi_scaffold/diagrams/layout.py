"""A diagram with coordinates: boxes, and lines through points. No font is asked."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise

from eddi_scaffold.diagrams.diagram import Diagram, DiagramEdge, DiagramNode
from eddi_scaffold.diagrams.layers import layered, ordered

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


LINE = 15.0
"""Height of a line of 12 pixels."""
RULE = 6.0
"""Space around the line below the heading of a table."""
_PADDING_X, _PADDING_Y = 12.0, 8.0
_GAP_X, _GAP_Y = 26.0, 44.0
_BEND = 10.0
_APART = 9.0
"""How far each of two opposite edges keeps from the middle between them."""
_LONGEST = 28
"""Letters of a line of a label."""
_ROUND = {"ellipse": 1.25, "hexagon": 1.2, "and": 1.1, "or": 1.2, "not": 1.3}
"""How much wider than its text a shape must be."""


@dataclass(frozen=True)
class Box:
    """Position of a node: its middle, its size, and the lines of its label."""

    node: DiagramNode
    x: float
    y: float
    width: float
    height: float
    lines: tuple[str, ...]


@dataclass(frozen=True)
class Route:
    """Where an edge runs: points from its source to its target, and the middle of its label."""

    edge: DiagramEdge
    points: tuple[tuple[float, float], ...]
    label: tuple[float, float]


@dataclass(frozen=True)
class Layout:
    """A diagram that can be drawn."""

    boxes: tuple[Box, ...]
    lines: tuple[Route, ...]
    width: float
    height: float


def text_width(text: str) -> float:
    """Return the width of 12 pixels bold, as browsers without our fonts draw it (DejaVu Sans)."""
    return sum(11.9 if one in "MWmw@%" else 8.8 if one.isupper() else 7.6 for one in text)


def laid_out(diagram: Diagram) -> Layout:
    """Give every node and edge of a diagram its place."""
    nodes = diagram.nodes
    number = {node.id: index for index, node in enumerate(nodes)}
    edges = [edge for edge in diagram.edges if edge.source in number and edge.target in number]
    ends = [(number[edge.source], number[edge.target]) for edge in edges]
    layers = layered(len(nodes), ends)
    rows = ordered(layers)
    labels = [label_of(node) for node in nodes]
    sizes = [_size(node, label) for node, label in zip(nodes, labels, strict=True)]
    widths = {node: sizes[node][0] if node < len(nodes) else _BEND for row in rows for node in row}
    opposite = _opposite(ends)
    for edge, chain, (a, b) in zip(edges, layers.chains, ends, strict=True):
        for bend in chain[1:-1]:
            widths[bend] = max(widths[bend], _label_width(edge))
        if (a, b) in opposite:
            wide = 2 * (_APART + _label_width(edge) + _BEND)
            widths[a], widths[b] = max(widths[a], wide), max(widths[b], wide)
    middle = placed(rows, widths, layers.links(), _GAP_X)
    heights = [
        max((sizes[node][1] for node in row if node < len(nodes)), default=0.0) for row in rows
    ]
    y, total = _levels(heights, upward=diagram.direction == "up")
    at = {node: (middle[node], y[row]) for row, found in enumerate(rows) for node in found}
    half = {y[row]: height / 2 for row, height in enumerate(heights)}
    boxes = tuple(
        Box(node, *at[index], *sizes[index], labels[index]) for index, node in enumerate(nodes)
    )
    lines = tuple(
        _line(
            edge,
            _points(boxes[a], boxes[b], _bends([at[bend] for bend in chain[1:-1]], half)),
            side=opposite.get((a, b), 0) if len(chain) == 2 else 0,
        )
        for edge, (a, b), chain in zip(edges, ends, layers.chains, strict=True)
    )
    width = max((middle[node] + widths[node] / 2 for node in widths), default=0.0)
    return Layout(boxes, lines, max(width, *(x for x, _ in at.values()), 0.0), total)


def _opposite(ends: Sequence[tuple[int, int]]) -> dict[tuple[int, int], int]:
    """Return each edge that has an opposite one, and on which side of it it runs."""
    every = set(ends)
    return {(a, b): 1 if a < b else -1 for a, b in every if a != b and (b, a) in every}


def _label_width(edge: DiagramEdge) -> float:
    return text_width(edge.label)


def _line(edge: DiagramEdge, points: tuple[tuple[float, float], ...], side: int) -> Route:
    """Return a line with its label; opposite ones are parallel, labels outside."""
    points = tuple((x + side * _APART, y) for x, y in points)
    (x, y), (u, v) = points[len(points) // 2 - 1], points[len(points) // 2]
    outside = side * (_label_width(edge) / 2 + 4)
    return Route(edge, points, ((x + u) / 2 + outside, (y + v) / 2))


def label_of(node: DiagramNode) -> tuple[str, ...]:
    """Return the lines of a label, wrapped between words or parts of a name, and cut."""
    found: list[str] = []
    for line in node.lines:
        found += _wrapped(" ".join(line.split()))
    return tuple(found)


def _wrapped(text: str) -> list[str]:
    if len(text) <= _LONGEST:
        return [text]
    cut = max(text.rfind(mark, 0, _LONGEST) for mark in " _-./")
    if cut < _LONGEST // 2:
        cut = _LONGEST - 1
    first, rest = text[: cut + 1].rstrip(), text[cut + 1 :].lstrip()
    return [first, rest if len(rest) <= _LONGEST else f"{rest[: _LONGEST - 1]}…"]


def _size(node: DiagramNode, label: Sequence[str]) -> tuple[float, float]:
    widest = max((text_width(line) for line in label), default=0.0)
    stretch = _ROUND.get(node.shape, 1.0)
    rule = RULE if node.shape == "table" and len(label) > 1 else 0.0
    height = len(label) * LINE * stretch + 2 * _PADDING_Y + rule
    return widest * stretch + 2 * _PADDING_X, height


def _levels(heights: Sequence[float], *, upward: bool) -> tuple[list[float], float]:
    """Return the middle of each row and the height of all; the first row is at the foot if up."""
    total = sum(heights) + _GAP_Y * max(len(heights) - 1, 0)
    found, edge = [], 0.0
    for height in heights:
        middle = edge + height / 2
        found.append(total - middle if upward else middle)
        edge += height + _GAP_Y
    return found, total


def _bends(
    middles: Sequence[tuple[float, float]], half: Mapping[float, float]
) -> list[tuple[float, float]]:
    """Return two points for each bend, so that a line passes its row upright between the boxes."""
    return [(x, y + side * half[y]) for x, y in middles for side in (-1, 1)]


def _points(
    start: Box, end: Box, between: Sequence[tuple[float, float]]
) -> tuple[tuple[float, float], ...]:
    """Return where a line leaves its source, bends, and meets its target."""
    if start is end:
        side = start.x + start.width / 2
        return ((side, start.y - 6), (side + 22, start.y), (side, start.y + 6))
    upward = start.y > end.y
    between = sorted(between, key=lambda point: -point[1] if upward else point[1])
    after = between[0] if between else (end.x, end.y)
    before = between[-1] if between else (start.x, start.y)
    return (_border(start, after), *between, _border(end, before))


def _border(box: Box, towards: tuple[float, float]) -> tuple[float, float]:
    """Return the point of a box's upper or lower side where a line meets it, near its middle."""
    down = towards[1] > box.y
    reach = box.width / 4
    x = min(max(towards[0], box.x - reach), box.x + reach)
    if box.node.shape in ("ellipse", "and", "or", "not", "hexagon"):
        x = box.x
    return x, box.y + (box.height / 2 if down else -box.height / 2)
