"""Pictures of models: a kind says what is in one, ``layout`` places it, ``svg`` draws it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

Shape = Literal["box", "rounded", "ellipse", "hexagon", "table", "and", "or", "not"]
"""``table``: a heading with rows below. ``and``, ``or`` and ``not`` are the gates of fault trees
(IEC 61025), with their output at the top; a vote is an ``or`` with ``2/3`` as its label."""

Tone = Literal["output", "input", "demand", "gate", "neutral", "warning", "refused"]
"""What something is, as a colour: given out, observed here, expected of others, logic, other, what
needs a look, what is known not to hold."""

Direction = Literal["up", "down"]
"""``up``: edges lead to what is above (ConSerts, fault trees); ``down``: below (networks)."""


@dataclass(frozen=True)
class DiagramNode:
    """One thing in a picture."""

    id: str  # unique in its diagram; edges name it
    lines: tuple[str, ...]  # the label; the first line is its heading. Long ones are wrapped or cut
    shape: Shape = "box"  # outline
    tone: Tone = "neutral"  # colour
    tooltip: str = ""  # text that a browser shows at the pointer; the label when empty


@dataclass(frozen=True)
class DiagramEdge:
    """A line from one node to another."""

    source: str  # id of a node
    target: str  # id of a node
    label: str = ""  # short text at its middle, empty for none
    arrow: bool = True  # whether its end has an arrowhead


@dataclass(frozen=True)
class LegendEntry:
    """One line of the legend: the meaning of a shape in a tone."""

    text: str
    shape: Shape
    tone: Tone


@dataclass(frozen=True)
class Diagram:
    """A picture of a model."""

    title: str  # one line above it
    # in the order of the model, which decides where nothing else does
    nodes: tuple[DiagramNode, ...]
    # cycles are drawn as well; an edge to an unknown node is left out
    edges: tuple[DiagramEdge, ...] = ()
    direction: Direction = "down"  # where edges lead
    legend: tuple[LegendEntry, ...] = ()  # what the shapes mean, in the order of the picture
    description: str = ""  # what is to be seen, for who cannot see it
