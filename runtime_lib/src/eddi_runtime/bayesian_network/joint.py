"""Small parts of a network: one table for all cases of evidence, with the standard library only.

For each output P(output, inputs) is made once, over the states of every input and, where that may
be, "not observed" as one more state. A step with hard or missing evidence is one look-up; virtual
evidence sums over the states of the inputs that it is given for. Monitors of small networks so
start without numpy.
"""

from __future__ import annotations

import math
from operator import mul
from typing import Callable, Dict, List, Mapping, NamedTuple, Optional, Sequence, Tuple

from .graph import Component, bits, mask_of, size_of
from .messages import Edge, Message, Program
from .messages import work as work_of
from .model import Network
from .tree import EVIDENCE, TABLE, Tree
from .unrolled import Total, make_total

MAX_NUMBERS = 16_384
"""Numbers in the table of one output: half a megabyte."""
_MAX_WORK = 100_000
"""Multiplications for one message when the model is loaded: 30 ms."""

Rows = List[List[float]]
States = Sequence[int]
Weights = Mapping[int, Sequence[float]]


class _Factor(NamedTuple):
    """A table as a flat list, last axis fastest; axes are nodes, or nodes + count for cases."""

    axes: Tuple[int, ...]
    values: List[float]


class _Table(NamedTuple):
    """The table of one output.

    Attributes:
        values: P(output, inputs), the output fastest.
        strides: (position of an input in the evidence, distance between its states).
        card: number of states of the output; 1 if it is the probability of the evidence alone.
        total: vectors of the inputs -> the row, summed over all states; None for a large table.
    """

    values: List[float]
    strides: Tuple[Tuple[int, int], ...]
    card: int
    total: Optional[Total]


def fits(program: Program, network: Network, part: Component) -> bool:
    """Return whether the tables of a part are small."""
    cards = network.shape.cards
    for message in program.messages.values():
        cases = size_of(message.inputs, program.cases)
        if message.parts and cases * work_of(program.messages, message, cards) > _MAX_WORK:
            return False
    for edge in program.answers.values():
        (node,) = bits(program.messages[edge].mask)
        if size_of(program.messages[edge].inputs, program.cases) * cards[node] > MAX_NUMBERS:
            return False
    inputs = mask_of((*part.inputs, *part.given))
    return not program.evidence or size_of(inputs, program.cases) <= MAX_NUMBERS


