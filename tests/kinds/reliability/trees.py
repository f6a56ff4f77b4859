"""Diagrams as the classes that are compiled from them."""

from typing import Any

from eddi_scaffold.kinds.reliability.compile import NODES_WRITTEN_OUT, tree_lines
from eddi_scaffold.kinds.reliability.decision_diagram import Diagram
from eddi_scaffold.kinds.reliability.lowering import Event, FaultTree
from eddi_scaffold.program.running import module_of


def compiled(diagram: Diagram, count: int, limit: int = NODES_WRITTEN_OUT) -> Any:
    """Return a fault tree of so many events: its text up to so many nodes, executed."""
    events = tuple(Event(f"e{i}", "fixed", (0.0,), input="x") for i in range(count))
    tree = FaultTree(events, (), 0)
    vars(tree)["diagram"] = diagram  # as if it had been built
    head = "from eddi_runtime.reliability import large_tree, tree"
    text = "\n".join([head, *tree_lines("Tree", tree, [], limit)])
    return module_of(text, "tree").Tree()
