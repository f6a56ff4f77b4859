"""Small parts of a network: one table for all cases of evidence, with the standard library only.

A step with hard or missing evidence is one look-up; virtual evidence sums over its inputs.
"""

from __future__ import annotations

from operator import mul
from typing import Mapping, NamedTuple, Sequence

from .engine import Rows, States, Weights


class Table(NamedTuple):
    """P(output, what is observed) of one output."""

    inputs: tuple[int, ...]  # positions of the nodes that select a row, the last one fastest
    rows: Rows  # one for each case; behind the states of an input, that for "not observed"


class Tables(NamedTuple):
    """The tables of a small part, one for each output."""

    tables: tuple[Table, ...]
    # position of an input -> its prior, where that is not in the tables
    priors: Mapping[int, Sequence[float]]

    def running(self, positions: Mapping[int, int], cards: Sequence[int]) -> JointTables:
        return JointTables(self, cards)


class JointTables:
    """The inference of a small part, see ``Running``."""

    def __init__(self, made: Tables, cards: Sequence[int]) -> None:
        self._priors = made.priors
        # of each table its rows, and (position of an input, distance between rows of its states)
        self._tables: list[tuple[Rows, list[tuple[int, int]]]] = []
        for table in made.tables:
            strides, stride = [], 1
            for position in reversed(table.inputs):
                strides.append((position, stride))
                stride *= cards[position] + 1
            self._tables.append((table.rows, strides[::-1]))

    def hard(self, states: States) -> Rows:
        found = []
        for rows, strides in self._tables:
            place = 0
            for position, stride in strides:
                place += states[position] * stride
            found.append(rows[place])
        return found

    def soft(self, states: States, weights: Weights, *, scale: bool = False) -> Rows:
        return [self._row(*table, states, weights, scale) for table in self._tables]

    def scaled(self, states: States, weights: Weights) -> Rows:
        return self.soft(states, weights, scale=True)

    def _row(
        self,
        rows: Rows,
        strides: Sequence[tuple[int, int]],
        states: States,
        weights: Weights,
        scale: bool,
    ) -> Sequence[float]:
        offsets = [0]
        vectors: list[Sequence[float]] = []
        for position, stride in strides:
            steps: Sequence[int] = (states[position] * stride,)
            if position in weights:
                vector, prior = weights[position], self._priors.get(position)
                vectors.append(vector if prior is None else list(map(mul, vector, prior)))
                steps = range(0, stride * len(vector), stride)
            offsets = [offset + step for offset in offsets for step in steps]
        row = [value for offset in offsets for value in rows[offset]]
        for vector in vectors:
            largest = max(row)
            if scale and largest > 0.0:
                row = [weight / largest for weight in row]
            block = len(row) // len(vector)
            slices = [row[k * block : (k + 1) * block] for k in range(len(vector))]
            row = [sum(map(mul, vector, column)) for column in zip(*slices)]
        return row
