"""Diagrams as the classes that are compiled from them."""

from __future__ import annotations

from typing import Any

from eddi_scaffold.compiling.execution import module_of
from eddi_scaffold.compiling.reliability.diagram import Diagram
from eddi_scaffold.compiling.reliability.model import Event, FaultTree, Named
from eddi_scaffold.compiling.reliability.trees import WRITTEN_OUT, class_lines


def compiled(diagram: Diagram, limit: int = WRITTEN_OUT) -> Any:
    """Return a fault tree: its text up to so many nodes, executed."""
    events = tuple(Event(f"e{i}", "fixed", (0.0,), "", "x", 0.0, "") for i in range(diagram.events))
    gates = (Named("", ""),) * (
        1 + max(module.variable for module in diagram.modules) - diagram.events
    )
    tree = FaultTree(events, gates, diagram, None, repair=False)
    lines = class_lines("Tree", tree, [], limit)
    text = "\n".join(["from eddi_runtime.reliability import large_tree, tree", *lines])
    return module_of(text, "tree").Tree()