class JointTables:
    """The tables of one part of a network.

    Attributes:
        outputs: nodes whose rows ``hard`` and ``soft`` give; empty for the evidence alone.
    """

    def __init__(
        self,
        network: Network,
        part: Component,
        tree: Tree,
        program: Program,
        positions: Mapping[int, int],
    ) -> None:
        self.outputs: Tuple[int, ...] = part.outputs
        self._cards = network.shape.cards
        self._cases = program.cases
        self._count = len(self._cards)
        self._positions = positions
        in_tables = {leaf.node for leaf in tree.leaves if leaf.kind == TABLE}
        self._priors = {
            positions[node]: None if node in in_tables else list(network.tables[node])
            for node in part.inputs
        }
        self._rows = {
            positions[node]: _rows(self._cards[node], self._priors[positions[node]])
            for node in part.inputs
        }
        factors = self._factors(network, tree, program)
        answers = [factors[program.answers[node]] for node in part.outputs]
        if program.evidence:
            one, other = (factors[edge] for edge in (*program.evidence, *program.evidence)[:2])
            if len(program.evidence) == 1:
                other = _Factor((), [1.0])
            answers = [self._product(one, other, 0, mask_of((*part.inputs, *part.given)))]
        self._tables = [self._table(one, part) for one in answers]
        self.hard: Callable[[States], Rows] = self._compile()

    @property
    def positive(self) -> bool:
        """Return whether no case has probability zero."""
        return all(min(table.values) > 0.0 for table in self._tables)

    def soft(self, states: States, weights: Weights) -> Rows:
        """Return unnormalised rows when some inputs have virtual evidence.

        Args:
            states: state of each observable node of the network by position; the number of its
                states represents "not observed" and virtual evidence.
            weights: position -> likelihoods.
        """
        return [
            self._soft(table, states, weights)
            if table.total is None
            else table.total(self._vectors(table, states, weights))
            for table in self._tables
        ]

    def scaled(self, states: States, weights: Weights) -> Rows:
        """Return rows of which none is zero by underflow, for very small likelihoods."""
        return [self._soft(table, states, weights, scale=True) for table in self._tables]

    def _vectors(self, table: _Table, states: States, weights: Weights) -> List[Sequence[float]]:
        vectors: List[Sequence[float]] = []
        for position, _ in table.strides:
            weight = weights.get(position)
            if weight is None:
                vectors.append(self._rows[position][states[position]])
            else:
                prior = self._priors[position]
                vectors.append(weight if prior is None else list(map(mul, weight, prior)))
        return vectors

    def _soft(
        self, table: _Table, states: States, weights: Weights, *, scale: bool = False
    ) -> List[float]:
        offsets, vectors = [0], []
        for position, stride in table.strides:
            weight = weights.get(position)
            if weight is None:
                step = states[position] * stride
                offsets = [one + step for one in offsets]
                continue
            prior = self._priors[position]
            vectors.append(weight if prior is None else list(map(mul, weight, prior)))
            end = stride * len(weight)
            offsets = [one + step for one in offsets for step in range(0, end, stride)]
        values = table.values
        row = [values[one + state] for one in offsets for state in range(table.card)]
        for vector in vectors:
            largest = max(row)
            if scale and largest > 0.0:
                row = [one / largest for one in row]
            block = len(row) // len(vector)
            slices = [row[k * block : (k + 1) * block] for k in range(len(vector))]
            row = [sum(map(mul, vector, column)) for column in zip(*slices)]
        return row

    def _compile(self) -> Callable[[States], Rows]:
        names: Dict[str, object] = {"__builtins__": {}}
        rows = []
        for number, table in enumerate(self._tables):
            names[f"t{number}"] = table.values
            terms = [f"s[{position}] * {stride}" for position, stride in table.strides]
            start = " + ".join(terms) or "0"
            rows.append(f"t{number}[{start} : {' + '.join([*terms, str(table.card)])}]")
        text = f"def hard(s):\n    return [{', '.join(rows)}]"
        exec(compile(text, "<Bayesian network>", "exec"), names)  # noqa: S102 - numbers of our own
        made: Callable[[States], Rows] = names["hard"]  # type: ignore[assignment]  # just defined
        return made

    def _factors(self, network: Network, tree: Tree, program: Program) -> Dict[Edge, _Factor]:
        factors: Dict[Edge, _Factor] = {}
        for edge, message in program.messages.items():
            if message.parts:
                one, other = (factors[part] for part in message.parts)
                factors[edge] = self._product(one, other, message.mask, message.inputs)
            else:
                factors[edge] = self._leaf(network, tree, message)
        return factors

    def _leaf(self, network: Network, tree: Tree, message: Message) -> _Factor:
        leaf = tree.leaves[message.leaf]
        node, card = leaf.node, self._cards[leaf.node]
        if leaf.kind == TABLE:
            family = (*network.shape.parents[node], node)
            axes = tuple(one + self._count if leaf.seen >> one & 1 else one for one in family)
            return _Factor(axes, list(network.tables[node]))
        if leaf.kind != EVIDENCE:
            return _Factor((node,), [1.0] * card)
        rows = self._rows[self._positions[node]]
        return _Factor((node + self._count, node), [value for row in rows for value in row])

    def _product(self, one: _Factor, other: _Factor, mask: int, inputs: int) -> _Factor:
        """Multiply two factors and sum over all nodes outside ``mask``; cases of inputs stay."""
        kept = (*(node + self._count for node in bits(inputs)), *bits(mask))
        summed = tuple(sorted({*one.axes, *other.axes}.difference(kept)))
        first, second = (self._offsets(factor, (*kept, *summed)) for factor in (one, other))
        left, right = one.values, other.values
        terms = [left[i] * right[j] for i, j in zip(first, second)]
        count = math.prod(self._cards[axis] for axis in summed)
        if count > 1:
            terms = [sum(terms[k : k + count]) for k in range(0, len(terms), count)]
        return _Factor(kept, terms)

    def _offsets(self, factor: _Factor, axes: Tuple[int, ...]) -> List[int]:
        strides, stride = {}, 1
        for axis in reversed(factor.axes):
            strides[axis] = stride
            stride *= self._size(axis)
        offsets = [0]
        for axis in axes:
            steps = [strides.get(axis, 0) * state for state in range(self._size(axis))]
            offsets = [one + step for one in offsets for step in steps]
        return offsets

    def _size(self, axis: int) -> int:
        return self._cards[axis] if axis < self._count else self._cases[axis - self._count]

    def _table(self, factor: _Factor, part: Component) -> _Table:
        card = self._cards[factor.axes[-1]] if part.outputs else 1
        cases = factor.axes[:-1] if part.outputs else factor.axes
        strides, stride = [], card
        for axis in reversed(cases):
            strides.append((self._positions[axis - self._count], stride))
            stride *= self._size(axis)
        strides.reverse()
        total = None
        if not part.given:
            counts = [len(self._rows[position]) - 1 for position, _ in strides]
            total = make_total(factor.values, counts, [one for _, one in strides], card)
        return _Table(factor.values, tuple(strides), card, total)


def _rows(card: int, prior: Optional[Sequence[float]]) -> List[List[float]]:
    """Return the vector of an input for each of its states, and for "not observed" behind them."""
    known = prior or [1.0] * card
    rows = [
        [float(one == state and p > 0.0) for one, p in enumerate(known)] for state in range(card)
    ]
    return [*rows, list(known)]
