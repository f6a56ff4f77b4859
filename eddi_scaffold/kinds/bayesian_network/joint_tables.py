"""Small parts of a network: one table for all cases of evidence.

For each output P(output, inputs) is made once, over the states of every input and "not observed" as
one more state. The robot needs no numpy for it.
"""

from __future__ import annotations

import math
from functools import reduce
from operator import add
from typing import NamedTuple

from eddi_scaffold.kinds.bayesian_network.clique_tree import PRIOR, TABLE, UNIT
from eddi_scaffold.kinds.bayesian_network.message_passing import (
    Edge,
    Message,
    MessageProgram,
    Plan,
    with_missing,
)
from eddi_scaffold.kinds.bayesian_network.network import NumberedNetwork, bits, size_of

MAX_NUMBERS = 16_384  # Numbers in the table of one output: half a megabyte
_MAX_WORK = 100_000  # Multiplications for one message: 30 ms


class JointTable(NamedTuple):
    """P(output, what is observed) of one output."""

    output: int  # its node
    inputs: tuple[int, ...]  # nodes that select a row, ascending
    counts: tuple[int, ...]  # rows for each of them: its states, behind them "not observed"
    rows: list[list[float]]  # one for each case, the last input fastest


def fits(program: MessageProgram, network: NumberedNetwork) -> bool:
    """Return whether the tables of a part are small."""
    cards, messages = network.shape.cards, program.messages
    cases = with_missing(cards)
    for message in messages.values():
        work = size_of(message.inputs, cases) * program.work(message, cards)
        if message.parts and work > _MAX_WORK:
            return False
    return all(
        size_of(messages[edge].inputs, cases) * cards[node] <= MAX_NUMBERS
        for node, edge in program.answers.items()
    )


def priors_of(network: NumberedNetwork, plan: Plan) -> dict[int, tuple[float, ...]]:
    """Return input -> its prior, where that goes with its evidence and not with the tables."""
    messages = plan.program.messages.values()
    nodes = sorted(message.node for message in messages if message.kind == PRIOR)
    return {node: network.tables[node] for node in nodes}


class _Factor(NamedTuple):
    """A table as a flat list, last axis fastest; axes are nodes, or nodes + count for cases."""

    axes: tuple[int, ...]
    values: list[float]


class JointTables:
    """The tables of a part of a network."""

    def __init__(self, network: NumberedNetwork, plan: Plan) -> None:
        self._network, self._plan = network, plan
        self._cards, self._count = network.shape.cards, len(network.shape.cards)
        self._sizes = [*self._cards, *with_missing(self._cards)]  # of axes
        self._priors = priors_of(network, plan)

    def tables(self) -> tuple[JointTable, ...]:
        """Return the table of each output."""
        factors: dict[Edge, _Factor] = {}
        for edge, message in self._plan.program.messages.items():
            if message.parts:
                first, second = (factors[source] for source in message.parts)
                factors[edge] = self._product(first, second, message.mask, message.inputs)
            else:
                factors[edge] = self._leaf(message)
        tables = []
        for output in self._plan.part.outputs:
            axes, values = factors[self._plan.program.answers[output]]
            card, inputs = self._cards[output], tuple(axis - self._count for axis in axes[:-1])
            rows = [values[k : k + card] for k in range(0, len(values), card)]
            counts = tuple(self._sizes[axis] for axis in axes[:-1])
            tables.append(JointTable(output, inputs, counts, rows))
        return tuple(tables)

    def _leaf(self, message: Message) -> _Factor:
        node, card = message.node, self._cards[message.node]
        if message.kind == TABLE:
            return _Factor(self._network.shape.family(node), list(self._network.tables[node]))
        if message.kind == UNIT:
            return _Factor((node,), [1.0] * card)
        prior = self._priors.get(node, (1.0,) * card)
        observed = [
            float(k == state and p > 0.0) for state in range(card) for k, p in enumerate(prior)
        ]
        return _Factor((node + self._count, node), [*observed, *prior])

    def _product(self, first: _Factor, second: _Factor, mask: int, inputs: int) -> _Factor:
        """Multiply two factors and sum over all nodes outside ``mask``; cases of inputs stay."""
        kept = (*(node + self._count for node in bits(inputs)), *bits(mask))
        summed = tuple(sorted({*first.axes, *second.axes}.difference(kept)))
        places = []
        for factor in (first, second):
            strides, stride = {}, 1
            for axis in reversed(factor.axes):
                strides[axis] = stride
                stride *= self._sizes[axis]
            offsets = [0]
            for axis in (*kept, *summed):
                steps = [strides.get(axis, 0) * state for state in range(self._sizes[axis])]
                offsets = [offset + step for offset in offsets for step in steps]
            places.append(offsets)
        terms = [first.values[i] * second.values[j] for i, j in zip(*places, strict=True)]
        count = math.prod(self._cards[axis] for axis in summed)
        if count > 1:
            starts = range(0, len(terms), count)
            # From left to right: `sum` of Python 3.12 gives other digits than before.
            terms = [reduce(add, terms[k : k + count]) for k in starts]
        return _Factor(kept, terms)
