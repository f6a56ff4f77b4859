"""A diagram as one self-contained SVG: no scripts, no fonts to load, the same bytes everywhere."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence

from eddi_scaffold.common.escaping import xml_text
from eddi_scaffold.diagrams.diagram import Diagram, DiagramNode, LegendEntry, Shape, Tone
from eddi_scaffold.diagrams.layout import LINE, RULE, Box, Route, laid_out, text_width

_MARGIN, _TITLE, _LEGEND = 24.0, 40.0, 30.0
_TONES: dict[Tone, tuple[str, str]] = {
    "output": ("#e3f1e7", "#2e7d4f"),
    "input": ("#e3edf8", "#1f5f99"),
    "demand": ("#f3e8f7", "#7b3f98"),
    "gate": ("#ffffff", "#1f2933"),
    "neutral": ("#f5f7fa", "#52606d"),
    "warning": ("#fff4d6", "#b07c00"),
    "refused": ("#fde8e6", "#9b1c13"),
}
_STYLE = (
    "text{font:12px sans-serif;fill:#1f2933;text-anchor:middle}"
    ".title{font-size:15px;font-weight:bold;text-anchor:start}"
    ".head{font-weight:bold}.small{font-size:11px;fill:#52606d}.left{text-anchor:start}"
    ".edge{fill:none;stroke:#52606d;stroke-width:1.2}"
)
_ARROW = (
    '<defs><marker id="end" viewBox="0 0 10 10" refX="9" refY="5" markerWidth="8" '
    'markerHeight="8" orient="auto-start-reverse"><path d="M0 1L10 5L0 9z" fill="#52606d"/>'
    "</marker></defs>"
)


def drawn(diagram: Diagram) -> str:
    """Return the SVG of a diagram."""
    layout = laid_out(diagram)
    legend = _legend(diagram.legend, _TITLE + layout.height + _MARGIN)
    title = text_width(diagram.title) * 15 / 12
    keys = sum(_legend_width(entry) for entry in diagram.legend)
    width = max(layout.width, title, keys) + 2 * _MARGIN
    height = _TITLE + layout.height + _MARGIN + (_LEGEND if legend else 0.0)
    shift = (width - layout.width) / 2
    name = xml_text(diagram.title)
    size = f'width="{_n(width)}" height="{_n(height)}" viewBox="0 0 {_n(width)} {_n(height)}"'
    parts = [
        f'<svg xmlns="http://www.w3.org/2000/svg" {size} role="img" aria-label="{name}">',
        f"<title>{name}</title>",
        f"<desc>{xml_text(diagram.description)}</desc>",
        f"<style>{_STYLE}</style>",
        _ARROW,
        f'<rect width="{_n(width)}" height="{_n(height)}" fill="#ffffff"/>',
        f'<text class="title" x="{_n(_MARGIN)}" y="24">{name}</text>',
        f'<g transform="translate({_n(shift)} {_n(_TITLE)})">',
        *(_edge(line) for line in layout.lines),
        *(part for box in layout.boxes for part in _node(box)),
        "</g>",
        *legend,
        "</svg>",
    ]
    return "\n".join(parts) + "\n"


def _edge(line: Route) -> str:
    """Return a curve through the points of a line; it leaves and arrives upright."""
    first, *rest = line.points
    path = [f"M{_n(first[0])} {_n(first[1])}"]
    before = first
    for point in rest:
        half = (before[1] + point[1]) / 2
        control = f"{_n(before[0])} {_n(half)} {_n(point[0])} {_n(half)}"
        path.append(f"C{control} {_n(point[0])} {_n(point[1])}")
        before = point
    arrow = ' marker-end="url(#end)"' if line.edge.arrow else ""
    drawn = f'<path class="edge" d="{"".join(path)}"{arrow}/>'
    if not line.edge.label:
        return drawn
    x, y = line.label
    text = xml_text(line.edge.label)
    wide = text_width(line.edge.label)
    plate = f'<rect x="{_n(x - wide / 2)}" y="{_n(y - 8)}" width="{_n(wide)}" height="15" '
    return (
        f'{drawn}{plate}fill="#ffffff" opacity="0.85"/>'
        f'<text class="small" x="{_n(x)}" y="{_n(y + 4)}">{text}</text>'
    )


def _node(box: Box) -> Iterable[str]:
    node = box.node
    tip = node.tooltip or " ".join(node.lines)
    yield f"<g><title>{xml_text(tip)}</title>"
    yield _outline(node.shape, node.tone, box.x, box.y, box.width, box.height)
    yield from _label(node, box)
    yield "</g>"


def _label(node: DiagramNode, box: Box) -> Iterable[str]:
    top = box.y - len(box.lines) * LINE / 2
    if node.shape == "table" and len(box.lines) > 1:
        top -= RULE / 2
        y = _n(top + LINE + RULE / 2)
        left, right = _n(box.x - box.width / 2), _n(box.x + box.width / 2)
        colour = _TONES[node.tone][1]
        yield f'<path d="M{left} {y}H{right}" stroke="{colour}" stroke-width="1"/>'
    for number, line in enumerate(box.lines):
        style = ' class="head"' if number == 0 else ""
        below = RULE if number and node.shape == "table" else 0.0
        y = _n(top + number * LINE + 11.5 + below)
        yield f'<text{style} x="{_n(box.x)}" y="{y}">{xml_text(line)}</text>'


def _outline(shape: Shape, tone: Tone, x: float, y: float, width: float, height: float) -> str:
    fill, stroke = _TONES[tone]
    path = _PATHS[shape](x - width / 2, y - height / 2, x + width / 2, y + height / 2)
    return f'<path d="{path}" fill="{fill}" stroke="{stroke}" stroke-width="1.4"/>'


def _box(left: float, top: float, right: float, bottom: float) -> str:
    return f"M{_n(left)} {_n(top)}H{_n(right)}V{_n(bottom)}H{_n(left)}z"


def _rounded(left: float, top: float, right: float, bottom: float) -> str:
    r = min(10.0, (bottom - top) / 2)
    a = f"a{_n(r)} {_n(r)} 0 0 1"
    return (
        f"M{_n(left + r)} {_n(top)}H{_n(right - r)}{a} {_n(r)} {_n(r)}V{_n(bottom - r)}"
        f"{a} {_n(-r)} {_n(r)}H{_n(left + r)}{a} {_n(-r)} {_n(-r)}V{_n(top + r)}"
        f"{a} {_n(r)} {_n(-r)}z"
    )


def _ellipse(left: float, top: float, right: float, bottom: float) -> str:
    rx, ry, y = (right - left) / 2, (bottom - top) / 2, (top + bottom) / 2
    a = f"A{_n(rx)} {_n(ry)} 0 0 1"
    return f"M{_n(left)} {_n(y)}{a} {_n(right)} {_n(y)}{a} {_n(left)} {_n(y)}z"


def _hexagon(left: float, top: float, right: float, bottom: float) -> str:
    y, cut = (top + bottom) / 2, (bottom - top) / 3
    return (
        f"M{_n(left)} {_n(y)}L{_n(left + cut)} {_n(top)}H{_n(right - cut)}L{_n(right)} {_n(y)}"
        f"L{_n(right - cut)} {_n(bottom)}H{_n(left + cut)}z"
    )


def _and(left: float, top: float, right: float, bottom: float) -> str:
    """Draw the gate of IEC 61025 with a flat foot and a round head."""
    rx, shoulder = (right - left) / 2, top + (bottom - top) * 0.55
    return (
        f"M{_n(left)} {_n(bottom)}V{_n(shoulder)}A{_n(rx)} {_n(shoulder - top)} 0 0 1 {_n(right)} "
        f"{_n(shoulder)}V{_n(bottom)}z"
    )


def _or(left: float, top: float, right: float, bottom: float) -> str:
    """Draw the gate of IEC 61025 with a hollow foot and a pointed head."""
    x, foot = (left + right) / 2, bottom - (bottom - top) * 0.22
    side = top + (bottom - top) * 0.45
    return (
        f"M{_n(left)} {_n(bottom)}Q{_n(left)} {_n(side)} {_n(x)} {_n(top)}Q{_n(right)} {_n(side)} "
        f"{_n(right)} {_n(bottom)}Q{_n(x)} {_n(foot)} {_n(left)} {_n(bottom)}z"
    )


def _not(left: float, top: float, right: float, bottom: float) -> str:
    x = (left + right) / 2
    return f"M{_n(left)} {_n(bottom)}L{_n(x)} {_n(top)}L{_n(right)} {_n(bottom)}z"


_PATHS: dict[Shape, Callable[[float, float, float, float], str]] = {
    "box": _box,
    "table": _box,
    "rounded": _rounded,
    "ellipse": _ellipse,
    "hexagon": _hexagon,
    "and": _and,
    "or": _or,
    "not": _not,
}


def _legend(entries: Sequence[LegendEntry], y: float) -> list[str]:
    parts, x = [], _MARGIN
    for entry in entries:
        parts.append(_outline(entry.shape, entry.tone, x + 11, y + 8, 22, 14))
        text = xml_text(entry.text)
        parts.append(f'<text class="small left" x="{_n(x + 28)}" y="{_n(y + 12)}">{text}</text>')
        x += _legend_width(entry)
    return parts


def _legend_width(entry: LegendEntry) -> float:
    return 44 + text_width(entry.text)


def _n(value: float) -> str:
    """Write a coordinate with one digit, the same on every machine."""
    return f"{round(value, 1) + 0.0:g}" if abs(value) < 1e5 else f"{value:.0f}"
