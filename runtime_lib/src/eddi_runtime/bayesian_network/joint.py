"""Small parts of a network: one table for all cases of evidence, with the standard library only.

A step with hard or missing evidence is one look-up; virtual evidence sums over the states of the
inputs that it is given for. Monitors of small networks so start without numpy.
"""

from __future__ import annotations

import itertools
from operator import mul
from typing import Callable, List, Mapping, Optional, Sequence, Tuple

from .program import Posteriors, Rows, States, Table, Tables, Weights


class JointTables:
    """The tables of one part of a network.

    Args:
        made: what was compiled.
        inputs: position -> number of states of each observable node of the part.
        wanted: which of the tables are asked for.
    """

    def __init__(self, made: Tables, inputs: Mapping[int, int], wanted: Sequence[int]) -> None:
        self._tables = [made.tables[k] for k in wanted]
        self._priors = made.priors
        self._vectors = {
            position: _vectors(card, made.priors.get(position)) for position, card in inputs.items()
        }
        self._known: Optional[List[Tuple[Callable[[States], int], Rows]]] = None

    def hard(self, states: States) -> Rows:
        """Return unnormalised rows when no input has virtual evidence; see ``soft``."""
        known = self._known
        if known is None:
            known = self._known = [self._rows(table) for table in self._tables]
        return [rows[index(states)] for index, rows in known]

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
            else table.total([self._vector(one, states, weights) for one, _ in table.strides])
            for table in self._tables
        ]

    def scaled(self, states: States, weights: Weights) -> Posteriors:
        """Return rows of which none is zero by underflow, for very small likelihoods."""
        return [self._soft(table, states, weights, scale=True) for table in self._tables]

    def _vector(self, position: int, states: States, weights: Weights) -> Sequence[float]:
        weight = weights.get(position)
        if weight is None:
            return self._vectors[position][states[position]]
        prior = self._priors.get(position)
        return weight if prior is None else list(map(mul, weight, prior))

    def _soft(
        self, table: Table, states: States, weights: Weights, *, scale: bool = False
    ) -> List[float]:
        offsets, vectors = [0], []
        for position, stride in table.strides:
            if position not in weights:
                offsets = [one + states[position] * stride for one in offsets]
                continue
            vectors.append(self._vector(position, states, weights))
            end = stride * len(weights[position])
            offsets = [one + step for one in offsets for step in range(0, end, stride)]
        _, rows = self._rows(table)
        row = [value for one in offsets for value in rows[one]]
        for vector in vectors:
            largest = max(row)
            if scale and largest > 0.0:
                row = [one / largest for one in row]
            block = len(row) // len(vector)
            slices = [row[k * block : (k + 1) * block] for k in range(len(vector))]
            row = [sum(map(mul, vector, column)) for column in zip(*slices)]
        return row

    def _rows(self, table: Table) -> Tuple[Callable[[States], int], Rows]:
        if table.row_of is not None:
            return table.row_of, table.rows
        strides, total = table.strides, table.total
        assert total is not None
        cases = itertools.product(*(self._vectors[position] for position, _ in strides))
        rows = [total(case) for case in cases]
        return lambda s: sum([s[position] * stride for position, stride in strides]), rows


def _vectors(card: int, prior: Optional[Sequence[float]]) -> Posteriors:
    """Return the vector of an input for each of its states, and for "not observed" behind them."""
    known = prior or [1.0] * card
    rows = [
        [float(one == state and p > 0.0) for one, p in enumerate(known)] for state in range(card)
    ]
    return [*rows, list(known)]
