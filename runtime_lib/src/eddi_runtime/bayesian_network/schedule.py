"""Larger parts of a network: a fixed list of numpy operations on arrays made at load.

Two functions are made. ``full`` runs every message that depends on evidence; any mixture of hard,
virtual and missing evidence is put into its vectors. ``hard`` is for steps without virtual
evidence: messages that depend on few inputs are looked up, only the others are computed. Where
nodes are observed in each step, there is ``hard`` only.
"""

from __future__ import annotations

from typing import Callable, List, Mapping, Sequence, Tuple

import numpy as np

from .arrays import Arrays
from .emission import Emission, Rows, States
from .graph import Component
from .messages import Program
from .model import Network
from .tree import Tree

Weights = Mapping[int, Sequence[float]]


class Schedule:
    """The compiled operations of one part of a network. Not thread-safe: results stay in place.

    Attributes:
        outputs: nodes whose rows ``hard`` and ``soft`` give; empty for the evidence alone.
        hard: state of each observable node by position (the number of its states: not observed)
            -> unnormalised rows.
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
        self._program = program
        self._positions = positions
        self._arrays = Arrays(network, tree, program)
        self._inputs = part.inputs
        self._rows = {node: self._arrays.cases[node].tolist() for node in part.inputs}
        cards = network.shape.cards
        self._flat = np.zeros(sum(cards[node] for node in part.inputs))
        vectors, start = {}, 0
        for node in part.inputs:
            vectors[node] = self._flat[start : start + cards[node]]
            start += cards[node]
        self.hard: Callable[[States], Rows]
        self._full: Callable[[States], Rows]
        self.hard = Emission(program, cards, self._arrays, positions, None).compile()
        if part.given:
            self._full = self.hard
        else:
            self._full = Emission(program, cards, self._arrays, positions, vectors).compile()

    def soft(self, states: States, weights: Weights) -> Rows:
        """Return unnormalised rows when some inputs have virtual evidence (by position).

        Not where nodes are observed in each step.
        """
        values: List[float] = []
        for node in self._inputs:
            values += self._vector(node, states, weights)
        self._flat[:] = values
        return self._full(states)

    def scaled(self, states: States, weights: Weights) -> Rows:
        """Return rows of which none is zero by underflow; slow, for very unlikely evidence."""
        program = self._program
        wanted = (*program.answers.values(), *program.evidence)
        found = self._arrays.scaled(
            lambda node: np.array(self._vector(node, states, weights)),
            lambda node: states[self._positions[node]],
            wanted,
        )
        if not program.evidence:
            rows = [found[program.answers[node]] for node in self.outputs]
            return [[float(value) for value in row] for row in rows]
        total = found[program.evidence[0]]
        for edge in program.evidence[1:]:
            total = total * found[edge]
        return [[float(total.sum() > 0.0)]]

    def _vector(self, node: int, states: States, weights: Weights) -> List[float]:
        position = self._positions[node]
        rows: List[List[float]] = self._rows[node]
        weight = weights.get(position)
        if weight is None:
            return rows[states[position]]
        return [one * other for one, other in zip(weight, rows[-1])]
