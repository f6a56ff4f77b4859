"""Larger parts of a network: a fixed list of numpy operations on arrays of the runtime.

No number is touched: ``eddi_runtime.bayesian_network.arrays`` makes the arrays when the monitor
starts, as the rows here describe it. The axes of each message are ordered so that few copies are
needed: a product sums over axes that both parts have (``summed``), keeps others of both
(``batch``), and has axes of the one or the other part only (``left``, ``right``). Numpy multiplies
such arrays without a copy when each group of axes is adjacent, so each message is laid out as its
first reader wants it, going backwards from the outputs.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import NamedTuple

from eddi_scaffold.kinds.bayesian_network.clique_tree import EVIDENCE, TABLE
from eddi_scaffold.kinds.bayesian_network.message_passing import Edge, Message, Program, alias_of
from eddi_scaffold.kinds.bayesian_network.structure import bits
from eddi_scaffold.kinds.bayesian_network.width import Plan

Slot = tuple[object, ...]
Axes = tuple[int, ...]
_GEMV, _GEMM = 9_000, 200_000
"""Multiplications of a product with a vector, or a matrix, from which OpenBLAS uses threads."""


class MessageRow(NamedTuple):
    """A message as the runtime's ``Message`` describes it."""

    kind: str
    parts: tuple[int, ...]
    nodes: tuple[int, ...]
    inputs: tuple[int, ...]
    known: bool


class Operation(NamedTuple):
    """One call of numpy: its name, its operands as text, and their slots.

    Attributes:
        message: number of the message that needs it.
        function: name in numpy.
        operands: text of each, the name of a slot and perhaps ``[`` case ``]``.
        nodes: that the result has an axis for.
    """

    message: int
    function: str
    operands: tuple[str, ...]
    nodes: tuple[int, ...]


@dataclass
class Steps:
    """The operations of a step.

    Attributes:
        slots: how each array is made.
        names: of the slots in the text.
        cases: variable -> (position in the states, factor) for each input that it counts.
        operations: in the order of the step.
        rows: text of the row of each output.
    """

    slots: list[Slot] = field(default_factory=list)
    names: list[str] = field(default_factory=list)
    cases: dict[str, list[tuple[int, int]]] = field(default_factory=dict)
    operations: list[Operation] = field(default_factory=list)
    rows: list[str] = field(default_factory=list)


def message_rows(plan: Plan) -> tuple[MessageRow, ...]:
    """Return the messages of a plan by number."""
    numbers = {edge: k for k, edge in enumerate(plan.program.messages)}
    in_tables = {leaf.node for leaf in plan.tree.leaves if leaf.kind == TABLE}
    rows = []
    for edge, message in plan.program.messages.items():
        parts = tuple(numbers[part] for part in message.parts)
        kind = message.kind or "product"
        if not message.parts:
            leaf = plan.tree.leaves[message.leaf]
            if leaf.kind == TABLE:
                parts = (leaf.node,)
            elif leaf.kind == EVIDENCE and leaf.node not in in_tables:
                kind = "prior"
        known = not message.inputs or edge in plan.program.tabulated or not message.parts
        seen = message.inputs & ~message.mask if kind == TABLE else message.inputs
        inputs = tuple(bits(seen)) if known else ()
        rows.append(MessageRow(kind, parts, tuple(bits(message.mask)), inputs, known))
    return tuple(rows)


def answers_of(plan: Plan) -> tuple[int, ...]:
    """Return the number of the message of each output, or of those of the evidence alone."""
    program, numbers = plan.program, {edge: k for k, edge in enumerate(plan.program.messages)}
    wanted = [program.answers[node] for node in plan.part.outputs] or program.evidence
    return tuple(numbers[edge] for edge in wanted)


def steps_of(
    program: Program,
    cards: Sequence[int],
    positions: Mapping[int, int],
    *,
    look_up: bool = False,
    adapting: bool = False,
) -> Steps:
    """Return the operations of a program.

    Args:
        program: the messages.
        cards: number of states of each node.
        positions: node -> its place in the states.
        look_up: tabulated messages are looked up; else each input has a vector.
        adapting: shapes are told as nodes, because an observed node will have no axis.
    """
    return _Making(program, cards, positions, look_up=look_up, adapting=adapting).steps


