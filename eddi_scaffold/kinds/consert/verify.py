"""Whether the text of a monitor is its ConSert: gates as functions of the inputs, all else as data.

Truth values are three, AND is the least and OR the greatest; functions of these that are equal for
TRUE and FALSE are equal, so two-valued decision diagrams decide (Bryant 1986).
"""

from __future__ import annotations

import ast
import math
from collections.abc import Iterable, Iterator, Sequence
from typing import TYPE_CHECKING

from eddi_scaffold.common.graphs import in_order
from eddi_scaffold.common.problems import plural
from eddi_scaffold.evidence.emitted import (
    Call,
    Class,
    Emitted,
    Lines,
    UnprovedError,
    data,
    matched,
    read_inputs,
    unpacked,
)
from eddi_scaffold.kinds.consert.consert import (
    BinaryDimension,
    CategoricalDimension,
    ConSert,
)
from eddi_scaffold.kinds.consert.ranges import exact
from eddi_scaffold.kinds.consert.vectors import dimension_of, in_unit

if TYPE_CHECKING:
    from eddi_scaffold.kinds.consert.options import ConSertOptions

_MOST_NODES = 100_000
_BINARY = """\
if X is {}:
    X = 2
else:
    X = 0 if X is {} else 1 if X is None else self.judge(K, X)"""
_OTHER = "X = 1 if X is None else self.judge(K, X)"
_TEXT = f"if type(X) is str:\n    X = 2 if X in S else 0\nelse:\n    {_OTHER}"
_NUMBER = f"if type(X) is float or type(X) is int:\n    I\nelse:\n    {_OTHER}"
_RANGES = {
    closed: f"if A <= X {sign} B:\n    X = 2\nelse:\n    E"
    for closed, sign in ((1, "<="), (0, "<"))
}


_GATES = {
    "And": "R = A if A < B else B",
    "And ": "if A < R:\n    R = A",
    "Or": "R = A if A > B else B",
    "Or ": "if A > R:\n    R = A",
    "": "return V",
}


class Functions:
    """Functions of leaves in normal form: equal numbers are equal functions."""

    def __init__(self, leaves: Sequence[str]) -> None:
        self._numbers: dict[tuple[str, tuple[int, ...]], int] = {}
        self._rows: list[tuple[str, tuple[int, ...]]] = []
        self.false, self.true = self.gate("Or", ()), self.gate("And", ())
        self.leaves = {leaf: self._add(leaf, (k,)) for k, leaf in enumerate(leaves)}
        self._nodes = [(len(leaves), 0, 0), (len(leaves), 1, 1)]  # variable, if FALSE, if TRUE
        self._known: dict[tuple[int, ...] | tuple[int, str, int], int] = {}

    def _add(self, op: str, args: tuple[int, ...]) -> int:
        if (op, args) not in self._numbers:
            self._numbers[op, args] = len(self._rows)
            self._rows.append((op, args))
        return self._numbers[op, args]

    def gate(self, op: str, args: Iterable[int]) -> int:
        """Return the And or Or of functions: flat, sorted, without duplicates."""
        inner: set[int] = set()
        for arg in args:
            of, below = self._rows[arg]
            inner.update(below if of == op else (arg,))
        return inner.pop() if len(inner) == 1 else self._add(op, tuple(sorted(inner)))

    def diagram(self, function: int) -> int:
        """Return the decision diagram of a function."""
        op, args = self._rows[function]
        if op not in ("And", "Or"):
            return self._node(args[0], 0, 1)
        if (function,) not in self._known:
            result = int(op == "And")
            for arg in args:
                result = self._both(op, result, self.diagram(arg))
            self._known[function,] = result
        return self._known[function,]

    def _node(self, variable: int, low: int, high: int) -> int:
        key = (variable, low, high)
        if low != high and key not in self._known:
            if len(self._nodes) == _MOST_NODES:
                raise UnprovedError(None, "its decision diagram is too large")
            self._nodes.append(key)
            self._known[key] = len(self._nodes) - 1
        return low if low == high else self._known[key]

    def _both(self, op: str, a: int, b: int) -> int:
        for one, other in ((a, b), (b, a)):
            if one == other or one == int(op == "And"):
                return other
            if one == int(op == "Or"):
                return one
        key = (min(a, b), op, max(a, b))
        if key not in self._known:
            variable = min(self._nodes[a][0], self._nodes[b][0])
            (a0, a1), (b0, b1) = (
                self._nodes[k][1:] if self._nodes[k][0] == variable else (k, k) for k in (a, b)
            )
            self._known[key] = self._node(variable, self._both(op, a0, b0), self._both(op, a1, b1))
        return self._known[key]

    def witness(self, true: int, false: int) -> dict[str, bool] | None:
        """Return leaves for which one function is TRUE and the other is not."""
        names = [*self.leaves]
        waiting: list[tuple[int, int, dict[str, bool]]]
        waiting, seen = [(self.diagram(true), self.diagram(false), {})], set()
        while waiting:
            a, b, given = waiting.pop()
            variable = min(self._nodes[a][0], self._nodes[b][0])
            if (a, b) == (1, 0):
                return given
            if (a, b) in seen or variable == len(names):
                continue
            seen.add((a, b))
            for value in (True, False):
                below = (
                    self._nodes[k][1 + value] if self._nodes[k][0] == variable else k
                    for k in (a, b)
                )
                waiting.append((*below, {**given, names[variable]: value}))  # type: ignore[arg-type]
        return None


