"""A diagram as one self-contained SVG: no scripts, no fonts to load, the same bytes everywhere."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from pathlib import Path

from eddi_scaffold.common.escaping import xml_text
from eddi_scaffold.common.toml_tables import read_toml
from eddi_scaffold.diagrams import Diagram, LegendEntry, Shape, Tone
from eddi_scaffold.diagrams.layout import LINE, RULE, Box, Route, laid_out, text_width

_MARGIN, _TITLE, _LEGEND = 24.0, 40.0, 30.0
DRAWING = read_toml(Path(__file__).with_name("drawing.toml"))
"""How what is drawn looks."""


def drawn(diagram: Diagram) -> str:
    """Return the SVG of a diagram."""
    layout = laid_out(diagram)
    title_width = text_width(diagram.title) * 15 / 12
    legend_width = sum(_legend_width(entry) for entry in diagram.legend)
    width = max(layout.width, title_width, legend_width) + 2 * _MARGIN
    legend_y = _TITLE + layout.height + _MARGIN
    height = legend_y + (_LEGEND if diagram.legend else 0.0)
    name, top = xml_text(diagram.title), _n(_TITLE)
    head = (f"<desc>{xml_text(diagram.description)}</desc>", DRAWING["diagram"])
    body = [
        f'<text class="title" x="{_n(_MARGIN)}" y="24">{name}</text>',
        f'<g transform="translate({_n((width - layout.width) / 2)} {top})">',
        *(_edge(route) for route in layout.routes),
        *(part for box in layout.boxes for part in _node(box)),
        "</g>",
        *_legend(diagram.legend, legend_y),
    ]
    return document(name, _n(width), _n(height), head, body)


def document(name: str, width: str, height: str, head: Iterable[str], body: Iterable[str]) -> str:
    """Return an SVG on white; its name is escaped."""
    size = f'width="{width}" height="{height}"'
    box = f'{size} viewBox="0 0 {width} {height}" role="img" aria-label="{name}"'
    return "\n".join([
        f'<svg xmlns="http://www.w3.org/2000/svg" {box}>',
        f"<title>{name}</title>",
        DRAWING["dark"],
        *head,
        f'<rect {size} fill="#ffffff"/>',
        *body,
        "</svg>\n",
    ])  # fmt: skip


def _edge(route: Route) -> str:
    """Return a curve through the points of a line; it leaves and arrives upright."""
    (x, y), *others = route.points
    path = f"M{_n(x)} {_n(y)}"
    for u, v in others:
        half = _n((y + v) / 2)
        path += f"C{_n(x)} {half} {_n(u)} {half} {_n(u)} {_n(v)}"
        x, y = u, v
    arrow = ' marker-end="url(#end)"' if route.edge.arrow else ""
    curve = f'<path class="edge" d="{path}"{arrow}/>'
    if not route.edge.label:
        return curve
    x, y = route.label
    width = text_width(route.edge.label)
    plate = f'<rect x="{_n(x - width / 2)}" y="{_n(y - 8)}" width="{_n(width)}" height="15" '
    return (
        f'{curve}{plate}fill="#ffffff" opacity="0.85"/>'
        f'<text class="small" x="{_n(x)}" y="{_n(y + 4)}">{xml_text(route.edge.label)}</text>'
    )


def _node(box: Box) -> Iterable[str]:
    node = box.node
    yield f"<g><title>{xml_text(node.tooltip or ' '.join(node.lines))}</title>"
    yield _outline(node.shape, node.tone, box.x, box.y, box.width, box.height)
    top = box.y - len(box.lines) * LINE / 2
    has_rule = node.shape == "table" and len(box.lines) > 1
    if has_rule:
        top -= RULE / 2
        y = _n(top + LINE + RULE / 2)
        left, right = _n(box.x - box.width / 2), _n(box.x + box.width / 2)
        colour = DRAWING["tones"][node.tone][1]
        yield f'<path d="M{left} {y}H{right}" stroke="{colour}" stroke-width="1"/>'
    for number, line in enumerate(box.lines):
        style = ' class="head"' if number == 0 else ""
        y = _n(top + number * LINE + 11.5 + (RULE if number and has_rule else 0.0))
        yield f'<text{style} x="{_n(box.x)}" y="{y}">{xml_text(line)}</text>'
    yield "</g>"


def _outline(shape: Shape, tone: Tone, x: float, y: float, width: float, height: float) -> str:
    left, top, right, bottom = x - width / 2, y - height / 2, x + width / 2, y + height / 2
    r, cut, head = min(10.0, (bottom - top) / 2), (bottom - top) / 3, (bottom - top) * 0.55
    numbers = {
        "left": left, "top": top, "right": right, "bottom": bottom,
        "x": (left + right) / 2, "y": (top + bottom) / 2,
        "rx": (right - left) / 2, "ry": (bottom - top) / 2, "r": r, "minus_r": -r,
        "left_r": left + r, "right_r": right - r, "top_r": top + r, "bottom_r": bottom - r,
        "left_cut": left + cut, "right_cut": right - cut,
        "shoulder": top + head, "head": top + head - top,
        "side": top + (bottom - top) * 0.45, "foot": bottom - (bottom - top) * 0.22,
    }  # fmt: skip
    path = DRAWING["paths"][shape].format_map({name: _n(value) for name, value in numbers.items()})
    fill, stroke = DRAWING["tones"][tone]
    dashes = ' stroke-dasharray="4 3"' if tone == "warning" else ""
    return f'<path d="{path}" fill="{fill}" stroke="{stroke}" stroke-width="1.4"{dashes}/>'


def _legend(entries: Sequence[LegendEntry], y: float) -> Iterable[str]:
    x = _MARGIN
    for entry in entries:
        yield _outline(entry.shape, entry.tone, x + 11, y + 8, 22, 14)
        text = xml_text(entry.text)
        yield f'<text class="small left" x="{_n(x + 28)}" y="{_n(y + 12)}">{text}</text>'
        x += _legend_width(entry)


def _legend_width(entry: LegendEntry) -> float:
    return 44 + text_width(entry.text)


def _n(value: float) -> str:
    """Write a coordinate with one digit, the same on every machine."""
    return f"{round(value, 1) + 0.0:g}" if abs(value) < 1e5 else f"{value:.0f}"
