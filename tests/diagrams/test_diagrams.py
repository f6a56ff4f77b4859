"""The layered layout keeps its rules on any graph, and the SVG of any label is an SVG."""

from itertools import combinations, pairwise
from xml.etree import ElementTree as ET

from hypothesis import given
from hypothesis import strategies as st

from eddi_scaffold.diagrams import Diagram, DiagramEdge, DiagramNode
from eddi_scaffold.diagrams.layout import (
    crossings,
    label_of,
    laid_out,
    layered,
    ordered,
    placed,
    text_width,
)
from eddi_scaffold.diagrams.svg import drawn

SVG = "{http://www.w3.org/2000/svg}"


@st.composite
def graphs(draw: st.DrawFn) -> tuple[int, list[tuple[int, int]]]:
    count = draw(st.integers(0, 12))
    nodes = st.integers(0, max(count - 1, 0))
    edges = st.lists(st.tuples(nodes, nodes), max_size=24, unique=True)
    return count, draw(edges) if count else []


@given(graphs())
def test_every_piece_of_an_edge_leads_one_layer_on(
    graph: tuple[int, list[tuple[int, int]]],
) -> None:
    count, edges = graph
    layers = layered(count, edges)
    row = {node: number for number, nodes in enumerate(layers.rows) for node in nodes}
    assert {*range(count)} <= {*row}
    for (start, end), chain in zip(edges, layers.chains, strict=True):
        if start == end:
            assert chain == ()
            continue
        assert {chain[0], chain[-1]} == {start, end}
        assert all(row[b] == row[a] + 1 for a, b in pairwise(chain))


@given(graphs())
def test_the_order_has_no_more_crossings_than_the_first_one(
    graph: tuple[int, list[tuple[int, int]]],
) -> None:
    layers = layered(*graph)
    below: dict[int, list[int]] = {}
    for start, end in layers.links():
        below.setdefault(start, []).append(end)
    rows = ordered(layers)
    assert [sorted(row) for row in rows] == [sorted(row) for row in layers.rows]
    assert crossings(rows, below) <= crossings(layers.rows, below)


@given(st.lists(st.lists(st.floats(1, 50), min_size=1, max_size=5), min_size=1, max_size=4))
def test_neighbours_of_a_row_never_overlap(widths: list[list[float]]) -> None:
    rows, spans = [], {}
    for row in widths:
        rows.append([len(spans) + number for number in range(len(row))])
        spans |= {len(spans) + number: width for number, width in enumerate(row)}
    links = [(a, b) for upper, lower in pairwise(rows) for a in upper for b in lower]
    middle = placed(rows, spans, links)
    for row in rows:
        for a, b in pairwise(row):
            assert middle[b] - middle[a] >= (spans[a] + spans[b]) / 2 - 1e-6


def chain(count: int) -> Diagram:
    """A network of 40 nodes as people draw them: a few parents each."""
    names = [f"Node_{number}" for number in range(count)]
    edges = [
        DiagramEdge(names[start], names[end])
        for end in range(1, count)
        for start in sorted({(end - 1) // 2, end * 7 // 10})
    ]
    nodes = tuple(DiagramNode(name, (name, "low, high"), "table") for name in names)
    return Diagram("Forty", nodes, tuple(edges))


def test_labels_of_opposite_edges_stand_apart_inside_the_picture() -> None:
    nodes = tuple(DiagramNode(name, (name,), "rounded") for name in "abc")
    edges = (
        DiagramEdge("a", "b", "0.001/h"),
        DiagramEdge("b", "a", "0.5/h"),
        DiagramEdge("b", "c", "0.25/h"),
        DiagramEdge("a", "c", "1e-06/h"),
        DiagramEdge("c", "a", "2.5e-06/h"),
    )
    layout = laid_out(Diagram("Chain", nodes, edges, "up"))
    spans = []
    for line in layout.routes:
        half = text_width(line.edge.label) / 2
        spans.append((line.label[0] - half, line.label[0] + half, line.label[1]))
        assert spans[-1][0] >= 0
        assert spans[-1][1] <= layout.width
    for a, b in combinations(spans, 2):
        assert a[1] <= b[0] or b[1] <= a[0] or abs(a[2] - b[2]) >= 15
    assert layout.routes[0].points != layout.routes[1].points[::-1]


texts = st.text(max_size=60)


@given(texts, st.lists(texts, min_size=1, max_size=3), st.booleans())
def test_any_text_stays_text(title: str, lines: list[str], upward: bool) -> None:
    nodes = (DiagramNode("a", tuple(lines)), DiagramNode("b", ("b",), "and"))
    edges = (DiagramEdge("a", "b", title), DiagramEdge("b", "a"), DiagramEdge("a", "a"))
    root = ET.fromstring(drawn(Diagram(title, nodes, edges, "up" if upward else "down")))
    known = {"svg", "title", "desc", "style", "defs", "marker", "path", "rect", "text", "g"}
    assert {one.tag.removeprefix(SVG) for one in root.iter()} <= known


def test_long_labels_are_wrapped_and_cut() -> None:
    assert label_of(DiagramNode("a", ("a" * 80,))) == ("a" * 28, f"{'a' * 27}…")
    words = "the speed of the vehicle in front of us"
    assert label_of(DiagramNode("a", (words,))) == ("the speed of the vehicle in", "front of us")


def test_edges_across_many_layers_have_no_bends() -> None:
    """One node above a chain: with a bend in each layer there would be 180,000."""
    count = 600
    chain = [(k, k + 1) for k in range(count - 1)]
    layers = layered(count, [*chain, *((0, k) for k in range(2, count))])
    assert sum(map(len, layers.rows)) < 2 * count
    assert layers.chains[count - 1] == (0, count, 2)
    assert layers.chains[-1] == ()


def test_labels_fit_into_their_boxes() -> None:
    measured = {  # by a browser: DejaVu Sans Bold, 12 pixels
        "PEDESTRIAN_DISTANCE_UNKNOWN": 236.3,
        "pedestrian_distance_unknown": 204.0,
        "WWMM_MMWW": 106.7,
        "mmmm_wwww": 100.4,
        "0.123456789": 88.1,
    }
    for label, width in measured.items():
        (box,) = laid_out(Diagram("", (DiagramNode("a", (label,)),), ())).boxes
        assert box.lines == (label,)
        assert box.width >= width + 8
