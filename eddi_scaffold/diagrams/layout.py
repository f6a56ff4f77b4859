"""A diagram with coordinates: boxes, and lines through points. No font is asked.

The steps of Sugiyama, Tagawa and Toda, "Methods for Visual Understanding of Hierarchical System
Structures" (1981): break cycles, assign layers, reduce crossings, place.
"""

from __future__ import annotations

from bisect import bisect_left, insort
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from graphlib import TopologicalSorter
from itertools import pairwise

from eddi_scaffold.diagrams import Diagram, DiagramEdge, DiagramNode

LINE = 15.0  # height of a line of 12 pixels
RULE = 6.0  # space around the line below the heading of a table
_PADDING_X, _PADDING_Y = 12.0, 8.0
_GAP_X, _GAP_Y = 26.0, 44.0
_BEND = 10.0
_MOST_BENDS = 20  # an edge across more layers is drawn as a straight line
_APART = 9.0  # how far each of two opposite edges keeps from the middle between them
_LONGEST = 28  # letters of a line of a label
_ROUND = {"ellipse": 1.25, "hexagon": 1.2, "and": 1.1, "or": 1.2, "not": 1.3}
"""How much wider than its text a shape must be."""
_SWEEPS, _ROUNDS = 12, 16

Edge = tuple[int, int]
Point = tuple[float, float]
Rows = Sequence[Sequence[int]]


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
    points: tuple[Point, ...]
    label: Point


@dataclass(frozen=True)
class Layout:
    """A diagram that can be drawn."""

    boxes: tuple[Box, ...]
    routes: tuple[Route, ...]
    width: float
    height: float


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
    # Of two opposite edges, each runs on a side of its own.
    different = {(a, b) for a, b in ends if a != b}
    sides = {(a, b): 1 if a < b else -1 for a, b in different if (b, a) in different}
    for edge, chain, (a, b) in zip(edges, layers.chains, ends, strict=True):
        for bend in chain[1:-1]:
            widths[bend] = max(widths[bend], text_width(edge.label))
        if (a, b) in sides:
            wide = 2 * (_APART + text_width(edge.label) + _BEND)
            widths[a], widths[b] = max(widths[a], wide), max(widths[b], wide)
    middles = placed(rows, widths, layers.links())
    heights = [
        max((sizes[node][1] for node in row if node < len(nodes)), default=0.0) for row in rows
    ]
    total, top = sum(heights) + _GAP_Y * max(len(heights) - 1, 0), 0.0
    at: dict[int, Point] = {}
    half: dict[int, float] = {}  # height of the row of a node or bend
    for row, height in zip(rows, heights, strict=True):
        y = top + height / 2
        at |= {node: (middles[node], total - y if diagram.direction == "up" else y) for node in row}
        half |= dict.fromkeys(row, height / 2)
        top += height + _GAP_Y
    boxes = [Box(node, *at[k], *sizes[k], labels[k]) for k, node in enumerate(nodes)]
    routes = []
    for edge, (a, b), chain in zip(edges, ends, layers.chains, strict=True):
        # Two points for each bend, so that a line passes its row upright between the boxes.
        bends = [(at[k][0], at[k][1] + s * half[k]) for k in chain[1:-1] for s in (-1, 1)]
        side = sides.get((a, b), 0) if len(chain) == 2 else 0
        routes.append(_route(edge, _points(boxes[a], boxes[b], bends), side))
    width = max((middles[node] + widths[node] / 2 for node in widths), default=0.0)
    return Layout(tuple(boxes), tuple(routes), max(width, *(x for x, _ in at.values()), 0.0), total)


@dataclass(frozen=True)
class Layers:
    """Nodes and bends by layer."""

    # numbers of nodes; bends have numbers behind those of the nodes
    rows: tuple[tuple[int, ...], ...]
    # for each edge the numbers on its way, in the direction of the layers
    chains: tuple[tuple[int, ...], ...]

    def links(self) -> list[Edge]:
        """Return the pieces of all edges between neighbouring layers, each once."""
        return list(dict.fromkeys(pair for chain in self.chains for pair in pairwise(chain)))


