"""Larger parts of a network: compiled numpy operations on arrays that are made at the start.

Axes of an array are the nodes of its message, ascending, behind one for each of its inputs.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Callable, Mapping, NamedTuple, Sequence

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
    """The operations of a ``Schedule`` with their arrays, in which results stay in place."""

    def __init__(self, made: Any, positions: Mapping[int, int], wanted: Sequence[int]) -> None:
        self._nodes, self._positions, self._wanted = made.nodes, positions, wanted
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
        self._answers = [made.answers[k] for k in wanted] or made.answers
        sizes = [len(rows[0]) for rows in self.rows.values()]
        self._flat = np.zeros(sum(sizes))
        self._vectors = dict(zip(self.rows, np.split(self._flat, np.cumsum(sizes)[:-1])))
        self._full = self._step(made.full or made.hard)
        # state of each observable node by position -> unnormalised rows
        self.hard: Callable[[States], Posteriors] = lambda states: self.soft(states, {})
        if made.hard is not None:
            self.hard = self._step(made.hard) if made.full else self._full

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
            parents, rows = self._nodes[node]
            axes = (*parents, node)
            array = np.array(rows).reshape([len(self._nodes[axis][1][0]) for axis in axes])
            return array.transpose(
                [axes.index(name) for name in (*message.inputs, *message.nodes)]
            )
        first = np.array(self._nodes[message.nodes[0]][1][0])
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
            values += self.vector(node, self._positions[node], states, weights)
        self._flat[:] = values
        return self._full(states)

    def scaled(self, states: States, weights: Weights) -> Posteriors:
        """Return rows of which none is zero by underflow; slow, for unlikely evidence."""
        # The widest type of the machine: on a PC 80 bits, with exponents down to -4950.
        arrays: dict[int, Any] = {}
        for number, message in enumerate(self.messages):
            if message.kind in _EVIDENCE:
                (node,) = message.nodes
                array: Any = np.array(self.vector(node, self._positions[node], states, weights))
            elif message.kind == "product":
                array = self._product(message, arrays, cases=False)
            else:
                case = tuple(states[self._positions[node]] for node in message.inputs)
                array = self.known[number][case]
            largest = array.max()
            wide = array.astype(np.longdouble)
            arrays[number] = wide / largest if largest > 0.0 else wide
        if self._wanted:
            return [[float(value) for value in arrays[answer]] for answer in self._answers]
        total = arrays[self._answers[0]]
        for answer in self._answers[1:]:
            total = total * arrays[answer]
        return [[float(total.sum() > 0.0)]]

    def _step(self, steps: Any) -> Callable[[States], Posteriors]:
        slots: list[Any] = []
        for row in steps.slots:
            slots.append(self._slot(row, slots))
        if steps.bind is not None:
            step: Callable[[States], Posteriors] = steps.bind(np, slots)
            return step
        answers = [slots[steps.answers[k]] for k in self._wanted]
        needed: set[int] = set()  # messages that the answers are made of
        waiting = list(self._answers)
        while waiting:
            number = waiting.pop()
            if number not in needed and self.messages[number].kind == "product":
                needed.add(number)
                waiting += self.messages[number].parts
        operations = [
            (getattr(np, name), [slots[operand] for operand in operands])
            for message, name, *operands in steps.operations
            if message in needed
        ]

        def run(_: States) -> Posteriors:
            for function, operands in operations:
                function(*operands)
            return [answer if type(answer) is list else answer.tolist() for answer in answers]

        return run

    def _slot(self, row: Sequence[Any], slots: Sequence[Any]) -> Any:
        kind, source, *rest = row
        if kind == "result":
            return np.zeros(source)
        if kind == "ones":
            return np.ones(source)
        if kind == "evidence":
            return self._vectors[source].reshape(rest[0])
        if kind == "piece":
            axis, start, stop = rest
            piece = (*(slice(None),) * axis, slice(start, stop))
            of = slots[source]
            return [array[piece] for array in of] if type(of) is list else of[piece]
        if kind == "view":
            view = slots[source].transpose(rest[0]).reshape(rest[1])
            assert np.shares_memory(view, slots[source])
            return view
        known = self.known[source]
        if kind == "row":
            return known.tolist()
        if kind == "rows":
            return known.reshape([-1, known.shape[-1]]).tolist()
        order, shape = rest
        if kind == "constant":
            return known.transpose(order).reshape(shape).copy()
        return list(known.transpose(order).reshape([-1, *shape]).copy())
