"""Diagrams as the classes that are compiled from them."""

from typing import Any

from eddi_scaffold.kinds.reliability.compile import NODES_WRITTEN_OUT, tree_lines
from eddi_scaffold.kinds.reliability.decision_diagram import Diagram
from eddi_scaffold.kinds.reliability.fault_tree import Gate
from eddi_scaffold.kinds.reliability.lowering import Event, FaultTree, Named
from eddi_scaffold.program.running import module_of


def compiled(diagram: Diagram, limit: int = NODES_WRITTEN_OUT) -> Any:
    """Return a fault tree: its text up to so many nodes, executed."""
    events = tuple(Event(f"e{i}", "fixed", (0.0,), input="x") for i in range(diagram.events))
    count = 1 + max(module.variable for module in diagram.modules) - diagram.events
    tree = FaultTree(events, (Gate("", ()),) * count, (Named("", ""),) * count, 0)
    vars(tree)["diagram"] = diagram  # as if it had been built
    head = "from eddi_runtime.reliability import large_tree, tree"
    text = "\n".join([head, *tree_lines("Tree", tree, [], limit)])
    return module_of(text, "tree").Tree()
