"""Exact inference by what was compiled: evidence in, posteriors of the outputs out."""

from __future__ import annotations

import math
from operator import eq
from typing import Any, Iterable, List, Mapping, NamedTuple, Optional, Sequence, Tuple

Rows = Sequence[Sequence[float]]
States = Sequence[int]
Weights = Mapping[int, Sequence[float]]
Posteriors = List[List[float]]
Cases = Mapping[Tuple[int, ...], Optional[Rows]]

_TINY = 1e-200  # a sum below this may have lost terms to underflow
_LEAST_EXPONENT = -900
"""Powers of two down to which a product stays an exact double, with some room."""
_NO_WEIGHTS: Weights = {}
_NO_CASES: Cases = {}


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
    # nodes whose rows it gives; empty for the probability of the evidence alone
    outputs: tuple[int, ...]
    least: int  # lower bound of the exponent of any product of its non-zero probabilities


class Program(NamedTuple):
    """Inference for some outputs and observable nodes."""

    outputs: tuple[int, ...]  # nodes whose posteriors can be asked for, ascending
    # nodes that may be observed, ascending; evidence goes by position here
    observable: tuple[int, ...]
    parts: tuple[Part, ...]  # all that can matter
    # in place of them in steps in which each observable node is observed
    when_observed: tuple[Part, ...] = ()
    # states -> posteriors, where there are few; None: they are impossible
    cases: Cases = _NO_CASES


class _Slot(NamedTuple):
    """Where the row of an output goes."""

    output: int  # its place among the outputs, -1 for the probability of the evidence alone
    position: int  # its place among the observable nodes, -1 if it is none
    card: int  # number of its states


class _Inference(NamedTuple):
    """What infers one part, the positions of its inputs, and where its rows go."""

    running: Any
    positions: frozenset[int]
    slots: tuple[_Slot, ...]
    least: int


class Engine:
    """A program with its numbers, or a part of it. Not thread-safe; ImportError without numpy."""

    def __init__(
        self,
        nodes: Sequence[NodeSpec],
        program: Program,
        outputs: Iterable[int] | None = None,
        observable: Iterable[int] | None = None,
    ) -> None:
        self._nodes, self.program = nodes, program
        # numbers of the outputs, ascending
        self.outputs = program.outputs if outputs is None else tuple(sorted(outputs))
        # numbers of the observable nodes, ascending; evidence goes by position here
        self.observable = program.observable if observable is None else tuple(sorted(observable))
        # observable node -> its position
        self.positions = {node: k for k, node in enumerate(self.observable)}
        # "not observed" for each of them: the number of its states
        self.missing = tuple(len(nodes[node].states) for node in self.observable)
        self._cards = {k: (p, len(nodes[k].states)) for p, k in enumerate(program.observable)}
        self._all_missing = [card for _, card in self._cards.values()]
        self._places: list[int] | None = None
        if self.observable != program.observable:
            self._places = [self._cards[node][0] for node in self.observable]
        made: dict[int, _Inference] = {}
        for part in (*program.parts, *program.when_observed):
            if id(part) not in made:
                made[id(part)] = self._inference(part)
        self._parts = [made[id(part)] for part in program.parts]
        self._when_observed = [made[id(part)] for part in program.when_observed]

    def infer(self, states: States, weights: Weights = _NO_WEIGHTS) -> Posteriors | None:
        """Return the posterior of each output, None if the evidence has probability zero.

        Virtual evidence is a state ``missing``, and likelihoods of which the largest is 1.
        """
        places = self._places
        if places is not None:
            mine, states = states, list(self._all_missing)
            for place, state in zip(places, mine):
                states[place] = state
            weights = {places[position]: weight for position, weight in weights.items()}
        parts = self._parts
        if self._when_observed and not weights and True not in map(eq, states, self._all_missing):
            parts = self._when_observed
        posteriors: Posteriors = [[]] * len(self.outputs)
        for running, positions, slots, least in parts:
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

    def _inference(self, part: Part) -> _Inference:
        wanted = [k for k, node in enumerate(part.outputs) if node in self.outputs]
        if part.outputs and not wanted:
            wanted = [0]  # any of them tells whether the evidence is possible
        slots = [_Slot(-1, -1, 1)] if not wanted else []
        for node in [part.outputs[k] for k in wanted]:
            place = self.outputs.index(node) if node in self.outputs else -1
            card = len(self._nodes[node].states)
            slots.append(_Slot(place, self._cards.get(node, (-1, card))[0], card))
        running = part.made.running(self._cards, wanted)
        return _Inference(running, frozenset(part.inputs), tuple(slots), part.least)


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
