"""Exact inference by what was compiled: evidence in, posteriors of the outputs out."""

from __future__ import annotations

import math
from operator import eq
from typing import (
    TYPE_CHECKING,
    Dict,
    FrozenSet,
    Iterable,
    List,
    NamedTuple,
    Optional,
    Sequence,
    Tuple,
    Union,
)

from .joint import JointTables
from .program import NodeSpec, Part, Posteriors, Program, States, Tables, Weights

if TYPE_CHECKING:
    from .schedule import Running

_TINY = 1e-200
"""A sum below this may have lost terms to underflow."""
_LEAST_EXPONENT = -900
"""Powers of two down to which a product stays an exact double, with some room."""
_NO_WEIGHTS: Weights = {}


class _Slot(NamedTuple):
    """Where the row of an output goes.

    Attributes:
        output: its place among the outputs, -1 for the probability of the evidence alone.
        position: its place among the observable nodes, -1 if it is none.
        card: number of its states.
    """

    output: int
    position: int
    card: int


class _Made(NamedTuple):
    running: Union[JointTables, Running]
    positions: FrozenSet[int]
    slots: Tuple[_Slot, ...]
    least: int


class Engine:
    """A program with its numbers, or a part of it. Not thread-safe.

    Which of the observable nodes are observed may differ from step to step.

    Args:
        nodes: of the network.
        program: what was compiled.
        outputs: those that are wanted; None: all of the program.
        observable: those that may be observed; None: all of the program.

    Attributes:
        nodes: of the network.
        program: what was compiled.
        outputs: numbers of the outputs, ascending.
        observable: numbers of the observable nodes, ascending; evidence goes by position here.
        missing: "not observed" for each of them: the number of its states.

    Raises:
        ImportError: a part needs numpy and it is not installed.
    """

    def __init__(
        self,
        nodes: Sequence[NodeSpec],
        program: Program,
        outputs: Optional[Iterable[int]] = None,
        observable: Optional[Iterable[int]] = None,
    ) -> None:
        self.nodes, self.program = nodes, program
        self.outputs = program.outputs if outputs is None else tuple(sorted(outputs))
        self.observable = program.observable if observable is None else tuple(sorted(observable))
        self.missing = tuple(len(nodes[node].states) for node in self.observable)
        self._all_missing = [len(nodes[node].states) for node in program.observable]
        self._positions = {node: k for k, node in enumerate(program.observable)}
        self._places: Optional[List[int]] = None
        if self.observable != program.observable:
            self._places = [self._positions[node] for node in self.observable]
        made: Dict[int, _Made] = {}
        for part in (*program.parts, *program.when_observed):
            if id(part) not in made:
                made[id(part)] = self._made(part, program.observable)
        self._parts = [made[id(part)] for part in program.parts]
        self._when_observed = [made[id(part)] for part in program.when_observed]
        self._alike = not self._when_observed

    def infer(self, states: States, weights: Weights = _NO_WEIGHTS) -> Optional[Posteriors]:
        """Return the posterior of each output, None if the evidence has probability zero.

        Args:
            states: state of each observable node; ``missing`` for one that is not observed, or
                that has virtual evidence.
            weights: position among the observable nodes -> one likelihood per state: finite, not
                negative, the largest 1. Not for an observed state: that is hard evidence.
        """
        places = self._places
        if places is not None:
            mine, states = states, list(self._all_missing)
            for place, state in zip(places, mine):
                states[place] = state
            weights = {places[position]: weight for position, weight in weights.items()}
        parts = self._parts
        if not (weights or self._alike) and True not in map(eq, states, self._all_missing):
            parts = self._when_observed
        found: Posteriors = [[]] * len(self.outputs)
        for part in parts:
            running, positions, slots, _ = part
            soft = bool(weights) and not positions.isdisjoint(weights)
            rows = running.soft(states, weights) if soft else running.hard(states)
            for number, slot in enumerate(slots):
                row = rows[number]
                if slot.position >= 0:
                    row = _weighted(row, slot, states, weights)
                total = sum(row)
                if total < _TINY:
                    if _may_underflow(part, weights):
                        row = running.scaled(states, weights)[number]
                        row = _weighted(row, slot, states, weights)
                        total = sum(row)
                    if not total:
                        return None
                if slot.output >= 0:
                    found[slot.output] = [one / total for one in row]
        return found

    def _made(self, part: Part, observable: Sequence[int]) -> _Made:
        wanted = [k for k, node in enumerate(part.outputs) if node in self.outputs]
        if part.outputs and not wanted:
            wanted = [0]  # any of them tells whether the evidence is possible
        slots = tuple(self._slot(part.outputs[k]) for k in wanted)
        running: Union[JointTables, Running]
        if isinstance(part.made, Tables):
            inputs = {position: self._all_missing[position] for position in part.inputs}
            running = JointTables(part.made, inputs, wanted or [0])
        else:
            from .schedule import Running  # noqa: PLC0415 - numpy takes 0.1 s and 25 MB

            positions = {node: k for k, node in enumerate(observable)}
            running = Running(part.made, positions, wanted)
        return _Made(running, frozenset(part.inputs), slots or (_Slot(-1, -1, 1),), part.least)

    def _slot(self, node: int) -> _Slot:
        place = self.outputs.index(node) if node in self.outputs else -1
        return _Slot(place, self._positions.get(node, -1), len(self.nodes[node].states))


def _weighted(
    row: Sequence[float], slot: _Slot, states: States, weights: Weights
) -> Sequence[float]:
    """Take into the row of an output what was seen of the output itself."""
    position = slot.position
    if position < 0:
        return row
    weight = weights.get(position)
    if weight is not None:
        return [one * other for one, other in zip(row, weight)]
    state = states[position]
    if state == slot.card:
        return row
    return [one if k == state else 0.0 for k, one in enumerate(row)]


def _may_underflow(part: _Made, weights: Weights) -> bool:
    """Return whether a product that is zero or tiny may be so by rounding alone."""
    least: float = part.least
    for position in part.positions.intersection(weights):
        least += math.log2(min(one for one in weights[position] if one > 0.0))
    return least <= _LEAST_EXPONENT