def layered(count: int, edges: Sequence[Edge]) -> Layers:
    """Assign layers; a loop, and an edge across many layers, has an empty chain."""
    turned = zip(edges, _turned(count, edges), strict=True)
    forward = [(b, a) if is_back else (a, b) for (a, b), is_back in turned]
    depth = _depths(count, [edge for edge in forward if edge[0] != edge[1]])
    rows: list[list[int]] = [[] for _ in range(max(depth, default=-1) + 1)]
    for node, row in enumerate(depth):
        rows[row].append(node)
    chains: list[tuple[int, ...]] = []
    bends = count
    for start, end in forward:
        between = range(bends, bends + depth[end] - depth[start] - 1)
        if start == end or len(between) > _MOST_BENDS:
            chains.append(())
            continue
        for row, bend in enumerate(between, depth[start] + 1):
            rows[row].append(bend)
        chains.append((start, *between, end))
        bends += len(between)
    return Layers(tuple(map(tuple, rows)), tuple(chains))


def _turned(count: int, edges: Sequence[Edge]) -> list[bool]:
    """Mark the edges that lead back to a node from which the walk came."""
    leaving: list[list[int]] = [[] for _ in range(count)]
    for number, (start, _) in enumerate(edges):
        leaving[start].append(number)
    new, on_walk, done = 0, 1, 2
    state = [new] * count
    turned = [False] * len(edges)
    # nodes to enter, each with the edge that leads there, and those to leave, as complements
    waiting: list[tuple[int, int | None]] = [(node, None) for node in reversed(range(count))]
    while waiting:
        node, edge = waiting.pop()
        if node < 0:
            state[~node] = done
        elif state[node] == new:
            state[node] = on_walk
            waiting.append((~node, None))
            waiting += ((edges[number][1], number) for number in reversed(leaving[node]))
        elif state[node] == on_walk and edge is not None:
            turned[edge] = edges[edge][0] != node
    return turned


def _depths(count: int, edges: Sequence[Edge]) -> list[int]:
    """Return the longest way to each node; sources then move close to what they lead to."""
    before: list[list[int]] = [[] for _ in range(count)]
    following: list[list[int]] = [[] for _ in range(count)]
    for start, end in edges:
        before[end].append(start)
        following[start].append(end)
    depth = [0] * count
    for node in TopologicalSorter(dict(enumerate(before))).static_order():
        depth[node] = max((depth[start] + 1 for start in before[node]), default=0)
    for node in range(count):
        if following[node] and not before[node]:
            depth[node] = min(depth[target] for target in following[node]) - 1
    return depth


def ordered(layers: Layers) -> list[list[int]]:
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
        down = sweep % 2 == 0
        in_turn = rows if down else rows[::-1]
        for fixed, row in pairwise(in_turn):
            _sort(row, fixed, above if down else below)
        count = crossings(rows, below)
        if count < fewest:
            best, fewest = [list(row) for row in rows], count
    return best


def crossings(rows: Rows, below: Mapping[int, Sequence[int]]) -> int:
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
    means = []
    for number, node in enumerate(row):
        places = [place[other] for other in neighbours.get(node, ())] or [number]
        means.append((sum(places) / len(places), number, node))
    row[:] = [node for _, _, node in sorted(means)]


def placed(rows: Rows, widths: Mapping[int, float], links: Sequence[Edge]) -> dict[int, float]:
    """Return the middle of every node and bend along its row; the leftmost edge is at 0."""
    neighbours: dict[int, list[int]] = {node: [] for row in rows for node in row}
    for start, end in links:
        neighbours[start].append(end)
        neighbours[end].append(start)
    middles: dict[int, float] = {}
    for row in rows:
        left = 0.0
        for node in row:
            middles[node] = left + widths[node] / 2
            left += widths[node] + _GAP_X
    for number in range(_ROUNDS):
        for row in rows if number % 2 else reversed(rows):
            means = []
            for node in row:
                places = [middles[other] for other in neighbours[node]] or [middles[node]]
                means.append(sum(places) / len(places))
            spread = _spread(means, [widths[node] for node in row])
            middles.update(zip(row, spread, strict=True))
    least = min((middles[node] - widths[node] / 2 for node in middles), default=0.0)
    return {node: value - least for node, value in middles.items()}


