"""From messages to the text of a function, and to the arrays that it works on."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Callable, Dict, List, Mapping, Optional, Sequence, Set, Tuple

import numpy as np

from .arrays import Arrays
from .graph import bits
from .layout import Axes, groups_of, layouts
from .messages import Edge, Message, Program, alias_of
from .tree import EVIDENCE

if TYPE_CHECKING:
    from .arrays import Array

Rows = List[List[float]]
States = Sequence[int]

_GEMV, _GEMM = 9_000, 200_000
"""Multiplications of a product with a vector, or a matrix, from which OpenBLAS uses threads."""


class Emission:
    """Makes the text of a function, and the arrays that it works on, from a program.

    Args:
        vectors: evidence vectors of the observable nodes, None: look tabulated messages up.
    """

    def __init__(
        self,
        program: Program,
        cards: Sequence[int],
        arrays: Arrays,
        positions: Mapping[int, int],
        vectors: Optional[Dict[int, Array]],
    ) -> None:
        self._messages = program.messages
        self._program = program
        self._cards = cards
        self._arrays = arrays
        self._positions = positions
        self._vectors = vectors
        self._resolve = self._aliases()
        operations = self._needed()
        self._order = layouts(operations, self._messages, self._resolve)
        self._lines = ["def step(s):"]
        self._names: Dict[str, Any] = {
            "__builtins__": {"float": float},
            "dot": np.dot,
            "matmul": np.matmul,
            "multiply": np.multiply,
            "copyto": np.copyto,
        }
        self._cases: Dict[int, str] = {}
        self._forms: Dict[Tuple[Edge, Tuple[Axes, ...]], str] = {}
        self._results: Dict[Edge, Array] = {}
        for message in operations:
            self._operation(message)

    def compile(self) -> Callable[[States], Rows]:
        """Return the function."""
        program = self._program
        rows = [self._row(program.answers[node]) for node in sorted(program.answers)]
        if program.evidence:
            first, *rest = (self._resolve[edge] for edge in program.evidence)
            axes = (tuple(bits(self._messages[first].mask)),)
            one = self._form(first, axes)
            self._names["ones"] = np.ones(int(np.prod([self._cards[n] for n in axes[0]])))
            rows = [f"[float(dot({one}, {self._form(rest[0], axes) if rest else 'ones'}))]"]
        text = "\n".join([*self._lines, f"    return [{', '.join(rows)}]"])
        exec(compile(text, "<Bayesian network>", "exec"), self._names)  # noqa: S102 - our own text
        step: Callable[[States], Rows] = self._names["step"]
        return step

    def _aliases(self) -> Dict[Edge, Edge]:
        found: Dict[Edge, Edge] = {}
        for edge, message in self._messages.items():
            same = None if self._looked_up(edge) else alias_of(self._messages, message)
            found[edge] = edge if same is None else found[same]
        return found

    def _looked_up(self, edge: Edge) -> bool:
        return self._vectors is None and edge in self._arrays.tables

    def _needed(self) -> List[Message]:
        wanted: Set[Edge] = set()
        todo = [*self._program.answers.values(), *self._program.evidence]
        while todo:
            edge = self._resolve[todo.pop()]
            if edge in wanted or edge in self._arrays.constants or self._looked_up(edge):
                continue
            wanted.add(edge)
            todo += self._messages[edge].parts
        return [one for edge, one in self._messages.items() if edge in wanted and one.parts]

    def _operation(self, message: Message) -> None:
        edge, axes = message.edge, self._order[message.edge]
        result = np.zeros([self._cards[node] for node in axes])
        self._results[edge] = result
        parts = [self._resolve[part] for part in message.parts]
        settled = {part: self._order[part] for part in parts if part in self._results}
        batch, left, right, summed = groups_of(message, self._messages, parts, axes, settled)
        if not summed:
            forms = [self._form(part, self._spread(part, axes)) for part in parts]
            self._emit("multiply", forms, result)
        elif not batch:
            first, second = (left, summed), (summed, right)
            if not left or (right and axes[0] in right):  # the result lies the other way round
                parts.reverse()
                first, second = (right, summed), (summed, left)
            forms = [
                self._form(part, tuple(group for group in groups if group))
                for part, groups in zip(parts, (first, second))
            ]
            sizes = [self._size(group) for group in (first[0], second[1]) if group]
            work = self._size(summed) * self._size(second[1])
            chunk = (_GEMM if second[1] else _GEMV) // work
            self._emit_sliced("dot", forms, result.reshape(sizes), 0, chunk)
        else:
            forms = [
                self._form(parts[0], (batch, left, summed)),
                self._form(parts[1], (batch, summed, right)),
            ]
            view = self._view(result, axes, (batch, left, right))
            assert view is not None
            work = self._size(summed) * self._size(right)
            self._emit_sliced("matmul", forms, view, 1, (_GEMM if right else _GEMV) // work)

    def _emit_sliced(
        self, function: str, forms: Sequence[str], result: Array, axis: int, chunk: int
    ) -> None:
        """Emit a product in pieces that are too small for several threads.

        A thread that is not scheduled at once costs milliseconds, now and then.
        """
        count = result.shape[axis] if result.ndim > axis else 1
        if not 0 < chunk < count:
            self._emit(function, forms, result)
            return
        before = (slice(None),) * axis
        for start in range(0, count, chunk):
            piece = (*before, slice(start, start + chunk))
            self._emit(function, [self._sliced(forms[0], piece), forms[1]], result[piece])

    def _sliced(self, form: str, piece: Tuple[slice, ...]) -> str:
        """Return the text of a piece of an array, or of each array that is looked up."""
        name, bracket, case = form.partition("[")
        if not bracket:
            return self._name("v", self._names[name][piece])
        return f"{self._name('t', [one[piece] for one in self._names[name]])}[{case}"

    def _emit(self, function: str, forms: Sequence[str], result: Array) -> None:
        name = self._name("r", result)
        self._lines.append(f"    {function}({', '.join(forms)}, {name})")

    def _spread(self, part: Edge, axes: Axes) -> Tuple[Axes, ...]:
        """Return one group per axis of the result, empty where the part has no such axis."""
        mask = self._messages[part].mask
        return tuple((node,) if mask >> node & 1 else () for node in axes)

    def _form(self, edge: Edge, groups: Tuple[Axes, ...]) -> str:
        """Return the text of a message whose axes are merged to groups, copied if it must be."""
        key = edge, groups
        if key not in self._forms:
            self._forms[key] = self._new_form(edge, groups)
        return self._forms[key]

    def _new_form(self, edge: Edge, groups: Tuple[Axes, ...]) -> str:
        message = self._messages[edge]
        nodes = tuple(bits(message.mask))
        shape = [self._size(group) for group in groups]
        if edge in self._arrays.constants:
            known = self._arrays.constants[edge]
            return self._name("k", _turned(known, nodes, groups).reshape(shape).copy())
        if self._looked_up(edge):
            case, inputs = self._case(message), tuple(bits(message.inputs))
            table = self._arrays.tables[edge]
            axes = tuple(-1 - node for node in inputs) + nodes
            before = tuple((-1 - node,) for node in inputs)
            turned = _turned(table, axes, before + groups).reshape([-1, *shape]).copy()
            return f"{self._name('t', list(turned))}[{case}]"
        if message.kind == EVIDENCE:
            assert self._vectors is not None
            return self._name("e", self._vectors[nodes[0]].reshape(shape))
        result, order = self._results[edge], self._order[edge]
        view = self._view(result, order, groups)
        if view is not None:
            return self._name("v", view)
        turned = _turned(result, order, groups)
        copy = np.zeros(turned.shape)
        self._lines.append(f"    copyto({self._name('c', copy)}, {self._name('v', turned)})")
        return self._name("v", copy.reshape(shape))

    def _view(self, array: Array, axes: Axes, groups: Tuple[Axes, ...]) -> Optional[Array]:
        view = _turned(array, axes, groups).reshape([self._size(group) for group in groups])
        return view if np.shares_memory(view, array) else None

    def _case(self, message: Message) -> str:
        """Return the variable with the number of the case of some inputs."""
        if message.inputs not in self._cases:
            terms, stride = [], 1
            for node in reversed(list(bits(message.inputs))):
                terms.append(f"s[{self._positions[node]}] * {stride}")
                stride *= self._program.cases[node]
            name = f"i{len(self._cases)}"
            self._lines.append(f"    {name} = {' + '.join(terms)}")
            self._cases[message.inputs] = name
        return self._cases[message.inputs]

    def _row(self, edge: Edge) -> str:
        edge = self._resolve[edge]
        axes = tuple(bits(self._messages[edge].mask))
        if self._looked_up(edge):
            case = self._case(self._messages[edge])
            rows = self._arrays.tables[edge].reshape([-1, self._size(axes)]).tolist()
            return f"{self._name('t', rows)}[{case}]"
        if edge in self._arrays.constants:
            return self._name("k", self._arrays.constants[edge].tolist())
        return f"{self._form(edge, (axes,))}.tolist()"

    def _size(self, group: Axes) -> int:
        size = 1
        for node in group:
            size *= self._cards[node]
        return size

    def _name(self, letter: str, value: Any) -> str:
        name = f"{letter}{len(self._names)}"
        self._names[name] = value
        return name


def _turned(array: Array, axes: Axes, groups: Tuple[Axes, ...]) -> Array:
    """Return a view whose axes are in the order of the groups."""
    places = {node: place for place, node in enumerate(axes)}
    return array.transpose([places[node] for group in groups for node in group])
