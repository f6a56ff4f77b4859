"""The graph of a ConSert as a table, for explanations and for ConSerts that are no text."""

from __future__ import annotations

from typing import List, NamedTuple, Sequence, Tuple

from .values import FALSE, TRUE


class Node(NamedTuple):
    """An And or Or over other nodes; without inputs an And is TRUE and an Or is FALSE.

    Attributes:
        is_and: And, else Or. A guarantee is an And.
        inputs: numbers of the nodes it reads, in edge order.
    """

    is_and: bool
    inputs: Tuple[int, ...]


class Graph(NamedTuple):
    """Nodes by number: first the leaves (numbers of the inputs), then gates and guarantees.

    Attributes:
        names: number -> id.
        leaves: how many of the nodes are leaves.
        nodes: gates and guarantees in topological order; node ``k`` has number ``leaves + k``.
        guarantees: numbers of the guarantees in file order.
    """

    names: Tuple[str, ...]
    leaves: int
    nodes: Tuple[Node, ...]
    guarantees: Tuple[int, ...]

    def evaluate(self, leaf_values: Sequence[int]) -> List[int]:
        """Return the truth value of every node by number, from those of the leaves."""
        values = list(leaf_values)
        for is_and, inputs in self.nodes:
            if is_and:
                values.append(min([values[k] for k in inputs], default=TRUE))
            else:
                values.append(max([values[k] for k in inputs], default=FALSE))
        return values