def _spread(places: Sequence[float], widths: Sequence[float]) -> list[float]:
    """Move places as little as possible (least squares) until no two overlap.

    Pool adjacent violators: what would overlap becomes a block around its common mean.
    """
    offsets = [0.0]
    for before, after in pairwise(widths):
        offsets.append(offsets[-1] + (before + after) / 2 + _GAP_X)
    blocks: list[tuple[float, int]] = []
    for place, offset in zip(places, offsets, strict=True):
        total, count = place - offset, 1
        while blocks and blocks[-1][0] / blocks[-1][1] >= total / count:
            total_before, count_before = blocks.pop()
            total, count = total + total_before, count + count_before
        blocks.append((total, count))
    starts = [total / count for total, count in blocks for _ in range(count)]
    return [start + offset for start, offset in zip(starts, offsets, strict=True)]


def text_width(text: str) -> float:
    """Return the width of 12 pixels bold, as browsers without our fonts draw it (DejaVu Sans)."""
    return sum(11.9 if char in "MWmw@%" else 8.8 if char.isupper() else 7.6 for char in text)


def label_of(node: DiagramNode) -> tuple[str, ...]:
    """Return the lines of a label, wrapped between words or parts of a name, and cut."""
    lines: list[str] = []
    for text in (" ".join(line.split()) for line in node.lines):
        if len(text) <= _LONGEST:
            lines.append(text)
            continue
        cut = max(text.rfind(mark, 0, _LONGEST) for mark in " _-./")
        if cut < _LONGEST // 2:
            cut = _LONGEST - 1
        first, rest = text[: cut + 1].rstrip(), text[cut + 1 :].lstrip()
        lines += [first, rest if len(rest) <= _LONGEST else f"{rest[: _LONGEST - 1]}…"]
    return tuple(lines)


def _size(node: DiagramNode, label: Sequence[str]) -> tuple[float, float]:
    widest = max((text_width(line) for line in label), default=0.0)
    stretch = _ROUND.get(node.shape, 1.0)
    rule = RULE if node.shape == "table" and len(label) > 1 else 0.0
    height = len(label) * LINE * stretch + 2 * _PADDING_Y + rule
    return widest * stretch + 2 * _PADDING_X, height


def _route(edge: DiagramEdge, points: Sequence[Point], side: int) -> Route:
    """Return a line with its label; opposite ones are parallel, labels outside."""
    shifted = tuple((x + side * _APART, y) for x, y in points)
    (x, y), (u, v) = shifted[len(shifted) // 2 - 1 :][:2]
    outside = side * (text_width(edge.label) / 2 + 4)
    return Route(edge, shifted, ((x + u) / 2 + outside, (y + v) / 2))


def _points(start: Box, end: Box, bends: Sequence[Point]) -> Sequence[Point]:
    """Return where a line leaves its source, bends, and meets its target."""
    if start is end:
        side = start.x + start.width / 2
        return ((side, start.y - 6), (side + 22, start.y), (side, start.y + 6))
    upward = start.y > end.y
    bends = sorted(bends, key=lambda point: -point[1] if upward else point[1])
    after = bends[0] if bends else (end.x, end.y)
    before = bends[-1] if bends else (start.x, start.y)
    return (_border(start, after), *bends, _border(end, before))


def _border(box: Box, towards: Point) -> Point:
    """Return the point of a box's upper or lower side where a line meets it, near its middle."""
    reach = box.width / 4
    x = min(max(towards[0], box.x - reach), box.x + reach)
    if box.node.shape in ("ellipse", "and", "or", "not", "hexagon"):
        x = box.x
    return x, box.y + (box.height / 2 if towards[1] > box.y else -box.height / 2)