class _Making:
    def __init__(
        self,
        program: Program,
        cards: Sequence[int],
        positions: Mapping[int, int],
        *,
        look_up: bool,
        adapting: bool,
    ) -> None:
        self._program, self._messages = program, program.messages
        self._cards, self._positions, self._look_up = cards, positions, look_up
        self._adapting = adapting
        self._numbers = {edge: k for k, edge in enumerate(program.messages)}
        self._resolve = self._aliases()
        operations = self._needed()
        self._order = layouts(operations, self._messages, self._resolve)
        self.steps = Steps()
        self._cases: dict[int, str] = {}
        self._forms: dict[tuple[Edge, tuple[Axes, ...]], str] = {}
        self._results: dict[Edge, str] = {}
        for message in operations:
            self._operation(message)
        self.steps.rows = [self._row(program.answers[node]) for node in sorted(program.answers)]
        if program.evidence:
            first, *rest = (self._resolve[edge] for edge in program.evidence)
            axes = (tuple(bits(self._messages[first].mask)),)
            one = self._form(first, axes)
            other = (
                self._form(rest[0], axes) if rest else self._slot("o", "ones", self._size(axes[0]))
            )
            self.steps.rows = [f"[float(dot({one}, {other}))]"]

    def _aliases(self) -> dict[Edge, Edge]:
        found: dict[Edge, Edge] = {}
        for edge, message in self._messages.items():
            same = None if self._looked_up(edge) else alias_of(self._messages, message)
            found[edge] = edge if same is None else found[same]
        return found

    def _looked_up(self, edge: Edge) -> bool:
        return self._look_up and edge in self._program.tabulated

    def _needed(self) -> list[Message]:
        wanted: set[Edge] = set()
        todo = [*self._program.answers.values(), *self._program.evidence]
        while todo:
            edge = self._resolve[todo.pop()]
            if edge in wanted or not self._messages[edge].inputs or self._looked_up(edge):
                continue
            wanted.add(edge)
            todo += self._messages[edge].parts
        return [
            message for edge, message in self._messages.items() if edge in wanted and message.parts
        ]

    def _operation(self, message: Message) -> None:
        edge, axes = message.edge, self._order[message.edge]
        single = _single(axes)
        parts = [self._resolve[part] for part in message.parts]
        settled = {part: self._order[part] for part in parts if part in self._results}
        batch, left, right, summed = groups_of(message, self._messages, parts, axes, settled)
        self._results[edge] = result = self._slot("r", "result", self._shape(single))
        if not summed:
            forms = [
                # one group per axis of the result, empty where the part has no such axis
                self._form(
                    part,
                    tuple((n,) if self._messages[part].mask >> n & 1 else () for n in axes),
                )
                for part in parts
            ]
            self._emit(edge, "multiply", forms, result, axes)
        elif not batch:
            first, second = (left, summed), (summed, right)
            if not left or (right and axes[0] in right):  # the result lies the other way round
                parts.reverse()
                first, second = (right, summed), (summed, left)
            forms = [
                self._form(part, tuple(group for group in groups if group))
                for part, groups in zip(parts, (first, second), strict=True)
            ]
            merged = tuple(group for group in (first[0], second[1]) if group)
            work = self._size(summed) * self._size(second[1])
            chunk = (_GEMM if second[1] else _GEMV) // work
            flat = self._reshaped(result, single, merged)
            self._emit_sliced(edge, "dot", forms, flat, merged, 0, chunk, axes)
        else:
            forms = [
                self._form(parts[0], (batch, left, summed)),
                self._form(parts[1], (batch, summed, right)),
            ]
            groups = (batch, left, right)
            view = self._view(result, axes, groups)
            assert view is not None, "its axes lie as the product wants them"
            work = self._size(summed) * self._size(right)
            chunk = (_GEMM if right else _GEMV) // work
            self._emit_sliced(edge, "matmul", forms, view, groups, 1, chunk, axes)

    def _emit_sliced(
        self,
        edge: Edge,
        function: str,
        forms: Sequence[str],
        result: str,
        groups: Sequence[Axes],
        axis: int,
        chunk: int,
        nodes: Axes,
    ) -> None:
        """Emit a product in pieces that are too small for several threads.

        A thread that is not scheduled at once costs milliseconds, now and then.
        """
        count = self._size(groups[axis]) if len(groups) > axis else 1
        if self._adapting or not 0 < chunk < count:
            self._emit(edge, function, forms, result, nodes)
            return
        for start in range(0, count, chunk):
            piece = (axis, start, min(start + chunk, count))
            name, bracket, case = forms[0].partition("[")
            part = self._slot(name[0], "piece", self._number(name), *piece)
            target = self._slot("v", "piece", self._number(result), *piece)
            self._emit(edge, function, [f"{part}{bracket}{case}", forms[1]], target, nodes)

    def _emit(
        self, edge: Edge, function: str, forms: Sequence[str], result: str, nodes: Axes
    ) -> None:
        number = self._numbers[edge]
        self.steps.operations.append(Operation(number, function, (*forms, result), nodes))

    def _form(self, edge: Edge, groups: tuple[Axes, ...]) -> str:
        """Return the text of a message whose axes are merged to groups, copied if it must be."""
        key = edge, groups
        if key not in self._forms:
            self._forms[key] = self._new_form(edge, groups)
        return self._forms[key]

    def _new_form(self, edge: Edge, groups: tuple[Axes, ...]) -> str:
        message, number = self._messages[edge], self._numbers[edge]
        nodes, shape = tuple(bits(message.mask)), self._shape(groups)
        if not message.inputs or (self._adapting and message.kind == TABLE):
            return self._slot("k", "constant", number, _turned(nodes, groups), shape)
        if self._looked_up(edge):
            inputs = tuple(-1 - node for node in bits(message.inputs))
            order = _turned((*inputs, *nodes), (inputs, *groups))
            case = self._case(message)
            return f"{self._slot('t', 'cases', number, order, shape)}[{case}]"
        if message.kind == EVIDENCE:
            return self._slot("e", "evidence", nodes[0], shape)
        result, order = self._results[edge], self._order[edge]
        view = self._view(result, order, groups)
        if view is not None:
            return view
        single = _single(axes := tuple(node for group in groups for node in group))
        sizes = self._shape(single)
        copy = self._slot("c", "result", sizes)
        turned = self._slot("v", "view", self._number(result), _turned(order, groups), sizes)
        if self._adapting:  # without the axes of observed nodes it is mostly no copy
            operands = turned, self._slot("o", "ones", 1), copy
            self.steps.operations.append(Operation(number, "multiply", operands, axes))
        else:
            self.steps.operations.append(Operation(number, "copyto", (copy, turned), axes))
        return self._reshaped(copy, single, groups)

    def _view(self, result: str, order: Axes, groups: tuple[Axes, ...]) -> str | None:
        """Return a result with merged axes; None if the numbers lie otherwise in memory."""
        place = {node: k for k, node in enumerate(order)}
        for group in groups:
            if any(place[b] != place[a] + 1 for a, b in itertools.pairwise(group)):
                return None
        if groups == _single(order):
            return result
        turned = _turned(order, groups)
        return self._slot("v", "view", self._number(result), turned, self._shape(groups))

    def _reshaped(self, name: str, old: tuple[Axes, ...], new: tuple[Axes, ...]) -> str:
        if old == new:
            return name
        turned = tuple(range(len(old)))
        return self._slot("v", "view", self._number(name), turned, self._shape(new))

    def _shape(self, groups: tuple[Axes, ...]) -> tuple[object, ...]:
        return groups if self._adapting else tuple(map(self._size, groups))

    def _case(self, message: Message) -> str:
        """Return the variable with the number of the case of some inputs."""
        if message.inputs not in self._cases:
            terms, stride = [], 1
            for node in reversed(list(bits(message.inputs))):
                terms.append((self._positions[node], stride))
                stride *= self._program.cases[node]
            name = self._cases[message.inputs] = f"i{len(self._cases)}"
            self.steps.cases[name] = terms
        return self._cases[message.inputs]

    def _row(self, edge: Edge) -> str:
        edge = self._resolve[edge]
        message, number = self._messages[edge], self._numbers[edge]
        if self._looked_up(edge):
            case = self._case(message)
            return f"{self._slot('t', 'rows', number)}[{case}]"
        if not message.inputs:
            return self._slot("k", "row", number)
        return f"{self._form(edge, (tuple(bits(message.mask)),))}.tolist()"

    def _size(self, group: Axes) -> int:
        return math.prod(self._cards[node] for node in group)

    def _slot(self, letter: str, *row: object) -> str:
        name = f"{letter}{len(self.steps.slots)}"
        self.steps.slots.append(row)
        self.steps.names.append(name)
        return name

    def _number(self, name: str) -> int:
        return int(name[1:])