def verify(consert: ConSert, options: ConSertOptions, emitted: Emitted) -> Iterator[str]:
    """Compare a text with a ConSert; yield what is proved."""
    return _Proof(consert, options, emitted).proved()


class _Proof:
    def __init__(self, consert: ConSert, options: ConSertOptions, emitted: Emitted) -> None:
        self.consert, self.options, self.emitted = consert, options, emitted
        nodes = {node.id: node for node in consert.leaf_nodes}
        self.inputs = emitted.declared.inputs
        self.nodes = [nodes[input_.id] for input_ in self.inputs]
        self.functions = functions = Functions([input_.id for input_ in self.inputs])
        self.ors = {gate.id for gate in consert.gates if gate.function == "Or"}
        self.of_model = dict(functions.leaves)
        self.of_model |= {g.id: functions.true for g in consert.guarantees if g.default}
        for id_ in in_order(consert.inputs):
            if id_ not in self.of_model:
                gate = "Or" if id_ in self.ors else "And"
                args = [self.of_model[source] for source in consert.inputs[id_]]
                self.of_model[id_] = functions.gate(gate, args)

    def proved(self) -> Iterator[str]:
        """Yield what is proved."""
        emitted, monitor = self.emitted, self.emitted.monitor("consert.ConSert")
        leaves = (self._leaf(k) for k in range(len(self.nodes)))
        emitted.attribute(monitor, "leaves", tuple(leaves))
        numbers = self._graph(monitor)
        self._guarantees(monitor, numbers)
        services = [(service.id, service.members) for service in self.consert.provided_services]
        emitted.attribute(monitor, "services", tuple(services) or None)
        made = monitor.method("__init__", "self")
        filter_ = None
        if made is not None:
            filter_ = made.take("super().__init__(F)")["F"]
            made.end()
        if filter_ is not None or self.options.filter:
            name = f"filters.{self.options.filter.capitalize()}"
            emitted.same("the filter", filter_, Call(name, (self.options.filter_steps,)))
        step = monitor.method("step", "self, source")
        if step is not None:
            self._step(step)
        elif numbers is None:
            raise UnprovedError(monitor.node, "nothing says what a step does")
        execute = monitor.method("execute_step", "self, source, t_ns=None")
        if execute is not None:
            self._execute(execute)
        emitted.end(monitor)
        names = ", ".join(guarantee.id for guarantee in self.consert.guarantees) or "no guarantee"
        yield f"{names} for all verdicts of {plural(len(self.nodes), 'input')}"

    def _leaf(self, k: int) -> Call:
        dimension = dimension_of(self.nodes[k])
        if isinstance(dimension, BinaryDimension):
            return Call("consert.Binary", () if dimension.value else (False,))
        if isinstance(dimension, CategoricalDimension):
            return Call("consert.Categorical", dimension.covered)
        ranges, factor = self._ranges(k), self.inputs[k].factor
        text = " or ".join(covered.text() for covered in dimension.covered)
        text += f" {dimension.uom}" if dimension.uom else ""
        if factor is not None:
            ends = (f"[{start:.9g}, {end:.9g}{']' if in_ else ')'}" for start, end, in_ in ranges)
            text = f"{' or '.join(ends)}, which is {text}"
        unit = "%" if dimension.uom in {"percent", "pct"} else dimension.uom or ""
        needs = f"{' or '.join(covered.short for covered in dimension.covered)} {unit}".rstrip()
        shown = (text, needs, unit) if factor is None else (text, needs, unit, factor)
        return Call("consert.Numeric", (ranges, *shown))

    def _ranges(self, k: int) -> tuple[tuple[float, float, bool], ...]:
        factor, rows = self.inputs[k].factor, []
        for covered in getattr(dimension_of(self.nodes[k]), "covered", ()):
            start, end = (
                in_unit(bound, factor) if exact(bound) else bound.value
                for bound in (covered.start, covered.end)
            )
            start = start if covered.start_inclusive else math.nextafter(start, math.inf)
            rows.append((start, end, covered.inclusive))
        return tuple(rows)

    def _graph(self, monitor: Class) -> list[str] | None:
        """Return what the numbers of the graph are that the runtime searches."""
        node = monitor.attributes.pop("graph", None)
        if node is None:
            return None
        holes = matched("search.Graph(inputs, R)", [node])
        rows = data(holes["R"]) if holes else ()
        names = [*self.functions.leaves, *(row[0] for row in rows)]
        expected = []
        for name in names[len(self.nodes) :]:
            known = names[: names.index(name)]
            sources = self.consert.inputs.get(name, ())
            if name in known or not {*sources} <= {*known}:
                raise UnprovedError(node)
            gate = "Or" if name in self.ors else "And"
            expected.append((name, gate, tuple(map(names.index, sources))))
        if len(names) != len(self.consert.nodes):
            raise UnprovedError(node)
        self.emitted.same("the graph", holes["R"] if holes else node, tuple(expected))
        return names

    def _guarantees(self, monitor: Class, numbers: Sequence[str] | None) -> None:
        node = monitor.attributes.pop("guarantees", None)
        expected = []
        rows = node.elts if isinstance(node, ast.Tuple) else []
        for k, guarantee in enumerate(self.consert.guarantees):
            id_, keywords = guarantee.id, dict[str, object]()
            row = rows[k] if k < len(rows) else None
            published = self.options.published(id_)
            for keyword in row.keywords if isinstance(row, ast.Call) else ():
                if keyword.arg == "paths" and numbers is None:
                    self._paths(id_, keyword.value)
                    keywords["paths"] = data(keyword.value)
            if numbers is not None:
                keywords["node"] = numbers.index(id_)
            keywords |= {"published": published} if published != id_ else {}
            keywords |= {"default": True} if guarantee.default else {}
            keywords |= {} if guarantee.ranking is None else {"ranking": guarantee.ranking}
            if not {"node", "paths"} & {*keywords}:
                raise UnprovedError(node, f"nothing gives {id_}")
            expected.append(Call("consert.Guarantee", (id_,), keywords))
        self.emitted.same("guarantees", node, tuple(expected))

    def _paths(self, id_: str, node: ast.expr) -> None:
        """Compare path sets: together they are the function, and none holds another one."""
        paths, functions = data(node), self.functions
        if {leaf for path in paths for leaf in path} <= {*functions.leaves}:
            ands = [functions.gate("And", map(functions.leaves.get, path)) for path in paths]  # type: ignore[arg-type]
            self._compare(f"paths of {id_}", node, functions.gate("Or", ands), id_)
            if any({*a} <= {*b} for a in paths for b in paths if a is not b) or any(
                len({*path}) < len(path) for path in paths
            ):
                self.emitted.differs(node, f"paths of {id_} are not the smallest")
            if list(paths) != sorted((tuple(sorted(p)) for p in paths), key=lambda p: (len(p), p)):
                self.emitted.differs(node, f"paths of {id_} are in another order")
        else:
            raise UnprovedError(node)

    def _compare(self, what: str, node: ast.AST, function: int, id_: str) -> None:
        """Compare a function of the text with that of a node of the model."""
        expected, functions = self.of_model[id_], self.functions
        if function == expected:
            return
        for high, low, more in ((function, expected, True), (expected, function, False)):
            given = functions.witness(high, low)
            if given is None:
                continue
            # what is not TRUE may be UNKNOWN: it makes nothing active
            point = " ".join(f"{k}={'T' if v else 'U'}" for k, v in given.items())
            point += ", the rest U" if len(given) < len(functions.leaves) else ""
            verdict = "FALSE" if low == functions.false else "UNKNOWN"
            says = (
                f"active, the model says {verdict}" if more else "not active, the model says TRUE"
            )
            self.emitted.differs(node, f"{point.removeprefix(', ')}: {what} {says}")
            return

    def _step(self, lines: Lines) -> None:
        kept = "self.raw, self._source = raw, source"
        attributes = [(input_.attribute, None) for input_ in self.inputs]
        names = read_inputs(lines, attributes, kept)
        values: dict[str, int] = {}
        for k, name in enumerate(names):
            self._judged(lines, k, name)
            values[name] = self.functions.leaves[self.inputs[k].id]
        if self.options.filter and names:
            tuple_ = lines.take("values = V")["V"]
            self.emitted.same("what is filtered", tuple_, tuple(map(Call, names)))
            if unpacked(lines, "self.filter.apply(values)", len(names)) != names:
                raise UnprovedError(tuple_)

        def value(node: ast.AST) -> int:
            if isinstance(node, ast.Constant) and repr(node.value) in ("0", "2"):
                return self.functions.true if node.value else self.functions.false
            if not isinstance(node, ast.Name) or node.id not in values:
                raise UnprovedError(node)
            return values[node.id]

        gate, holes = lines.which(_GATES)
        while gate:
            if not isinstance(holes["R"], ast.Name):
                raise UnprovedError(holes["R"])
            args = [value(holes["A"]), value(holes.get("B", holes["R"]))]
            values[holes["R"].id] = self.functions.gate(gate.strip(), args)
            gate, holes = lines.which(_GATES)
        lines.end()
        flags = getattr(holes["V"], "elts", ())
        if len(flags) != len(self.consert.guarantees):
            raise UnprovedError(holes["V"], "it returns other guarantees")
        for flag, guarantee in zip(flags, self.consert.guarantees, strict=True):
            of = matched("A == 2", [flag])
            if of is None:
                raise UnprovedError(flag)
            self._compare(guarantee.id, flag, value(of["A"]), guarantee.id)

    def _judged(self, lines: Lines, k: int, name: str) -> None:
        """Take the lines that judge what was read: fast ones for common types, else the runtime."""
        dimension = dimension_of(self.nodes[k])
        forms = [_OTHER]
        if isinstance(dimension, BinaryDimension):
            forms.append(_BINARY.format(dimension.value, not dimension.value))
        else:
            forms.append(_TEXT if isinstance(dimension, CategoricalDimension) else _NUMBER)
        holes = lines.take(*forms)
        if ast.unparse(holes["X"]) != name or ast.unparse(holes["K"]) != str(k):
            raise UnprovedError(holes["X"], "another input is judged")
        if "S" in holes:
            got, expected = data(holes["S"]), {*getattr(dimension, "covered", ())}
            if got != expected or len(holes["S"].elts) != len(expected):
                self.emitted.differs(holes["S"], f"what is good of {self.inputs[k].id}")
        if "I" in holes:
            rest, rows = holes["I"], []
            while (last := matched("X = 0 if X == X else 1", [rest])) is None:
                ranges = ((closed, matched(form, [rest])) for closed, form in _RANGES.items())
                closed, range_ = next((row for row in ranges if row[1] is not None), (0, None))
                if range_ is None or ast.unparse(range_["X"]) != name:
                    raise UnprovedError(rest)
                rows.append((data(range_["A"]), data(range_["B"]), bool(closed)))
                rest = range_["E"]
            if ast.unparse(last["X"]) != name:
                raise UnprovedError(rest)
            if (expected_rows := self._ranges(k)) != tuple(rows):
                text = f"good of {self.inputs[k].id} is {rows}, the model says {expected_rows}"
                self.emitted.differs(holes["I"], text)

    def _execute(self, lines: Lines) -> None:
        lines.take("eddi_runtime.look_again(source, t_ns)")
        guarantees = self.consert.guarantees
        names = unpacked(lines, "self.step(source)", len(guarantees))
        lines.take("self.look(t_ns)")
        expected = [
            {"id": self.options.published(of.id), "active": Call(name)}
            for of, name in zip(guarantees, names, strict=True)
        ]
        self.emitted.same("what a step returns", lines.take("return V")["V"], expected)
        lines.end()
