"""Exact inference by what was compiled: evidence in, posteriors of the outputs out."""

from __future__ import annotations

import math
from typing import Any, List, Mapping, NamedTuple, Sequence

Rows = Sequence[Sequence[float]]
States = Sequence[int]
Weights = Mapping[int, Sequence[float]]
Posteriors = List[List[float]]

_TINY = 1e-200  # a sum below this may have lost terms to underflow
_LEAST_EXPONENT = -900
"""Powers of two down to which a product stays an exact double, with some room."""
_NO_WEIGHTS: Weights = {}


class NodeSpec(NamedTuple):
    """A node: its name, its states, and its method ``node_<attribute>``."""

    id: str
    states: tuple[str, ...]
    attribute: str


class Part(NamedTuple):
    """A part of a network; no evidence connects it with the others."""

    # its tables or its schedule; ``running`` gives what infers rows that are not normalised:
    # ``hard`` from states, ``soft`` with virtual evidence, ``scaled`` so that none underflows
    made: Any
    inputs: tuple[int, ...]  # positions of its observable nodes among those of the program
    # nodes whose rows it gives; one that is no output only tells whether the evidence is possible
    outputs: tuple[int, ...]
    least: int  # lower bound of the exponent of any product of its non-zero probabilities


class Program(NamedTuple):
    """Inference for some outputs and observable nodes."""

    outputs: tuple[int, ...]  # nodes whose posteriors can be asked for, ascending
    # nodes that may be observed, ascending; evidence goes by position here
    observable: tuple[int, ...]
    parts: tuple[Part, ...]  # all that can matter


class _Slot(NamedTuple):
    """Where the row of an output goes."""

    output: int  # its place among the outputs, -1 if it is none
    position: int  # its place among the observable nodes, -1 if it is none
    card: int  # number of its states


class _Inference(NamedTuple):
    """What infers one part, the positions of its inputs, and where its rows go."""

    running: Any
    positions: frozenset[int]
    slots: tuple[_Slot, ...]
    least: int


class Engine:
    """A program with its numbers. Not thread-safe; ImportError without numpy."""

    def __init__(self, nodes: Sequence[NodeSpec], program: Program) -> None:
        # numbers of the outputs and of the observable nodes; evidence goes by position in these
        self.outputs, self.observable = program.outputs, program.observable
        # observable node -> its position
        self.positions = {node: k for k, node in enumerate(self.observable)}
        # "not observed" for each of them: the number of its states
        self.missing = tuple(len(nodes[node].states) for node in self.observable)
        place = {node: k for k, node in enumerate(self.outputs)}
        self._parts: list[_Inference] = []
        for part in program.parts:
            slots = tuple(
                _Slot(place.get(node, -1), self.positions.get(node, -1), len(nodes[node].states))
                for node in part.outputs
            )
            running = part.made.running(self.positions, self.missing)
            self._parts.append(_Inference(running, frozenset(part.inputs), slots, part.least))

    def infer(self, states: States, weights: Weights = _NO_WEIGHTS) -> Posteriors | None:
        """Return the posterior of each output, None if the evidence has probability zero.

        Virtual evidence is a state ``missing``, and likelihoods of which the largest is 1.
        """
        posteriors: Posteriors = [[]] * len(self.outputs)
        for running, positions, slots, least in self._parts:
            soft = weights and not positions.isdisjoint(weights)
            rows = running.soft(states, weights) if soft else running.hard(states)
            for k, slot in enumerate(slots):
                row = rows[k]
                if slot.position >= 0:
                    row = _weighted(row, slot, states, weights)
                total = sum(row)
                if total < _TINY:
                    likelihoods = [weights[k] for k in positions.intersection(weights)]
                    smallest = [min(p for p in weight if p > 0.0) for weight in likelihoods]
                    if least + sum(map(math.log2, smallest)) <= _LEAST_EXPONENT:
                        rare = running.scaled(states, weights)[k]
                        row = _weighted(rare, slot, states, weights)
                        total = sum(row)
                    if not total:
                        return None
                if slot.output >= 0:
                    posteriors[slot.output] = [number / total for number in row]
        return posteriors


def _weighted(
    row: Sequence[float], slot: _Slot, states: States, weights: Weights
) -> Sequence[float]:
    position = slot.position
    if position < 0:
        return row
    if position in weights:
        return [number * other for number, other in zip(row, weights[position])]
    state = states[position]
    if state == slot.card:
        return row
    return [number if k == state else 0.0 for k, number in enumerate(row)]