def _single(axes: Axes) -> tuple[Axes, ...]:
    return tuple((node,) for node in axes)


def _turned(axes: Axes, groups: Sequence[Axes]) -> tuple[int, ...]:
    """Return the order of axes that puts them in the order of the groups."""
    places = {node: place for place, node in enumerate(axes)}
    return tuple(places[node] for group in groups for node in group)


class Groups(NamedTuple):
    """The axes of a product; see the module."""

    batch: Axes
    left: Axes
    right: Axes
    summed: Axes


def layouts(
    operations: Sequence[Message],
    messages: Mapping[Edge, Message],
    resolve: Mapping[Edge, Edge],
) -> dict[Edge, Axes]:
    """Return the order of axes of each operation's result, slowest first.

    Args:
        operations: the products that are computed in each step, each behind its parts.
        messages: all messages.
        resolve: part -> the message that it is equal to.
    """
    computed = {operation.edge for operation in operations}
    order: dict[Edge, Axes] = {}
    for message in reversed(operations):
        wish = order.get(message.edge, tuple(bits(message.mask)))
        parts = [resolve[part] for part in message.parts]
        groups = groups_of(message, messages, parts, wish, order)
        if groups.summed and not _adjacent(wish, groups):
            wish = groups.batch + groups.left + groups.right
        order[message.edge] = wish
        for part, own in zip(parts, (groups.left, groups.right), strict=False):
            if part in computed and part not in order:
                both = (*groups.batch, *own, *groups.summed)
                kept = set(bits(messages[part].mask))
                order[part] = both if groups.summed else tuple(n for n in wish if n in kept)
    return order


def groups_of(
    message: Message,
    messages: Mapping[Edge, Message],
    parts: Sequence[Edge],
    wish: Axes,
    order: Mapping[Edge, Axes],
) -> Groups:
    """Return the groups of a product, each in the order of its result or of its parts.

    Args:
        message: the product.
        messages: all messages.
        parts: its two parts.
        wish: order of the axes of the result.
        order: orders that are settled.
    """
    one, other = (messages[part].mask for part in parts)
    summed = one & other & ~message.mask
    inside: list[int] = list(bits(summed))
    for part in parts:
        if part in order:
            inside = [node for node in order[part] if summed >> node & 1]
            break
    return Groups(
        batch=tuple(node for node in wish if (one & other) >> node & 1),
        left=tuple(node for node in wish if (one & ~other) >> node & 1),
        right=tuple(node for node in wish if (other & ~one) >> node & 1),
        summed=tuple(inside),
    )


def _adjacent(wish: Axes, groups: Groups) -> bool:
    places = {node: place for place, node in enumerate(wish)}
    for group in (groups.batch, groups.left, groups.right):
        where = [places[node] for node in group]
        if where and max(where) - min(where) != len(where) - 1:
            return False
    return True
