"""Whether operations of numpy infer a part of a network: done once, with numbers modulo a prime.

What they give is a polynomial in the weights of all cases of evidence, and so is what the network
says. Where two such polynomials differ, they do so at a point that is drawn, but for one of 10^16.
"""

from __future__ import annotations

import ast
import itertools
import math
import secrets
from collections.abc import Callable, Container, Mapping, Sequence
from string import ascii_letters
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from eddi_scaffold.evidence.emitted import Call, Emitted, Lines, UnprovedError, data, unpacked
from eddi_scaffold.evidence.sums import place, returned, variables

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Array = NDArray[Any]
    Factor = tuple[Sequence[int], Array]  # its axes: nodes, or ~node for the cases of one
_PRIME = 2**61 - 1
_LARGEST, _MOST_AXES = 2**22, 32  # of a table on the way
_FUNCTIONS = {name: getattr(np, name) for name in ("copyto", "dot", "matmul", "multiply")}


class Group(NamedTuple):
    """Nodes whose probabilities depend on each other for some evidence; nothing else does."""

    nodes: Sequence[int]
    inputs: tuple[int, ...]  # those that may be observed
    outputs: tuple[int, ...]
    always: tuple[int, ...] = ()  # nodes around it that are observed in each step


def product(factors: Sequence[Factor], kept: Sequence[int]) -> Array:
    """Return a product of factors, summed over all axes but those kept."""
    axes: Sequence[int] = ()
    result: Array = np.ones((), factors[0][1].dtype)
    sizes = {axis: n for of, array in factors for axis, n in zip(of, array.shape, strict=True)}
    for k, (others, factor) in enumerate(factors, 1):
        every = sorted({*axes, *others})
        if len(every) > _MOST_AXES or math.prod(sizes[axis] for axis in every) > _LARGEST:
            raise UnprovedError(None, "the network is too wide")
        left = kept if k == len(factors) else every
        a, b, c = (
            "".join(ascii_letters[every.index(axis)] for axis in those)
            for those in (axes, others, left)
        )
        result, axes = np.einsum(f"{a},{b}->{c}", result, factor), left
        result = result % _PRIME if result.dtype == object else result
    return result


def joint(factors: Sequence[Factor], kept: Sequence[int]) -> Array:
    """Return the product of factors, summed over all axes but those kept, the cheapest first."""
    factors = [*factors]
    sizes = {axis: n for of, array in factors for axis, n in zip(of, array.shape, strict=True)}

    def joined(axis: int) -> list[int]:
        return sorted({of for axes, _ in factors if axis in axes for of in axes})

    while open_ := {of for axes, _ in factors for of in axes}.difference(kept):
        axis = min(open_, key=lambda of: math.prod(sizes[k] for k in joined(of)))
        axes = [of for of in joined(axis) if of != axis]
        touched = [factor for factor in factors if axis in factor[0]]
        factors = [factor for factor in factors if axis not in factor[0]]
        factors.append((axes, product(touched, axes)))
    return product(factors, kept)


def exact(table: Array) -> Array:
    """Return numbers modulo the prime: each double is a whole number divided by a power of two."""
    ratios = (of.as_integer_ratio() for of in table.ravel().tolist())
    rows = [number * pow(power, -1, _PRIME) % _PRIME for number, power in ratios]
    return np.array(rows, object).reshape(table.shape)


