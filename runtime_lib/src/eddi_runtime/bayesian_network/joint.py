"""Small parts of a network: one table for all cases of evidence, with the standard library only.

A step with hard or missing evidence is one look-up; virtual evidence sums over the states of the
inputs that it is given for. Monitors of small networks so start without numpy.
"""

from __future__ import annotations

import itertools
from operator import mul
from typing import List, Mapping, Optional, Sequence

from .program import Posteriors, States, Table, Tables, Weights


class JointTables:
    """The tables of one part of a network.

    Args:
        made: what was compiled.
        inputs: position -> number of states of each observable node of the part.
        wanted: which of the tables are asked for.

    Attributes:
        hard: states -> unnormalised rows when no input has virtual evidence; see ``soft``.
    """

    def __init__(self, made: Tables, inputs: Mapping[int, int], wanted: Sequence[int]) -> None:
        self._priors = {position: made.priors.get(position) for position in inputs}
        self._vectors = {
            position: _vectors(card, made.priors.get(position)) for position, card in inputs.items()
        }
        tables = [self._filled(table) for table in made.tables]
        look_up = made.bind(*[table.rows for table in tables])
        self._tables = [tables[k] for k in wanted]
        self.hard = look_up
        if len(wanted) < len(tables):
            self.hard = lambda states: [look_up(states)[k] for k in wanted]

    def soft(self, states: States, weights: Weights) -> Posteriors:
        """Return unnormalised rows when some inputs have virtual evidence.

        Args:
            states: state of each observable node of the network by position; the number of its
                states represents "not observed" and virtual evidence.
            weights: position -> likelihoods.
        """
        return [
            self._soft(table, states, weights)
            if table.total is None
            else table.total(self._mixed(table, states, weights))
            for table in self._tables
        ]

    def scaled(self, states: States, weights: Weights) -> Posteriors:
        """Return rows of which none is zero by underflow, for very small likelihoods."""
        return [self._soft(table, states, weights, scale=True) for table in self._tables]

    def _mixed(self, table: Table, states: States, weights: Weights) -> List[Sequence[float]]:
        vectors: List[Sequence[float]] = []
        for position, _ in table.strides:
            weight = weights.get(position)
            if weight is None:
                vectors.append(self._vectors[position][states[position]])
            else:
                prior = self._priors[position]
                vectors.append(weight if prior is None else list(map(mul, weight, prior)))
        return vectors

    def _soft(
        self, table: Table, states: States, weights: Weights, *, scale: bool = False
    ) -> List[float]:
        offsets = [0]
        vectors: List[Sequence[float]] = []
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
        row = [value for one in offsets for value in table.rows[one]]
        for vector in vectors:
            largest = max(row)
            if scale and largest > 0.0:
                row = [one / largest for one in row]
            block = len(row) // len(vector)
            slices = [row[k * block : (k + 1) * block] for k in range(len(vector))]
            row = [sum(map(mul, vector, column)) for column in zip(*slices)]
        return row

    def _filled(self, table: Table) -> Table:
        if table.total is None or table.rows:
            return table
        cases = itertools.product(*(self._vectors[position] for position, _ in table.strides))
        return table._replace(rows=[table.total(case) for case in cases])


def _vectors(card: int, prior: Optional[Sequence[float]]) -> Posteriors:
    """Return the vector of an input for each of its states, and for "not observed" behind them."""
    known = prior or [1.0] * card
    rows = [
        [float(one == state and p > 0.0) for one, p in enumerate(known)] for state in range(card)
    ]
    return [*rows, list(known)]
