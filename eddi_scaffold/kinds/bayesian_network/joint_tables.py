"""Small parts of a network: one table for all cases of evidence.

For each output P(output, inputs) is made once, over the states of every input and, where that may
be, "not observed" as one more state. The robot needs no numpy for it.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import NamedTuple

from eddi_scaffold.kinds.bayesian_network.clique_tree import EVIDENCE, TABLE
from eddi_scaffold.kinds.bayesian_network.message_passing import Edge, Message, MessageProgram, Plan
from eddi_scaffold.kinds.bayesian_network.network import (
    Component,
    NumberedNetwork,
    bits,
    mask_of,
    size_of,
)
from eddi_scaffold.program import python_text as py

MAX_NUMBERS = 16_384  # Numbers in the table of one output: half a megabyte
MAX_SUMMED = 128  # Numbers of a table up to which a sum that is written out is the faster way
_MAX_WORK = 100_000  # Multiplications for one message: 30 ms


class JointTable(NamedTuple):
    """P(output, what is observed) of one output."""

    output: int  # its node, -1 for the probability of the evidence alone
    card: int  # number of states of the output; 1 for the evidence alone
    inputs: tuple[int, ...]  # nodes that select a row, ascending
    # rows for each of them: its states, and behind them "not observed" where that may be
    counts: tuple[int, ...]
    rows: list[list[float]]  # one for each case, the last input fastest
    summed: bool  # the numbers for "not observed" are sums of others, so they can be left out

    def strides(self) -> tuple[int, ...]:
        """Return the distance between the rows of two states of each input."""
        return tuple(math.prod(self.counts[k + 1 :]) for k in range(len(self.counts)))

    def few(self) -> bool:
        """Return whether the sum over all states is short enough for being written out."""
        states = math.prod(count - 1 for count in self.counts)
        return self.summed and self.card * states <= MAX_SUMMED


def fits(program: MessageProgram, network: NumberedNetwork, part: Component) -> bool:
    """Return whether the tables of a part are small."""
    cards, messages = network.shape.cards, program.messages
    for message in messages.values():
        cases = size_of(message.inputs, program.cases)
        if message.parts and cases * program.work(message, cards) > _MAX_WORK:
            return False
    for node, edge in program.answers.items():
        if size_of(messages[edge].inputs, program.cases) * cards[node] > MAX_NUMBERS:
            return False
    inputs = mask_of((*part.inputs, *part.always_observed))
    return not program.evidence or size_of(inputs, program.cases) <= MAX_NUMBERS


def priors_of(network: NumberedNetwork, plan: Plan) -> dict[int, tuple[float, ...]]:
    """Return input -> its prior, where that goes with its evidence and not with the tables."""
    in_tables = {leaf.node for leaf in plan.tree.leaves if leaf.kind == TABLE}
    return {node: network.tables[node] for node in plan.part.inputs if node not in in_tables}


class _Factor(NamedTuple):
    """A table as a flat list, last axis fastest; axes are nodes, or nodes + count for cases."""

    axes: tuple[int, ...]
    values: list[float]


class JointTables:
    """The tables of a part of a network."""

    def __init__(self, network: NumberedNetwork, plan: Plan) -> None:
        self._network, self._plan = network, plan
        self._cards, self._cases = network.shape.cards, plan.program.cases
        self._count = len(self._cards)
        self._priors = priors_of(network, plan)

    def tables(self) -> tuple[JointTable, ...]:
        """Return the table of each output; that of the evidence if there is none."""
        factors: dict[Edge, _Factor] = {}
        part, _, program = self._plan
        for edge, message in program.messages.items():
            if message.parts:
                first, second = (factors[source] for source in message.parts)
                factors[edge] = self._product(first, second, message.mask, message.inputs)
            else:
                factors[edge] = self._leaf(message)
        if not program.evidence:
            return tuple(self._table(factors[program.answers[node]], node) for node in part.outputs)
        first, *others = (factors[edge] for edge in program.evidence)
        second = others[0] if others else _Factor((), [1.0])
        inputs = mask_of((*part.inputs, *part.always_observed))
        return (self._table(self._product(first, second, 0, inputs), -1),)

    def _leaf(self, message: Message) -> _Factor:
        leaf = self._plan.tree.leaves[message.leaf]
        node, card = leaf.node, self._cards[leaf.node]
        if leaf.kind == TABLE:
            family = self._network.shape.family(node)
            axes = tuple(n + self._count if leaf.seen >> n & 1 else n for n in family)
            return _Factor(axes, list(self._network.tables[node]))
        if leaf.kind != EVIDENCE:
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
                stride *= self._size(axis)
            offsets = [0]
            for axis in (*kept, *summed):
                steps = [strides.get(axis, 0) * state for state in range(self._size(axis))]
                offsets = [offset + step for offset in offsets for step in steps]
            places.append(offsets)
        terms = [first.values[i] * second.values[j] for i, j in zip(*places, strict=True)]
        count = math.prod(self._cards[axis] for axis in summed)
        if count > 1:
            terms = [added(terms[k : k + count]) for k in range(0, len(terms), count)]
        return _Factor(kept, terms)

    def _size(self, axis: int) -> int:
        return self._cards[axis] if axis < self._count else self._cases[axis - self._count]

    def _table(self, factor: _Factor, output: int) -> JointTable:
        card = 1 if output < 0 else self._cards[output]
        cases = factor.axes if output < 0 else factor.axes[:-1]
        values = factor.values
        rows = [values[k : k + card] for k in range(0, len(values), card)]
        inputs, counts = (tuple(n - self._count for n in cases), tuple(map(self._size, cases)))
        return JointTable(output, card, inputs, counts, rows, not self._plan.part.always_observed)


def added(values: Sequence[float]) -> float:
    """Return the sum from left to right: `sum` of Python 3.12 gives other digits than before."""
    total = 0.0
    for value in values:
        total += value
    return total


def sum_lines(target: str, terms: Sequence[str], indent: int) -> list[str]:
    """Return the lines of ``target = term + term``, added from left to right."""
    blanks = " " * indent
    lines, line = [], f"{blanks}{target} = {terms[0]}"
    for term in terms[1:]:
        if len(line) + len(term) + 3 > py.WIDTH:
            lines.append(line)
            line = f"{blanks}{target} = {target}"
        line += f" + {term}"
    return [*lines, line]


def look_up_lines(
    name: str, tables: Sequence[Sequence[tuple[int, int]]], about: Sequence[str]
) -> list[str]:
    """Return a function: rows of each table -> the look-up, states -> a row of each table.

    A table is given by (position of an input, distance between the rows of its states).
    """
    rows = [f"t{k}" for k in range(len(tables))]
    lines = [f"    # t{k}: {of}" for k, of in enumerate(about)]
    lines += [*py.unpacked(rows, "tables", 4), "", "    def look_up(s):"]
    case_of: dict[tuple[tuple[int, int], ...], str] = {}
    for strides in map(tuple, tables):
        if strides not in case_of:
            terms = [f"s[{position}] * {by}" for position, by in strides] or ["0"]
            case_of[strides] = f"k{len(case_of)}"
            lines += sum_lines(case_of[strides], terms, 8)
    items = (py.Item(f"{t}[{case_of[tuple(of)]}]") for t, of in zip(rows, tables, strict=True))
    lines += py.returned(py.Group("[", tuple(items), "]"), 8)
    return [f"def {name}(*tables):", *lines, "", "    return look_up"]


def total_lines(
    name: str,
    rows: Sequence[Sequence[float]],
    counts: Sequence[int],
    strides: Sequence[int],
    axes: Sequence[str],
    states: Sequence[str],
) -> list[str]:
    """Return a function: one vector for each axis -> the sum of all products with a table.

    ``counts`` numbers of each axis are summed, whose rows are ``strides`` apart; ``axes`` and
    ``states`` (of a row) are comments.
    """
    lines = [f"def {name}(v):"]
    for axis, count in enumerate(counts):
        lines.append(f"    # {axes[axis]}")
        lines += py.unpacked([f"v{axis}_{k}" for k in range(count)], f"v[{axis}]", 4)
    count = 0

    def terms(axis: int, offset: int, state: int) -> list[str]:
        nonlocal count
        texts = []
        for k in range(counts[axis]):
            place = offset + k * strides[axis]
            if axis + 1 == len(counts):
                texts.append(f"v{axis}_{k} * {py.number(rows[place][state])}")
                continue
            inner = terms(axis + 1, place, state)
            text = f"({' + '.join(inner)})"
            if len(text) > py.WIDTH - 30:
                text, count = f"x{count}", count + 1
                lines.extend(sum_lines(text, inner, 4))
            texts.append(f"v{axis}_{k} * {text}")
        return texts

    names = [f"p{state}" for state in range(len(rows[0]))]
    for state, name_of_sum in enumerate(names):
        lines.append(f"    # {states[state]}")
        of_state = terms(0, 0, state) if counts else [py.number(rows[0][state])]
        lines += sum_lines(name_of_sum, of_state, 4)
    return [*lines, *py.returned(py.Group("[", tuple(map(py.Item, names)), "]"), 4)]
