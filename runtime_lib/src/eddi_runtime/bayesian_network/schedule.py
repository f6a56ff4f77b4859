"""Larger parts of a network: compiled numpy operations on arrays that are made at the start.

Axes of an array are the nodes of its message, ascending; before them lies one axis for each input
of the message, over its states and, where that may be, "not observed". How an array of a step is
made, by the first word of its row:

- ``constant`` message, order of axes, shape: a copy of known numbers;
- ``cases`` message, order of axes, shape: one such copy for each case of its inputs;
- ``row`` message: its numbers as a list; ``rows``: one list for each case;
- ``evidence`` node, shape: the vector of a node;
- ``result`` shape: where an operation writes to; ``ones`` length;
- ``view`` slot, order of axes, shape: the same memory as that slot;
- ``piece`` slot, axis, first, last: a part of it, or of each of its cases.
"""

from __future__ import annotations

from string import ascii_letters
from typing import TYPE_CHECKING, Any, Callable, Dict, List, Mapping, Sequence

import numpy as np

from .program import Message, Posteriors, Schedule, States, Steps, Weights

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Array = NDArray[np.float64]


class Running:
    """The operations of one part with their arrays. Not thread-safe: results stay in place.

    Args:
        made: what was compiled.
        positions: node -> its place in the states.
        wanted: which of the outputs are asked for; none: the probability of the evidence.

    Attributes:
        hard: state of each observable node by position (the number of its states: not observed)
            -> unnormalised rows.
    """

    def __init__(self, made: Schedule, positions: Mapping[int, int], wanted: Sequence[int]) -> None:
        self._nodes, self._positions = made.nodes, positions
        self._messages = [Message(*one) for one in made.messages]
        self._alone = not wanted
        self._answers = [made.answers[k] for k in wanted] or made.answers
        self._cases: Dict[int, Array] = {
            one.nodes[0]: self._evidence(one) for one in self._messages if one.kind in _EVIDENCE
        }
        self._known: Dict[int, Array] = {}
        for number, message in enumerate(self._messages):
            if message.known:
                self._known[number] = self._numbers(message, self._known, cases=True)
        self._rows = {node: cases.tolist() for node, cases in self._cases.items()}
        sizes = [len(rows[0]) for rows in self._rows.values()]
        self._flat = np.zeros(sum(sizes))
        ends = np.cumsum(sizes).tolist()
        self._vectors = {
            node: self._flat[end - size : end] for node, size, end in zip(self._rows, sizes, ends)
        }
        self._full = self._step(made.full or made.hard, wanted)
        self.hard: Callable[[States], Posteriors] = lambda states: self.soft(states, {})
        if made.hard is not None:
            self.hard = self._step(made.hard, wanted) if made.full else self._full

    def soft(self, states: States, weights: Weights) -> Posteriors:
        """Return unnormalised rows when some inputs have virtual evidence (by position).

        Not where nodes are observed in each step.
        """
        values: List[float] = []
        for node in self._rows:
            values += self._vector(node, states, weights)
        self._flat[:] = values
        return self._full(states)

    def scaled(self, states: States, weights: Weights) -> Posteriors:
        """Return rows of which none is zero by underflow; slow, for very unlikely evidence.

        Each message has the maximum 1, and the widest type of the machine is used: 80 bits on a
        PC, with exponents down to -4950.
        """
        found: Dict[int, Any] = {}
        for number, message in enumerate(self._messages):
            if message.kind in _EVIDENCE:
                array: Any = np.array(self._vector(message.nodes[0], states, weights))
            elif message.kind == "product":
                array = self._numbers(message, found, cases=False)
            else:
                array = self._known[number][
                    tuple(states[self._positions[node]] for node in message.inputs)
                ]
            largest = array.max()
            wide = array.astype(np.longdouble)
            found[number] = wide / largest if largest > 0.0 else wide
        if not self._alone:
            return [[float(value) for value in found[one]] for one in self._answers]
        total = found[self._answers[0]]
        for one in self._answers[1:]:
            total = total * found[one]
        return [[float(total.sum() > 0.0)]]

    def _vector(self, node: int, states: States, weights: Weights) -> List[float]:
        position = self._positions[node]
        rows: List[List[float]] = self._rows[node]
        weight = weights.get(position)
        if weight is None:
            return rows[states[position]]
        return [one * other for one, other in zip(weight, rows[-1])]

    def _evidence(self, message: Message) -> Array:
        """Return a row for each state of a node and one for "not observed"."""
        rows = np.array(self._nodes[message.nodes[0]][1])
        card = rows.shape[1]
        made = np.vstack([np.eye(card), np.ones(card)])
        if message.kind == "prior":
            made[:card] *= rows[0] > 0.0
            made[card] = rows[0]
        return made

    def _numbers(self, message: Message, of: Mapping[int, Any], *, cases: bool) -> Any:
        if message.kind == "product":
            return self._product(message, of, cases=cases)
        node = message.parts[0] if message.kind == "table" else message.nodes[0]
        if message.kind in _EVIDENCE:
            return self._cases[node]
        parents, rows = self._nodes[node]
        if message.kind == "unit":
            return np.ones(len(rows[0]))
        axes = (*parents, node)
        array = np.array(rows).reshape([len(self._nodes[one][1][0]) for one in axes])
        return array.transpose([axes.index(one) for one in (*message.inputs, *message.nodes)])

    def _product(self, message: Message, of: Mapping[int, Any], *, cases: bool) -> Any:
        """Multiply two messages and sum over the nodes that the product has no axis for."""
        first, second = (self._messages[part] for part in message.parts)
        axes = sorted({*first.nodes, *second.nodes})
        inputs = message.inputs if cases else ()
        # einsum knows 52 letters only, so they are counted anew for each pair.
        letter = dict(zip([*axes, *(-1 - node for node in inputs)], ascii_letters))

        def letters(part: Message) -> str:
            before = part.inputs if cases else ()
            return "".join(letter[one] for one in [*(-1 - node for node in before), *part.nodes])

        formula = f"{letters(first)},{letters(second)}->{letters(message)}"
        return np.einsum(formula, *(of[part] for part in message.parts))

    def _step(self, steps: Any, wanted: Sequence[int]) -> Callable[[States], Posteriors]:
        slots: List[Any] = []
        for row in steps.slots:
            slots.append(self._slot(row, slots))
        if steps.bind is not None:
            step: Callable[[States], Posteriors] = steps.bind(np, slots)
            return step
        answers = [slots[steps.answers[k]] for k in wanted]
        operations = [
            (getattr(np, name), [slots[one] for one in operands])
            for name, *operands in _needed(steps, [steps.answers[k] for k in wanted])
        ]

        def run(_: States) -> Posteriors:
            for function, operands in operations:
                function(*operands)
            return [one if type(one) is list else one.tolist() for one in answers]

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
            return [one[piece] for one in of] if type(of) is list else of[piece]
        if kind == "view":
            view = slots[source].transpose(rest[0]).reshape(rest[1])
            assert np.shares_memory(view, slots[source])
            return view
        known = self._known[source]
        if kind == "row":
            return known.tolist()
        if kind == "rows":
            return known.reshape([-1, known.shape[-1]]).tolist()
        order, shape = rest
        if kind == "constant":
            return known.transpose(order).reshape(shape).copy()
        return list(known.transpose(order).reshape([-1, *shape]).copy())


_EVIDENCE = ("evidence", "prior")


def _needed(steps: Steps, answers: Sequence[int]) -> List[Sequence[Any]]:
    """Return the operations that some answers need."""

    def memory(slot: int) -> int:
        while steps.slots[slot][0] in ("view", "piece"):
            slot = steps.slots[slot][1]
        return slot

    alive = {memory(one) for one in answers}
    found: List[Sequence[Any]] = []
    for row in reversed(steps.operations):
        name, *operands = row
        written = operands[0] if name == "copyto" else operands[-1]
        if memory(written) in alive:
            found.append(row)
            alive.update(map(memory, operands))
    return found[::-1]
