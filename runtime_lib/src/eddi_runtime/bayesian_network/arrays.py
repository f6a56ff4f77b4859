"""Numbers of messages that are known when a model is loaded, and the careful way to compute any.

Axes of an array are the nodes of its message, ascending; a tabulated message has before them one
axis for each input, over its states and, where that may be, "not observed".
"""

from __future__ import annotations

from string import ascii_letters
from typing import TYPE_CHECKING, Any, Callable, Dict, Tuple

import numpy as np

from .graph import bits
from .messages import Edge, Message, Program
from .model import Network
from .tree import EVIDENCE, TABLE, Tree

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Array = NDArray[np.float64]


class Arrays:
    """The messages of a program as numbers.

    Attributes:
        constants: messages without evidence behind them.
        tables: tabulated messages.
        cases: observable node -> a row for each state and one for "not observed".
    """

    def __init__(self, network: Network, tree: Tree, program: Program) -> None:
        self._network = network
        self._tree = tree
        self._program = program
        self._count = len(network.shape.cards)
        in_tables = {leaf.node for leaf in tree.leaves if leaf.kind == TABLE}
        self.cases: Dict[int, Array] = {}
        for leaf in tree.leaves:
            if leaf.kind == EVIDENCE:
                alone = leaf.node not in in_tables
                prior = np.array(network.tables[leaf.node]) if alone else None
                self.cases[leaf.node] = _cases(network.shape.cards[leaf.node], prior)
        self.constants: Dict[Edge, Array] = {}
        self.tables: Dict[Edge, Array] = {}
        for edge, message in program.messages.items():
            if not message.inputs:
                self.constants[edge] = self._known(message)
            elif edge in program.tabulated:
                self.tables[edge] = self._known(message)

    def scaled(
        self, vector: Callable[[int], Array], state: Callable[[int], int], into: Tuple[Edge, ...]
    ) -> Dict[Edge, Array]:
        """Compute messages so that none becomes zero by underflow.

        Each has the maximum 1, and the widest type of the machine is used: 80 bits on a PC, with
        exponents down to -4950.

        Args:
            vector: evidence vector of an observable node.
            state: state of a node that is observed in each step.
            into: the messages that are wanted.
        """
        found: Dict[Edge, Any] = {}
        for edge, message in self._program.messages.items():
            if message.parts:
                one, other = (found[part] for part in message.parts)
                array = self._contract(message, one, other, cases=False)
            elif message.kind == EVIDENCE:
                (node,) = bits(message.mask)
                array = vector(node).astype(np.longdouble)
            else:
                case = tuple(state(node) for node in bits(message.inputs))
                array = self._known(message)[case].astype(np.longdouble)
            largest = array.max()
            found[edge] = array / largest if largest > 0.0 else array
        return {edge: found[edge] for edge in into}

    def _known(self, message: Message) -> Array:
        if message.parts:
            one, other = (self._part(part) for part in message.parts)
            return self._contract(message, one, other, cases=True)
        leaf = self._tree.leaves[message.leaf]
        if leaf.kind == TABLE:
            return self._table(leaf.node, (*bits(leaf.seen), *bits(leaf.mask)))
        if leaf.kind == EVIDENCE:
            return self.cases[leaf.node]
        return np.ones(self._network.shape.cards[leaf.node])

    def _part(self, edge: Edge) -> Array:
        return self.constants[edge] if edge in self.constants else self.tables[edge]

    def _table(self, node: int, wanted: Tuple[int, ...]) -> Array:
        shape = self._network.shape
        axes = (*shape.parents[node], node)
        array = np.array(self._network.tables[node]).reshape([shape.cards[one] for one in axes])
        return array.transpose([axes.index(one) for one in wanted])

    def _contract(self, message: Message, one: Array, other: Array, *, cases: bool) -> Array:
        messages = self._program.messages
        first, second = (messages[part] for part in message.parts)
        nodes = list(bits(first.mask | second.mask))
        inputs = list(bits(message.inputs)) if cases else []
        # einsum knows 52 letters only, so they are counted anew for each pair.
        axes = [*nodes, *(-1 - node for node in inputs)]
        letter = dict(zip(axes, ascii_letters))

        def letters(part: Message) -> str:
            before = bits(part.inputs) if cases else ()
            own = [*(-1 - node for node in before), *bits(part.mask)]
            return "".join(letter[axis] for axis in own)

        formula = f"{letters(first)},{letters(second)}->{letters(message)}"
        result: Array = np.einsum(formula, one, other)
        return result


def _cases(card: int, prior: Array | None) -> Array:
    rows = np.vstack([np.eye(card), np.ones(card)])
    if prior is not None:
        rows[:card] *= prior > 0.0
        rows[card] = prior
    return rows
