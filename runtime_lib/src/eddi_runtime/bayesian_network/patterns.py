"""Wide parts of a network: arrays in which a node that is observed has no axis.

Which inputs are observed, missing or have likelihoods is a pattern. Its arrays are made when it
comes for the second time, as when a sensor fails, and kept.
"""

from __future__ import annotations

import math
from operator import eq, itemgetter
from typing import Any, Callable, Collection, Mapping, NamedTuple, Sequence, Tuple

from .engine import Posteriors, States, Weights
from .schedule import Schedule, Steps

_REMEMBERED = 256  # patterns that are known at most
_GEMV = 9_000
"""Multiplications of a product with a vector from which OpenBLAS uses threads, which may wait."""

Pattern = Tuple[Tuple[bool, ...], Tuple[int, ...]]
"""Which inputs are not observed, and the positions of those that have likelihoods."""
Step = Callable[[States, Weights], Posteriors]
Cards = Mapping[int, Tuple[int, int]]
"""Observable node -> its position, and the number of its states."""
Nodes = Collection[int]


class Adapted(NamedTuple):
    """A wide part with operations that are fewer the more inputs are observed."""

    # for a pattern that comes for the first time, or has too few observed inputs
    schedule: Schedule
    messages: tuple[tuple[Any, ...], ...]  # fields of ``arrays.Message``, each behind its parts
    steps: Steps  # the operations; shapes are told as nodes, a tuple for each axis
    inputs: tuple[int, ...]  # nodes that have no axis where they are observed
    limit: int  # multiplications up to which it is faster than the schedule

    def running(self, cards: Cards, wanted: Sequence[int]) -> Patterns:
        return Patterns(self, cards, wanted)


class Patterns:
    """The inference of a wide part, see ``Running``. Not thread-safe: results stay in place."""

    def __init__(self, made: Adapted, cards: Cards, wanted: Sequence[int]) -> None:
        from .arrays import Numbers  # noqa: PLC0415 - numpy takes 0.1 s and 25 MB

        self.made, self.cards, self._wanted = made, cards, wanted
        self._any = made.schedule.running(cards, wanted)
        self.scaled = self._any.scaled
        self.numbers = Numbers(made.schedule.nodes, made.messages)
        self._own = itemgetter(*[cards[node][0] for node in made.inputs])
        self._missing = [cards[node][1] for node in made.inputs]
        self._met: set[Pattern] = set()
        self._steps: dict[Pattern, Step] = {}
        # numbers that do not change, of all patterns; what is new is added
        self.shared: dict[tuple[int, ...], Any] = {}

    def hard(self, states: States) -> Posteriors:
        return self.soft(states, {})

    def soft(self, states: States, weights: Weights) -> Posteriors:
        pattern = tuple(map(eq, self._own(states), self._missing)), tuple(weights)
        step = self._steps.get(pattern)
        if step is None:
            step = self._any.soft
            if pattern in self._met:
                step = self._steps[pattern] = self._step(pattern)
            elif len(self._met) == _REMEMBERED:
                self._met.clear()
                self._steps.clear()
            self._met.add(pattern)
        return step(states, weights)

    def _step(self, pattern: Pattern) -> Step:
        missing, weighted = pattern
        made, nodes = self.made, self.made.schedule.nodes
        observed = {node for node, absent in zip(made.inputs, missing) if not absent}
        sizes = {
            node: 1 if node in observed else len(rows[0]) for node, (_, rows) in nodes.items()
        }
        work = 0
        for number, *_ in made.steps.operations:
            parts = [made.messages[part][2] for part in made.messages[number][1]]
            work += math.prod(sizes[node] for node in {*parts[0], *parts[1]})
        if work > made.limit:
            return self._any.soft
        absent = {node for node in made.inputs if self.cards[node][0] not in weighted} - observed
        return _Arrays(self, sizes, observed, absent).step(self._wanted)


