"""Larger parts of a network: operations of numpy on arrays, both made when the monitor starts.

Axes of a message are its nodes, ascending, behind one for each of its inputs.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any, Mapping, NamedTuple, Sequence

import numpy as np

from .engine import Posteriors, States, Weights

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Array = NDArray[np.float64]

_EVIDENCE = ("evidence", "prior")


class Message(NamedTuple):
    """A message of a join tree."""

    kind: str  # ``product``, ``table``, ``evidence``, ``prior`` (evidence with it) or ``unit``
    parts: tuple[int, ...]  # numbers of the messages that are multiplied; of a ``table``, its node
    # it has an axis for each; what the parts have beyond them is summed out
    nodes: tuple[int, ...]
    # observable nodes that known numbers depend on, one axis each before the nodes
    inputs: tuple[int, ...]
    known: bool  # its numbers are made when the monitor starts, for every case of its inputs


class Running:
    """The messages of a ``Schedule`` with their arrays, in which results stay in place."""

    def __init__(self, made: Any, positions: Mapping[int, int]) -> None:
        self.nodes, self.positions, self.answers = made.nodes, positions, made.answers
        self.messages = [Message(*row) for row in made.messages]  # by number
        # number of a message -> its numbers for every case of its inputs
        self.known: dict[int, Array] = {}
        # node -> its evidence vector for each state; behind them that for "not observed"
        self.rows: dict[int, list[list[float]]] = {}
        for number, message in enumerate(self.messages):
            if message.known:
                self.known[number] = self._numbers(message)
            if message.kind in _EVIDENCE:
                self.rows[message.nodes[0]] = self.known[number].tolist()
        sizes = [len(rows[0]) for rows in self.rows.values()]
        self._flat = np.zeros(sum(sizes))
        self.vectors = dict(zip(self.rows, np.split(self._flat, np.cumsum(sizes)[:-1])))
        self._full = _Steps(self, look_up=False).run
        # state of each observable node by position -> unnormalised rows
        self.hard = _Steps(self, look_up=True).run

    def vector(self, node: int, position: int, states: States, weights: Weights) -> list[float]:
        rows = self.rows[node]
        if position not in weights:
            return rows[states[position]]
        return [weight * other for weight, other in zip(weights[position], rows[-1])]

    def _numbers(self, message: Message) -> Any:
        """Return the known numbers of a message for every case of its inputs."""
        if message.kind == "product":
            return self._product(message, self.known, cases=True)
        if message.kind == "table":
            (node,) = message.parts
            parents, rows = self.nodes[node]
            axes = (*parents, node)
            array = np.array(rows).reshape([len(self.nodes[axis][1][0]) for axis in axes])
            return array.transpose(
                [axes.index(name) for name in (*message.inputs, *message.nodes)]
            )
        first = np.array(self.nodes[message.nodes[0]][1][0])
        vector = first if message.kind == "prior" else np.ones(len(first))
        if message.kind == "unit":
            return vector
        # A row for each state, and one for "not observed".
        return np.vstack([np.diag((vector > 0.0).astype(float)), vector])

    def _product(self, message: Message, of: Mapping[int, Any], *, cases: bool) -> Any:
        """Multiply two messages and sum over the nodes that the product has no axis for."""
        first, second = (self.messages[part] for part in message.parts)
        inputs = [-1 - input_ for input_ in message.inputs]
        # einsum knows 52 axes only, so they are counted anew for each pair.
        axes = [*sorted({*first.nodes, *second.nodes}), *inputs]
        number = {axis: k for k, axis in enumerate(axes)}

        def numbers(part: Message) -> list[int]:
            before = part.inputs if cases else ()
            return [number[axis] for axis in (*(-1 - node for node in before), *part.nodes)]

        left, other = (of[part] for part in message.parts)
        return np.einsum(left, numbers(first), other, numbers(second), numbers(message))

    def soft(self, states: States, weights: Weights) -> Posteriors:
        values: list[float] = []
        for node in self.rows:
            values += self.vector(node, self.positions[node], states, weights)
        self._flat[:] = values
        return self._full(states)

    def scaled(self, states: States, weights: Weights) -> Posteriors:
        """Return rows of which none is zero by underflow; slow, for unlikely evidence."""
        # The widest type of the machine: on a PC 80 bits, with exponents down to -4950.
        arrays: dict[int, Any] = {}
        for number, message in enumerate(self.messages):
            if message.kind in _EVIDENCE:
                (node,) = message.nodes
                array: Any = np.array(self.vector(node, self.positions[node], states, weights))
            elif message.kind == "product":
                array = self._product(message, arrays, cases=False)
            else:
                case = tuple(states[self.positions[node]] for node in message.inputs)
                array = self.known[number][case]
            largest = array.max()
            wide = array.astype(np.longdouble)
            arrays[number] = wide / largest if largest > 0.0 else wide
        return [[float(value) for value in arrays[answer]] for answer in self.answers]


class _Steps:
    """The operations of a step: products are multiplied as matrices, without copies if possible.

    Known messages are looked up by the states of their inputs, or follow from evidence vectors.
    """

    def __init__(self, of: Running, *, look_up: bool) -> None:
        self._of, self._look_up = of, look_up
        # (arrays for each case, (position, distance) of each input, where to put the array)
        self._look_ups: list[tuple[Any, list[tuple[int, int]], list[Any], int]] = []
        self._operations: list[tuple[Any, list[Any]]] = []
        self._axes: dict[int, tuple[tuple[int, ...], Any]] = {}  # of a message, and its numbers
        needed, waiting = set(), list(of.answers)
        while waiting:
            number = waiting.pop()
            message = of.messages[number]
            if message.kind == "product" and not self._is_known(message) and number not in needed:
                needed.add(number)
                waiting += message.parts
        for number in sorted(needed):
            self._multiply(number)
        self._answers: list[Any] = []
        for number in of.answers:
            self._operand(number, (of.messages[number].nodes,), self._answers)

    def run(self, states: States) -> Posteriors:
        for arrays, strides, operands, place in self._look_ups:
            case = 0
            for position, stride in strides:
                case += states[position] * stride
            operands[place] = arrays[case]
        for function, operands in self._operations:
            function(*operands)
        return [row.tolist() for row in self._answers]

    def _is_known(self, message: Message) -> bool:
        return message.known and (self._look_up or not message.inputs)

    def _multiply(self, number: int) -> None:
        message = self._of.messages[number]
        (a, first), (b, second) = ((part, self._order(part)) for part in message.parts)
        kept = {*message.nodes}
        order = first if a in self._axes else second  # what is known can be laid out as needed
        summed = tuple(node for node in order if node not in kept)
        batch = tuple(node for node in first if node in kept and node in second)
        left = tuple(node for node in first if node in kept and node not in second)
        right = tuple(node for node in second if node in kept and node not in first)
        operands: list[Any] = []
        groups: tuple[tuple[int, ...], ...] = (batch, left, right)
        if not summed:
            function: Any = np.multiply
            self._operand(a, (batch, left, ()), operands)
            self._operand(b, (batch, (), right), operands)
        elif batch:
            function = np.matmul
            self._operand(a, (batch, left, summed), operands)
            self._operand(b, (batch, summed, right), operands)
        else:
            function, groups = np.dot, tuple(group for group in (left, right) if group)
            self._operand(a, (left, summed) if left else (summed,), operands)
            self._operand(b, (summed, right) if right else (summed,), operands)
        axes = batch + left + right
        result = np.zeros([self._size((node,)) for node in axes])
        self._axes[number] = axes, result
        operands.append(result.reshape([self._size(group) for group in groups]))
        self._operations.append((function, operands))

    def _order(self, number: int) -> tuple[int, ...]:
        return self._axes[number][0] if number in self._axes else self._of.messages[number].nodes

    def _size(self, nodes: Sequence[int]) -> int:
        return math.prod(len(self._of.nodes[node][1][0]) for node in nodes)

    def _operand(self, number: int, groups: Sequence[Sequence[int]], operands: list[Any]) -> None:
        """Append a message whose axes are merged to groups."""
        of, message = self._of, self._of.messages[number]
        shape = [self._size(group) for group in groups]
        nodes = [node for group in groups for node in group]
        if number in self._axes or (message.kind in _EVIDENCE and not self._look_up):
            axes, array = self._axes.get(number) or (message.nodes, of.vectors[message.nodes[0]])
            turned = array.transpose([axes.index(node) for node in nodes])
            view = turned.reshape(shape)
            if not np.shares_memory(view, array):
                copy = np.zeros(turned.shape)
                self._operations.append((np.copyto, [copy, turned]))
                view = copy.reshape(shape)
            operands.append(view)
            return
        count, known = len(message.inputs), of.known[number]
        order = [*range(count), *(count + message.nodes.index(node) for node in nodes)]
        if not message.inputs:
            operands.append(known.transpose(order).reshape(shape).copy())
            return
        strides, stride = [], 1
        for node, size in zip(reversed(message.inputs), reversed(known.shape[:count])):
            strides.append((of.positions[node], stride))
            stride *= size
        arrays = list(known.transpose(order).reshape([-1, *shape]).copy())
        self._look_ups.append((arrays, strides, operands, len(operands)))
        operands.append(None)
