"""The graph of a ConSert: what feeds what."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from eddi_scaffold.graphs import Graph
    from eddi_scaffold.kinds.consert.model import ConSert


def node_ids(consert: ConSert) -> list[str]:
    """Return the ids of all nodes: evidence, demands, gates and guarantees, in file order."""
    groups = (consert.evidence, consert.demands, consert.gates, consert.guarantees)
    return [node.id for group in groups for node in group]


def inputs_of(consert: ConSert) -> Graph:
    """Return what feeds each node; edges from or to unknown ids are left out."""
    inputs: dict[str, dict[str, None]] = {id_: {} for id_ in node_ids(consert)}
    for edge in consert.tree_propagations:
        if edge.source in inputs and edge.target in inputs:
            inputs[edge.target][edge.source] = None
    return {id_: tuple(sources) for id_, sources in inputs.items()}
