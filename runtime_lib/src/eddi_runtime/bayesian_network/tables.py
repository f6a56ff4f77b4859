"""Small parts of a network: one table for all cases of evidence, with the standard library only.

A step with hard or missing evidence is one look-up; virtual evidence sums over its inputs.
"""

from __future__ import annotations

import itertools
from operator import mul
from typing import Callable, Mapping, NamedTuple, Sequence

from .engine import Posteriors, Rows, States, Weights


class Table(NamedTuple):
    """P(output, what is observed) of one output."""

    # (position of an input, distance between the rows of its states)
    strides: tuple[tuple[int, int], ...]
    # one for each case, with a state for "not observed"; empty where ``total`` gives them
    rows: Rows = ()
    # vectors of the inputs -> the row, summed over all states; None for a large table
    total: Callable[[Sequence[Sequence[float]]], list[float]] | None = None


class Tables(NamedTuple):
    """The tables of a small part, one for each output."""

    tables: tuple[Table, ...]  # one for each output; one for the evidence if there is no output
    # position of an input -> its prior, where that is not in the tables
    priors: Mapping[int, Sequence[float]]
    # rows of each table -> the look-up: states -> a row of each table
    bind: Callable[..., Callable[[States], Rows]]

    def running(self, cards: Mapping[int, tuple[int, int]], wanted: Sequence[int]) -> JointTables:
        return JointTables(self, dict(cards.values()), wanted or [0])


class JointTables:
    """The inference of a small part, see ``Running``."""

    def __init__(self, made: Tables, cards: Mapping[int, int], wanted: Sequence[int]) -> None:
        inputs = {position for table in made.tables for position, _ in table.strides}
        self._priors = made.priors
        self._vectors = {
            input_: _vectors(made.priors.get(input_) or [1.0] * cards[input_]) for input_ in inputs
        }
        tables = [*made.tables]
        for k, table in enumerate(tables):
            if table.total is not None and not table.rows:
                cases = itertools.product(*(self._vectors[place] for place, _ in table.strides))
                tables[k] = table._replace(rows=[table.total(case) for case in cases])
        look_up = made.bind(*[table.rows for table in tables])
        self._tables = [tables[k] for k in wanted]
        self.hard = look_up
        if len(wanted) < len(tables):
            self.hard = lambda states: [look_up(states)[k] for k in wanted]

    def soft(self, states: States, weights: Weights) -> Rows:
        return [
            self._row(table, states, weights)
            if table.total is None
            else table.total([self._vector(part, states, weights) for part, _ in table.strides])
            for table in self._tables
        ]

    def scaled(self, states: States, weights: Weights) -> Rows:
        return [self._row(table, states, weights, scale=True) for table in self._tables]

    def _vector(self, position: int, states: States, weights: Weights) -> Sequence[float]:
        weight = weights.get(position)
        if weight is None:
            return self._vectors[position][states[position]]
        prior = self._priors.get(position)
        return weight if prior is None else list(map(mul, weight, prior))

    def _row(
        self, table: Table, states: States, weights: Weights, *, scale: bool = False
    ) -> Sequence[float]:
        offsets = [0]
        vectors: list[Sequence[float]] = []
        for position, stride in table.strides:
            steps: Sequence[int] = (states[position] * stride,)
            if position in weights:
                vectors.append(self._vector(position, states, weights))
                steps = range(0, stride * len(vectors[-1]), stride)
            offsets = [offset + step for offset in offsets for step in steps]
        row = [value for offset in offsets for value in table.rows[offset]]
        for vector in vectors:
            largest = max(row)
            if scale and largest > 0.0:
                row = [weight / largest for weight in row]
            block = len(row) // len(vector)
            slices = [row[k * block : (k + 1) * block] for k in range(len(vector))]
            row = [sum(map(mul, vector, column)) for column in zip(*slices)]
        return row


def _vectors(prior: Sequence[float]) -> Posteriors:
    """Return the vector of an input for each state, and for "not observed" behind them."""
    states = range(len(prior))
    rows = [[float(k == state and prior[k] > 0.0) for k in states] for state in states]
    return [*rows, list(prior)]