class _Arrays:
    """The arrays of a pattern: states of ``observed`` nodes select numbers, they have no axis."""

    def __init__(
        self, of: Patterns, sizes: Mapping[int, int], observed: Nodes, absent: Nodes
    ) -> None:
        import numpy as np  # noqa: PLC0415 - as above

        self._numbers, self._steps, self._cards = of.numbers, of.made.steps, of.cards
        self._sizes, self._observed, self._absent = sizes, observed, absent
        self._shared, self._numpy = of.shared, np
        self._slots: dict[int, Any] = {}
        self._home: dict[int, int] = {}  # slot -> the one whose memory it is
        self._changing: set[int] = set()  # of these, those that are written in each step
        self._chosen: dict[int, tuple[int, Any]] = {}  # axes of cases before it, what chooses
        self._vectors: list[tuple[int, int, Any]] = []
        self._operations: list[tuple[Any, int, int, int]] = []
        for _, name, left, other, out in self._steps.operations:
            self._operation(name, left, other, out)

    def step(self, wanted: Sequence[int]) -> Step:
        answers = [self._steps.answers[k] for k in wanted]
        used = {*answers, *(k for _, *places in self._operations for k in places)}
        chosen = [
            (k, choose, self._slot(k)) for k, (_, choose) in self._chosen.items() if k in used
        ]
        operations, slots = self._operations, {k: self._slot(k) for k in used}
        vectors, vector = self._vectors, self._numbers.vector

        def step(states: States, weights: Weights) -> Posteriors:
            for node, position, array in vectors:
                array[:] = vector(node, position, states, weights)
            for slot, choose, cases in chosen:
                slots[slot] = cases[choose(states)]
            for function, left, other, out in operations:
                function(slots[left], slots[other], slots[out])
            return [slots[answer].tolist() for answer in answers]

        return step

    def _operation(self, name: str, left: int, other: int, out: int) -> None:
        """Add an operation, or do it at once where nothing in it changes from step to step."""
        first, second = self._slot(left), self._slot(other)
        if self._is_one(other) and self._same(left, out):
            return
        if self._is_one(left) and self._same(other, out):
            return
        result, function = self._slot(out), getattr(self._numpy, name)
        if self._fixed(left) and self._fixed(other):
            function(first, second, result)
            return
        self._changing.add(self._home[out])
        rows, length = result.size, first.shape[-1]
        if name == "matmul" and len(result) == 1 and result.flags.c_contiguous:
            # a single product of matrices, which dot writes only where numbers lie in order
            left, other, out = (self._like(k, self._own(k)[1:]) for k in (left, other, out))
            function = self._numpy.dot
        elif self._own(left) == (rows, length) and rows * length > _GEMV and name == "dot":
            divisors = (k for k in range(1, rows) if not rows % k)
            pieces = next((k for k in divisors if rows * length <= k * _GEMV), rows)
            left = self._like(left, (pieces, rows // pieces, length))
            other, out = self._like(other, (length, 1)), self._like(out, (pieces, -1, 1))
            function = self._numpy.matmul
        self._operations.append((function, left, other, out))

    def _fixed(self, slot: int) -> bool:
        return slot not in self._chosen and self._home[slot] not in self._changing

    def _is_one(self, slot: int) -> bool:
        array = self._slots[slot]
        return array.size == 1 and self._fixed(slot) and array.item() == 1.0

    def _same(self, kept: int, out: int) -> bool:
        """Let a product by one be the other operand; return whether its numbers lie in order."""
        while self._steps.slots[out][0] == "view":
            out = self._steps.slots[out][1]
        array = self._slots[kept]
        if not array.flags.c_contiguous:
            return False
        self._add(out, self._reshaped(kept, self._shape(self._steps.slots[out][1])), kept)
        return True

    def _own(self, slot: int) -> Any:
        return self._slots[slot].shape[self._cases(slot) :]

    def _cases(self, slot: int) -> int:
        return self._chosen[slot][0] if slot in self._chosen else 0

    def _like(self, slot: int, shape: Sequence[int]) -> int:
        return self._add(-1 - len(self._slots), self._reshaped(slot, shape), slot)

    def _reshaped(self, slot: int, shape: Sequence[int]) -> Any:
        array = self._slots[slot]
        return array.reshape([*array.shape[: self._cases(slot)], *shape])

    def _add(self, slot: int, array: Any, like: int | None = None) -> int:
        self._slots[slot] = array
        self._home[slot] = slot if like is None else self._home[like]
        if like in self._chosen:
            self._chosen[slot] = self._chosen[like]
        return slot

    def _shape(self, groups: Sequence[Sequence[int]]) -> list[int]:
        return [math.prod(self._sizes[node] for node in group) for group in groups]

    def _slot(self, slot: int) -> Any:
        """Return an array as ``Steps`` describes it; chosen ones have axes of cases before."""
        if slot not in self._slots:
            self._make(slot, *self._steps.slots[slot])
        return self._slots[slot]

    def _make(self, slot: int, kind: str, source: Any, *rest: Any) -> None:
        if kind == "result":
            self._add(slot, self._numpy.zeros(self._shape(source)))
        elif kind == "ones":
            self._add(slot, self._numpy.ones(source))
        elif kind == "view":
            whole = self._slot(source)
            cases = self._cases(source)
            turned = whole.transpose([*range(cases), *(cases + k for k in rest[0])])
            view = turned.reshape([*whole.shape[:cases], *self._shape(rest[1])])
            assert self._numpy.shares_memory(view, whole)
            self._add(slot, view, source)
        elif kind == "evidence":
            self._evidence(slot, source, self._shape(rest[0]))
        else:
            order, groups = rest
            nodes = [self._numbers.messages[source].nodes[k] for k in order]
            seen = [k for k, node in enumerate(nodes) if node in self._observed]
            key = (slot, *seen)
            if key not in self._shared:
                first = [*seen, *(k for k in range(len(nodes)) if k not in seen)]
                turned = self._numbers.known[source].transpose(order).transpose(first)
                shape = [*turned.shape[: len(seen)], *self._shape(groups)]
                self._shared[key] = turned.reshape(shape).copy()
            self._add(slot, self._shared[key])
            places = [self._cards[nodes[k]][0] for k in seen]
            if places:
                self._chosen[slot] = len(places), itemgetter(*places)

    def _evidence(self, slot: int, node: int, shape: Sequence[int]) -> None:
        position = self._cards[node][0]
        vector = self._numpy.array(self._numbers.rows[node][-1])
        if node not in self._observed:
            self._add(slot, vector.reshape(shape))
            if node not in self._absent:
                self._changing.add(slot)
                self._vectors.append((node, position, vector))
        elif (vector == 1.0).all():
            self._add(slot, self._numpy.ones(shape))
        else:
            self._add(slot, vector.reshape([-1, *shape]))
            self._chosen[slot] = 1, itemgetter(position)