class Schedule:
    """The messages and operations of one part.

    Args:
        emitted: the text.
        factors: node -> its table.
        group: the part.
        observable: nodes, by their position in the states of a step.
    """

    def __init__(
        self,
        emitted: Emitted,
        factors: Mapping[int, Factor],
        group: Group,
        observable: Sequence[int],
    ) -> None:
        self.emitted, self.group, self.observable = emitted, group, observable
        self.exact = {of: (axes, exact(table)) for of, (axes, table) in factors.items()}
        self.cards = {of: table.shape[-1] for of, (_, table) in factors.items()}
        counts = {of: self.cards[of] + (of in group.inputs) for of in group.inputs + group.always}
        self.weights = {of: _drawn([count]) for of, count in counts.items()}
        self.known: dict[int, Array] = {}  # message -> its numbers for all cases of its inputs
        self.values: list[Factor] = []  # of the messages, at the point that is drawn
        self._axes: list[Sequence[int]] = []
        self.below: list[set[int]] = []  # messages that a message is made of, and itself
        self.vectors: dict[int, Array] = {}  # of evidence
        self.products: set[int] = set()  # messages that are products
        self.merged: set[int] = set()  # roots whose prior is in their vector

    def take(self, at: ast.expr, made: Any) -> None:
        """Take what infers the part, at a place of the text."""
        match made:
            case Call("schedule.Schedule", (Call("nodes"), messages, answers, hard, full), {}):
                pass
            case _:
                raise UnprovedError(at, "it is inferred by patterns")
        for row in self._rows(messages, at):
            self._message(*row)
        group, given = self.group, [*self.weights.items()]
        factors = [self.exact[of] for of in group.nodes if of not in self.merged]
        factors += [((of,), weights) for of, weights in given if of in group.always]
        expected = []
        for output in group.outputs or [-1]:
            seen: list[Factor] = [((k,), of) for k, of in self.vectors.items() if k != output]
            expected.append(joint([*factors, *seen], [output] if group.outputs else []))
        unread = {*group.inputs}.difference(self.vectors)
        has_full, is_run = full is not None, hard is not None or full is not None
        if unread - {*group.outputs[:1]} or has_full is bool(group.always) or not is_run:
            raise UnprovedError(at, "its evidence is other evidence")
        values = [self.values[k] for k in answers]
        rows = [of for _, of in values] if group.outputs else [joint(values, [])]
        self._same(at, "the messages give", rows, expected)
        for steps in (hard, full):
            if steps is not None:
                self._same(at, "a step gives", self._steps(at, steps, answers), expected)

    def _rows(self, name: Any, at: ast.expr) -> Any:
        rows = data(self.emitted.values.pop(str(name), at))
        if "." in repr(rows):
            raise UnprovedError(at, "a place is no whole number")
        return rows

    def _same(
        self, at: ast.expr, what: str, got: Sequence[Array], expected: Sequence[Array]
    ) -> None:
        if [of.tolist() for of in got] != [of.tolist() for of in expected]:
            self.emitted.differs(at, f"{what} other probabilities than the network")

    def _message(
        self,
        kind: str,
        parts: Sequence[int],
        nodes: Sequence[int],
        inputs: Sequence[int],
        is_known: object,
    ) -> None:
        """Take a message; its known numbers have an axis for the cases of each input."""
        cases = [~of for of in inputs]
        number, axes = len(self.values), [*cases, *nodes]
        self.below.append({number}.union(*(self.below[k] for k in parts if kind == "product")))
        if kind == "product":
            self.products.add(number)
            if is_known:
                made = [([*self._axes[k]], self.known[k]) for k in parts]
                self.known[number] = product(made, axes)
            self._axes.append(axes)
            self.values.append((nodes, product([self.values[k] for k in parts], nodes)))
            return
        if not is_known:
            raise UnprovedError(None, "numbers of a message are missing")
        (node,) = parts if kind == "table" else nodes
        if kind == "table":
            family, table = self.exact[node]
            array = product([([~of if of in inputs else of for of in family], table)], axes)
        elif kind in ("evidence", "prior"):
            vector = np.array([1] * self.cards[node], object)
            if kind == "prior":
                family, vector = self.exact[node]
                if len(family) > 1 or node in self.group.outputs or node not in self.group.inputs:
                    raise UnprovedError(None, "the prior of a node goes with its evidence")
                self.merged.add(node)
            array = np.vstack([np.diag((vector != 0).astype(int)).astype(object), vector])
        elif kind == "unit":
            array = np.array([1] * self.cards[node], object)
        else:
            raise UnprovedError(None, f"there are no messages {kind}")
        self._axes.append(axes)
        self.known[number] = array
        seen: list[Factor] = [((~of,), self.weights[of]) for of in inputs]
        self.values.append((nodes, product([(axes, array), *seen], nodes)))
        if kind in ("evidence", "prior"):
            self.vectors[node] = self.values[-1][1]

    def _steps(self, at: ast.expr, made: Any, answers: Sequence[int]) -> list[Array]:
        """Do the operations of a step; return a row for each output."""
        slots, homes, vectors = list[Any](), list[int](), dict(self.vectors)
        for k, (kind, source, *rest) in enumerate(
            data(self.emitted.values.pop(str(made.args[0]), at))
        ):
            home = homes[source] if kind in ("view", "piece") else k if kind == "result" else -1
            if kind == "result":
                new: Any = _drawn(source)  # nothing of a former step may count
            elif kind == "ones":
                new = np.array([1] * source, object)
            elif kind == "evidence":
                new = vectors[source].reshape(rest[0])
            elif kind == "piece":
                at_, of = (*(slice(None),) * rest[0], slice(*rest[1:])), slots[source]
                new = [one[at_] for one in of] if isinstance(of, list) else of[at_]
            elif kind == "view":
                new = slots[source].transpose(rest[0]).reshape(rest[1])
                if not np.shares_memory(new, slots[source]):
                    raise UnprovedError(at, "a view is a copy")
            elif kind in ("row", "rows"):
                known = self.known[source]
                new = known if kind == "row" else [*known.reshape([-1, known.shape[-1]])]
            elif kind in ("constant", "cases"):
                known, cases = self.known[source].transpose(rest[0]), kind == "cases"
                new = known.reshape([-1, *rest[1]] if cases else rest[1]).copy()
                new = [*new] if cases else new
            else:
                raise UnprovedError(at)
            slots.append(new)
            homes.append(home)
        if len(made.args) == 2 and not made.keywords:
            return self._function(self.emitted.functions.pop(str(made.args[1]), at), slots, homes)
        operations = self._rows(made.keywords["operations"], at)
        owners: dict[int, int] = {-1: -1}  # memory of a result -> the message that it is
        for message, name, *places in operations:
            if message not in self.products:  # no other one is looked for where few are asked for
                raise UnprovedError(at, "an operation is of no message")
            target = 0 if name == "copyto" else 2
            for k, slot in enumerate(places):
                owner = owners.setdefault(homes[slot], message)
                if owner != message if k == target else owner not in {-1, *self.below[message]}:
                    raise UnprovedError(at, "an operation is of another message")
            self._do(at, name, [slots[k] for k in places], [homes[k] for k in places])
        shown = made.keywords["answers"]
        for answer, slot in zip(answers, shown, strict=True):
            if owners.get(homes[slot], -1) not in {-1, *self.below[answer]}:
                raise UnprovedError(at, "an answer is another message")
        return [slots[k] for k in shown]

    def _do(self, at: ast.AST, name: str, operands: Sequence[Any], homes: Sequence[int]) -> None:
        target = 0 if name == "copyto" else 2
        if name not in _FUNCTIONS or len(operands) != max(2, target + 1) or homes[target] < 0:
            raise UnprovedError(at)
        _FUNCTIONS[name](*operands)
        operands[target][...] = operands[target] % _PRIME

    def _function(
        self, function: ast.AST, slots: Sequence[Any], homes: Sequence[int]
    ) -> list[Array]:
        """Do the operations of a function."""
        if (
            not isinstance(function, ast.FunctionDef)
            or ast.unparse(function.args) != "numpy, slots"
        ):
            raise UnprovedError(function)
        lines, functions, above = Lines(function), set[str](), list[ast.stmt]()
        while len(lines.rest) > 2 + bool(slots):
            of = lines.find(r"(?P<name>\w+) = numpy\.(?P=name)")
            if of is None:
                raise UnprovedError(function)
            functions.add(of["name"])
        names = unpacked(lines, "slots", len(slots)) if slots else []
        number = {name: k for k, name in enumerate(names)}
        inner, back = lines.rest
        if not isinstance(inner, ast.FunctionDef) or ast.unparse(back) != f"return {inner.name}":
            raise UnprovedError(inner)

        def operand(node: ast.expr) -> tuple[Any, int]:
            match node:
                case ast.Name(id=name) if not isinstance(slots[number[name]], list):
                    return slots[number[name]], homes[number[name]]
                case ast.Subscript(value=ast.Name(id=name), slice=case):
                    return self._chosen(slots[number[name]], inner, [*above, ast.Return(case)]), -1
            raise UnprovedError(node)

        for line in inner.body:
            match line:
                case ast.Assign():
                    above.append(line)
                case ast.Expr(ast.Call(func=ast.Name(id=name), args=args, keywords=[])):
                    if name not in functions:
                        raise UnprovedError(line)
                    arrays, memory = zip(*map(operand, args), strict=True)
                    self._do(line, name, arrays, memory)
                case ast.Return(ast.List(elts=rows)) if line is inner.body[-1]:
                    return [self._row(row, functions, operand) for row in rows]
                case _:
                    raise UnprovedError(line)
        raise UnprovedError(inner)

    def _row(
        self, node: ast.expr, functions: Container[str], operand: Callable[[ast.expr], Any]
    ) -> Array:
        match node:
            case ast.Call(func=ast.Attribute(value=of, attr="tolist"), args=[], keywords=[]):
                row: Array = operand(of)[0]
            case ast.List([ast.Call(ast.Name("float"), [ast.Call(ast.Name("dot"), [a, b])], [])]):
                row = np.array(np.dot(operand(a)[0], operand(b)[0]) % _PRIME)
            case _:
                row = operand(node)[0]
        return row

    def _chosen(self, rows: Sequence[Array], function: ast.AST, lines: Sequence[ast.stmt]) -> Array:
        """Return what is looked up for a case, as the weights of all cases give it."""
        states = {"s": variables(range(len(self.observable)))}
        steps = {of: int(n) for of, n in returned(function, "s", states, place, lines).items() if n}
        nodes = [self.observable[k] for (k,) in steps]
        total: Any = 0
        for case in itertools.product(*(range(len(self.weights[of])) for of in nodes)):
            at = sum(map(int.__mul__, case, steps.values()))
            weight = math.prod(self.weights[of][k] for of, k in zip(nodes, case, strict=True))
            total = (total + weight * rows[at]) % _PRIME
        return np.array(total, object)


def _drawn(shape: Sequence[int]) -> Array:
    count = math.prod(shape)
    return np.array([secrets.randbelow(_PRIME) for _ in range(count)], object).reshape(shape)
