"""The picture of a network: parents above their children, each with its states."""

from __future__ import annotations

from eddi_scaffold.diagrams import Diagram, DiagramEdge, DiagramNode, LegendEntry, Tone
from eddi_scaffold.kinds.bayesian_network.network import Network, Node
from eddi_scaffold.kinds.bayesian_network.options import NetworkOptions

_LEGEND = (
    LegendEntry("output", "table", "output"),
    LegendEntry("observed", "table", "input"),
    LegendEntry("neither", "table", "neutral"),
)
_SHOWN = 6


def diagram(name: str, network: Network, settings: NetworkOptions, *, configured: bool) -> Diagram:
    """Return what a picture of the network shows."""
    edges = tuple(DiagramEdge(parent, node.id) for node in network.nodes for parent in node.parents)
    text = f"{len(network.nodes)} nodes, {len(edges)} edges; parents are above their children"
    nodes = tuple(_node(node, settings, configured=configured) for node in network.nodes)
    return Diagram(f"Bayesian network {name}", nodes, edges, "down", _LEGEND, text)


def _node(node: Node, settings: NetworkOptions, *, configured: bool) -> DiagramNode:
    tone: Tone = "neutral"
    if node.id in settings.outputs:
        tone = "output"
    elif configured and node.id in settings.observed:
        tone = "input"
    states = [*node.states[:_SHOWN], *(("...",) if len(node.states) > _SHOWN else ())]
    title = node.id if node.title == node.id else f"{node.title} ({node.id})"
    return DiagramNode(node.id, (title, *states), "table", tone, node.id)
