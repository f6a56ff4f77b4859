"""Pictures of models: what to draw, a layered layout of it, and SVG; no tool is needed."""

from eddi_scaffold.diagrams.diagram import (
    Diagram,
    DiagramEdge,
    DiagramNode,
    Direction,
    LegendEntry,
    Shape,
    Tone,
)
from eddi_scaffold.diagrams.svg import drawn

__all__ = [
    "Diagram",
    "DiagramEdge",
    "DiagramNode",
    "Direction",
    "LegendEntry",
    "Shape",
    "Tone",
    "drawn",
]
