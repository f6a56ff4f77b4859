"""What people see of a network: its tree, its picture, and its part of a package's README."""

from __future__ import annotations

from collections.abc import Sequence

from eddi_scaffold.common.escaping import markdown_code
from eddi_scaffold.diagrams import Diagram, DiagramEdge, DiagramNode, LegendEntry, Tone
from eddi_scaffold.kinds.bayesian_network.network import Network, in_digits
from eddi_scaffold.kinds.bayesian_network.options import NetworkOptions

_LEGEND = (
    LegendEntry("output", "table", "output"),
    LegendEntry("observed", "table", "input"),
    LegendEntry("neither", "table", "neutral"),
)
_SHOWN = 6


def diagram(network: Network, name: str, options: NetworkOptions, *, configured: bool) -> Diagram:
    """Return the picture: parents above their children, each with its states."""
    nodes, edges = [], []
    for node in network.nodes:
        edges += [DiagramEdge(parent, node.id) for parent in node.parents]
        tone: Tone = "input" if configured and node.id in options.observed else "neutral"
        if node.id in options.outputs:
            tone = "output"
        states = [*node.states[:_SHOWN], *(("...",) if len(node.states) > _SHOWN else ())]
        title = node.id if node.title == node.id else f"{node.title} ({node.id})"
        nodes.append(DiagramNode(node.id, (title, *states), "table", tone, node.id))
    text = f"{len(nodes)} nodes, {len(edges)} edges; parents are above their children"
    title = f"Bayesian network {name}"
    return Diagram(title, tuple(nodes), tuple(edges), "down", _LEGEND, text)


def outline(network: Network, options: NetworkOptions) -> list[str]:
    """Return the nodes with states and parents, then what inference costs."""
    bins = {entry.node: entry for entry in options.declarations if entry.reader.edges is not None}
    lines = []
    for node in network.nodes:
        title = f" ({node.title})" if node.title != node.id else ""
        lines.append(f"{node.id}{title}: {', '.join(node.states)}")
        if node.parents:
            lines.append(f"  given {', '.join(node.parents)}")
        if node.id in bins:
            reader = bins[node.id].reader
            edges = [*(f" | {edge:g} | " for edge in reader.edges or ()), ""]
            pairs = zip((node.states[k] for k in reader.order), edges, strict=True)
            lines.append(f"  from {bins[node.id].input}: {''.join(map(''.join, pairs))}")
    if network.known:
        known = (f"{node} (event {event})" if event else node for node, event in network.known)
        lines.append(f"known: {', '.join(known)}")
    lines.append(f"outputs: {', '.join(options.outputs)}")
    largest = in_digits(options.width.largest)
    lines.append(f"largest table of the inference, all nodes observable: {largest} entries")
    return [*lines, *(f"evidence {entry.id}: {entry.text()}" for entry in options.thresholds)]


def readme(options: NetworkOptions) -> Sequence[str]:
    """Return the lines about the network for the package's README."""
    outputs, observed = (
        ", ".join(f"`{markdown_code(name)}`" for name in names)
        for names in (options.outputs, options.observed)
    )
    text = (
        f"Outputs: {outputs}. Observed by declaration: {observed or 'none (write the methods)'}. "
        "A missing input leaves its node unobserved; the posterior is exact for what is known."
    )
    lines = [
        "## Network",
        "",
        text,
        "",
        f"The largest table of the inference has {in_digits(options.width.largest)} entries.",
    ]
    if not options.thresholds:
        return lines
    text = (
        "Evidence holds for every state that unknown inputs may have; of what is not known, only a "
        "prior that the configuration accepts by name counts. The posteriors themselves are no "
        "evidence. After a step in Python, `EDDIMonitor.monitor.claims()` returns it."
    )
    rows = [f"| `{entry.id}` | {entry.text()} |" for entry in options.thresholds]
    return [*lines, "", text, "", "| evidence | active while |", "|---|---|", *rows]
