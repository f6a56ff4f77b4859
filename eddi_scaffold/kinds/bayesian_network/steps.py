"""Larger parts of a network: a fixed list of numpy operations on arrays of the runtime.

No number is touched: ``eddi_runtime.bayesian_network.arrays`` makes the arrays when the monitor
starts, as the slots here describe it. The axes of each message are ordered so that few copies are
needed: a product sums over axes that both parts have (``summed``), keeps others of both
(``batch``), and has axes of the one or the other part only (``left``, ``right``). Numpy multiplies
such arrays without a copy when each group of axes is adjacent, so each message is laid out as its
first reader needs it, going backwards from the outputs.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Mapping, Sequence
from typing import NamedTuple

from eddi_scaffold.kinds.bayesian_network.clique_tree import EVIDENCE
from eddi_scaffold.kinds.bayesian_network.message_passing import Edge, Message, MessageProgram
from eddi_scaffold.kinds.bayesian_network.network import bits

Axes = tuple[int, ...]
_GEMV, _GEMM = 9_000, 200_000
"""Multiplications of a product with a vector, or a matrix, from which OpenBLAS uses threads."""


class Operation(NamedTuple):
    """One call of numpy."""

    message: int  # number of the message that needs it
    function: str  # name in numpy
    operands: tuple[str, ...]  # text of each, the name of a slot and perhaps `[` case `]`
    nodes: tuple[int, ...]  # that the result has an axis for


class Groups(NamedTuple):
    """The axes of a product; see the module."""

    batch: Axes
    left: Axes
    right: Axes
    summed: Axes


class Steps:
    """The operations of a step."""

    def __init__(
        self,
        program: MessageProgram,
        cards: Sequence[int],  # number of states of each node
        positions: Mapping[int, int],  # node -> its place in the states
        *,
        look_up: bool = False,  # tabulated messages are looked up; else each input has a vector
    ) -> None:
        self.slots: list[tuple[object, ...]] = []  # how each array is made
        self.names: list[str] = []  # of the slots in the text
        # variable -> (position in the states, factor) for each input that it counts
        self.cases: dict[str, list[tuple[int, int]]] = {}
        self.operations: list[Operation] = []  # in the order of the step
        self._program, self._messages = program, program.messages
        self._cards, self._positions = cards, positions
        self._looked_up = program.tabulated if look_up else set()
        self._numbers = {edge: k for k, edge in enumerate(program.messages)}
        self._case_of: dict[int, str] = {}
        self._forms: dict[tuple[Edge, tuple[Axes, ...]], str] = {}
        self._results: dict[Edge, str] = {}
        self._resolve: dict[Edge, Edge] = {}
        for edge, message in self._messages.items():
            same = None if edge in self._looked_up else program.alias_of(message)
            self._resolve[edge] = edge if same is None else self._resolve[same]
        needed: set[Edge] = set()
        waiting = [*program.answers.values(), *program.evidence]
        while waiting:
            edge = self._resolve[waiting.pop()]
            message = self._messages[edge]
            if message.inputs and edge not in needed and edge not in self._looked_up:
                needed.add(edge)
                waiting += message.parts
        products = [m for edge, m in self._messages.items() if edge in needed and m.parts]
        self._order = self._layouts(products)
        for message in products:
            self._multiply(message)
        # text of the row of each output
        self.rows = [self._row(program.answers[node]) for node in sorted(program.answers)]
        if program.evidence:
            first, *others = (self._resolve[edge] for edge in program.evidence)
            axes = (tuple(bits(self._messages[first].mask)),)
            row = self._form(first, axes)
            ones = "" if others else self._slot("o", "ones", self._size(axes[0]))
            self.rows = [f"[float(dot({row}, {ones or self._form(others[0], axes)}))]"]

    def _layouts(self, products: Sequence[Message]) -> dict[Edge, Axes]:
        """Return the order of axes of each product, slowest first."""
        computed = {message.edge for message in products}
        order: dict[Edge, Axes] = {}
        for message in reversed(products):
            axes = order.get(message.edge, tuple(bits(message.mask)))
            parts = [self._resolve[part] for part in message.parts]
            groups = self._groups(message, parts, axes, order)
            places = {node: place for place, node in enumerate(axes)}
            taken = [[places[node] for node in group] for group in groups[:3]]
            if groups.summed and any(g and max(g) - min(g) != len(g) - 1 for g in taken):
                axes = groups.batch + groups.left + groups.right
            order[message.edge] = axes
            for part, own in zip(parts, (groups.left, groups.right), strict=False):
                if part in computed and part not in order:
                    mask = self._messages[part].mask
                    order[part] = (
                        (*groups.batch, *own, *groups.summed)
                        if groups.summed
                        else tuple(node for node in axes if mask >> node & 1)
                    )
        return order

    def _groups(
        self, message: Message, parts: Sequence[Edge], axes: Axes, order: Mapping[Edge, Axes]
    ) -> Groups:
        """Return the groups of a product, each in the order of its result or of its parts."""
        first, second = (self._messages[part].mask for part in parts)
        mask = first & second & ~message.mask
        settled = next((order[part] for part in parts if part in order), tuple(bits(mask)))
        return Groups(
            batch=tuple(node for node in axes if (first & second) >> node & 1),
            left=tuple(node for node in axes if (first & ~second) >> node & 1),
            right=tuple(node for node in axes if (second & ~first) >> node & 1),
            summed=tuple(node for node in settled if mask >> node & 1),
        )

    def _multiply(self, message: Message) -> None:
        edge, axes = message.edge, self._order[message.edge]
        parts = [self._resolve[part] for part in message.parts]
        settled = {part: self._order[part] for part in parts if part in self._results}
        batch, left, right, summed = self._groups(message, parts, axes, settled)
        self._results[edge] = result = self._slot("r", "result", self._shape(_single(axes)))
        if not summed:
            # one group per axis of the result, empty where the part has no such axis
            masks = [self._messages[part].mask for part in parts]
            groups = [tuple((n,) if mask >> n & 1 else () for n in axes) for mask in masks]
            forms = [self._form(*pair) for pair in zip(parts, groups, strict=True)]
            self._add(edge, "multiply", [*forms, result], axes)
            return
        function, place = ("matmul", 1) if batch else ("dot", 0)
        first: tuple[Axes, ...] = (left, summed)
        second: tuple[Axes, ...] = (summed, right)
        if batch:
            first, second = (batch, *first), (batch, *second)
        elif not left or (right and axes[0] in right):  # the result lies the other way round
            parts.reverse()
            first, second = (right, summed), (summed, left)
        forms = [
            self._form(part, own if batch else tuple(group for group in own if group))
            for part, own in zip(parts, (first, second), strict=True)
        ]
        if batch:
            merged: tuple[Axes, ...] = (batch, left, right)
            view = self._view(result, axes, merged)
            assert view is not None, "its axes lie as the product needs them"
        else:
            merged = tuple(group for group in (first[0], second[1]) if group)
            view = self._reshaped(result, _single(axes), merged)
        width = second[-1]
        chunk = (_GEMM if width else _GEMV) // (self._size(summed) * self._size(width))
        count = self._size(merged[place]) if len(merged) > place else 1
        if not 0 < chunk < count:
            self._add(edge, function, [*forms, view], axes)
            return
        # In pieces that are too small for several threads: one that is not scheduled at once costs
        # milliseconds, now and then.
        name, bracket, case = forms[0].partition("[")
        for start in range(0, count, chunk):
            piece = (place, start, min(start + chunk, count))
            part = self._slot(name[0], "piece", _number(name), *piece)
            target = self._slot("v", "piece", _number(view), *piece)
            self._add(edge, function, [f"{part}{bracket}{case}", forms[1], target], axes)

    def _add(self, edge: Edge, function: str, operands: Sequence[str], nodes: Axes) -> None:
        self.operations.append(Operation(self._numbers[edge], function, tuple(operands), nodes))

    def _form(self, edge: Edge, groups: tuple[Axes, ...]) -> str:
        """Return the text of a message whose axes are merged to groups, copied if it must be."""
        key = edge, groups
        if key not in self._forms:
            self._forms[key] = self._new_form(edge, groups)
        return self._forms[key]

    def _new_form(self, edge: Edge, groups: tuple[Axes, ...]) -> str:
        message, number = self._messages[edge], self._numbers[edge]
        nodes, shape = tuple(bits(message.mask)), self._shape(groups)
        if not message.inputs:
            return self._slot("k", "constant", number, _turned(nodes, groups), shape)
        if edge in self._looked_up:
            inputs = tuple(-1 - node for node in bits(message.inputs))
            turned = _turned((*inputs, *nodes), (inputs, *groups))
            case = self._case(message)
            return f"{self._slot('t', 'cases', number, turned, shape)}[{case}]"
        if message.kind == EVIDENCE:
            return self._slot("e", "evidence", nodes[0], shape)
        result, order = self._results[edge], self._order[edge]
        view = self._view(result, order, groups)
        if view is not None:
            return view
        axes = tuple(node for group in groups for node in group)
        sizes = self._shape(_single(axes))
        copy = self._slot("c", "result", sizes)
        turned_view = self._slot("v", "view", _number(result), _turned(order, groups), sizes)
        self._add(edge, "copyto", [copy, turned_view], axes)
        return self._reshaped(copy, _single(axes), groups)

    def _view(self, result: str, order: Axes, groups: tuple[Axes, ...]) -> str | None:
        """Return a result with merged axes; None if the numbers lie otherwise in memory."""
        place = {node: k for k, node in enumerate(order)}
        for group in groups:
            if any(place[b] != place[a] + 1 for a, b in itertools.pairwise(group)):
                return None
        if groups == _single(order):
            return result
        turned = _turned(order, groups)
        return self._slot("v", "view", _number(result), turned, self._shape(groups))

    def _reshaped(self, name: str, old: tuple[Axes, ...], new: tuple[Axes, ...]) -> str:
        if old == new:
            return name
        turned = tuple(range(len(old)))
        return self._slot("v", "view", _number(name), turned, self._shape(new))

    def _shape(self, groups: tuple[Axes, ...]) -> tuple[object, ...]:
        return tuple(map(self._size, groups))

    def _case(self, message: Message) -> str:
        """Return the variable with the number of the case of some inputs."""
        if message.inputs not in self._case_of:
            terms, stride = [], 1
            for node in reversed(list(bits(message.inputs))):
                terms.append((self._positions[node], stride))
                stride *= self._program.cases[node]
            name = self._case_of[message.inputs] = f"i{len(self._case_of)}"
            self.cases[name] = terms
        return self._case_of[message.inputs]

    def _row(self, edge: Edge) -> str:
        edge = self._resolve[edge]
        message, number = self._messages[edge], self._numbers[edge]
        if edge in self._looked_up:
            case = self._case(message)
            return f"{self._slot('t', 'rows', number)}[{case}]"
        if not message.inputs:
            return self._slot("k", "row", number)
        return f"{self._form(edge, (tuple(bits(message.mask)),))}.tolist()"

    def _size(self, group: Axes) -> int:
        return math.prod(self._cards[node] for node in group)

    def _slot(self, letter: str, *row: object) -> str:
        self.names.append(f"{letter}{len(self.slots)}")
        self.slots.append(row)
        return self.names[-1]


def _number(name: str) -> int:
    return int(name[1:])


def _single(axes: Axes) -> tuple[Axes, ...]:
    return tuple((node,) for node in axes)


def _turned(axes: Axes, groups: Sequence[Axes]) -> tuple[int, ...]:
    """Return the order of axes that puts them in the order of the groups."""
    places = {node: place for place, node in enumerate(axes)}
    return tuple(places[node] for group in groups for node in group)
