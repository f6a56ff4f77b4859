"""Whether the text of a monitor is its ConSert: gates as functions of the inputs, all else as data.

AND is the least, OR the greatest of three truth values. Equal normal forms are equal functions; for
others the minimal path and cut sets of the model decide, since the functions are monotone.
"""

from __future__ import annotations

import ast
import math
from collections.abc import Iterable, Iterator, Mapping, Sequence
from typing import TYPE_CHECKING

from eddi_scaffold.common.graphs import in_order
from eddi_scaffold.common.problems import plural
from eddi_scaffold.evidence.emitted import (
    Call,
    Emitted,
    Lines,
    UnprovedError,
    called,
    read_inputs,
    unpacked,
)
from eddi_scaffold.evidence.reductions import number
from eddi_scaffold.kinds.consert.consert import BinaryDimension, CategoricalDimension, ConSert
from eddi_scaffold.kinds.consert.ranges import exact
from eddi_scaffold.kinds.consert.vectors import ConSertVectors, dimension_of, in_unit, shown

if TYPE_CHECKING:
    from eddi_scaffold.kinds.consert.options import ConSertOptions

_GATES = (
    r"(?P<r>\w+) = (?P<a>\w+) if (?P=a) (?P<sign>[<>]) (?P<b>\w+) else (?P=b)",
    r"if (?P<a>\w+) (?P<sign>[<>]) (?P<r>\w+):\n    (?P=r) = (?P=a)",
)


class Functions:
    """Functions of leaves in normal form: equal numbers are equal functions."""

    def __init__(self, leaves: int) -> None:
        self._rows: list[tuple[str, tuple[int, ...]]] = [("", (k,)) for k in range(leaves)]
        self._numbers = {row: k for k, row in enumerate(self._rows)}

    def gate(self, op: str, args: Iterable[int]) -> int:
        """Return the And or Or of functions: flat, sorted, without duplicates."""
        inner = set[int]()
        for arg in args:
            inner.update(self._rows[arg][1] if self._rows[arg][0] == op else (arg,))
        row = op, tuple(sorted(inner))
        if len(inner) != 1 and row not in self._numbers:
            self._numbers[row] = len(self._rows)
            self._rows.append(row)
        return inner.pop() if len(inner) == 1 else self._numbers[row]

    def value(self, function: int, given: Sequence[int]) -> int:
        """Return the value of a function: 0, 1 or 2."""
        values = [*given]
        for op, args in self._rows[len(given) :]:
            of = [values[arg] for arg in args]
            values.append(min(of, default=2) if op == "And" else max(of, default=0))
        return values[function]


class Proof:
    """A text that is compared with a ConSert."""

    def __init__(self, consert: ConSert, options: ConSertOptions, emitted: Emitted) -> None:
        self.consert, self.options, self.emitted = consert, options, emitted
        nodes = {node.id: node for node in consert.leaf_nodes}
        self.inputs = emitted.declared.inputs
        self.nodes = [nodes[input_.id] for input_ in self.inputs]
        self.dimensions = [*map(dimension_of, self.nodes)]
        self.sets = ConSertVectors(consert)
        self.ids = [input_.id for input_ in self.inputs]
        self.gates = {g.id: g.function for g in consert.gates}
        self.functions = Functions(len(self.ids))
        self.constants = {"0": self.functions.gate("Or", ()), "2": self.functions.gate("And", ())}
        self.of_model = {id_: k for k, id_ in enumerate(self.ids)}
        self.of_model |= {g.id: self.constants["2"] for g in consert.guarantees if g.default}
        for id_ in in_order(consert.inputs):
            if id_ not in self.of_model:
                args = [self.of_model[source] for source in consert.inputs[id_]]
                self.of_model[id_] = self.functions.gate(self.gates.get(id_, "And"), args)

    def proved(self) -> Iterator[str]:
        """Yield what is proved."""
        emitted, monitor = self.emitted, self.emitted.monitor("consert.ConSert")
        emitted.attribute(monitor, "leaves", tuple(map(self._leaf, range(len(self.inputs)))))
        searched = "graph" in monitor.attributes  # by the runtime, where there are many gates
        sources = self.consert.inputs
        inner = {id_: [k for k in sources[id_] if k not in self.ids] for id_ in sources}
        order = [id_ for id_ in in_order(inner) if id_ not in self.ids]
        number = {id_: k for k, id_ in enumerate([*self.ids, *order])}
        rows = tuple(
            (id_, self.gates.get(id_, "And"), tuple(map(number.get, sources[id_]))) for id_ in order
        )
        graph = Call("search.Graph", (Call("inputs"), rows))
        emitted.attribute(monitor, "graph", graph if searched else None)
        guarantees = tuple(self._guarantees(number if searched else {}))
        emitted.attribute(monitor, "guarantees", guarantees)
        services = [(service.id, service.members) for service in self.consert.provided_services]
        emitted.attribute(monitor, "services", tuple(services) or None)
        if self.options.filter:
            filter_ = f"filters.{self.options.filter.capitalize()}({self.options.filter_steps})"
            monitor.body("__init__", "self", f"super().__init__({filter_})")
        if "step" in monitor.methods or not searched:
            self._step(monitor.method("step", "self, source"))
            if self.consert.guarantees:
                self._execute(monitor.method("execute_step", "self, source, t_ns=None"))
        emitted.end(monitor)
        names = ", ".join(guarantee.id for guarantee in self.consert.guarantees) or "no guarantee"
        yield f"{names} for all verdicts of {plural(len(self.inputs), 'input')}"

    def _leaf(self, k: int) -> Call:
        dimension, factor = self.dimensions[k], self.inputs[k].factor
        if isinstance(dimension, BinaryDimension):
            return Call("consert.Binary", () if dimension.value else (False,))
        if isinstance(dimension, CategoricalDimension):
            return Call("consert.Categorical", dimension.covered)
        needs, unit, _ = shown(self.nodes[k], factor) or ("", "", None)
        text = " or ".join(covered.text() for covered in dimension.covered)
        text += f" {dimension.uom}" if dimension.uom else ""
        ranges = tuple(self._ranges(k))
        if factor is None:
            return Call("consert.Numeric", (ranges, text, needs, unit))
        ends = (f"[{start:.9g}, {end:.9g}{']' if closed else ')'}" for start, end, closed in ranges)
        text = f"{' or '.join(ends)}, which is {text}"
        return Call("consert.Numeric", (ranges, text, needs, unit, factor))

    def _ranges(self, k: int) -> Iterator[tuple[float, float, bool]]:
        for covered in getattr(self.dimensions[k], "covered", ()):
            start, end = (
                in_unit(bound, self.inputs[k].factor) if exact(bound) else bound.value
                for bound in (covered.start, covered.end)
            )
            start = start if covered.start_inclusive else math.nextafter(start, math.inf)
            yield start, end, covered.inclusive

    def _guarantees(self, number: Mapping[str, int]) -> Iterator[Call]:
        for guarantee in self.consert.guarantees:
            sets, id_ = self.sets.paths[guarantee.id], guarantee.id
            if sets is None and not number:
                raise UnprovedError(None, f"{id_} has too many path sets to compare them")
            paths = sorted((tuple(sorted(of)) for of in sets or ()), key=lambda p: (len(p), p))
            published = self.options.published(id_)
            yield called(
                "consert.Guarantee",
                id_,
                node=number.get(id_),
                paths=None if number else tuple(paths),
                published=None if published == id_ else published,
                default=guarantee.default or None,
                ranking=guarantee.ranking,
            )

    def _compare(self, node: ast.AST, function: int, id_: str) -> None:
        """Compare a function with that of the model."""
        if function == self.of_model[id_]:
            return
        paths, cuts = self.sets.paths[id_], self.sets.cuts[id_]
        if paths is None or cuts is None:
            raise UnprovedError(node, f"{id_} has another form than in the model")
        names, of_model = self.ids, self.of_model[id_]
        for leaves, inside, rest in [*((of, 2, 1) for of in paths), *((of, 1, 2) for of in cuts)]:
            given = [inside if leaf in leaves else rest for leaf in names]
            if (self.functions.value(function, given) == 2) == (inside == 2):
                continue
            point = " ".join(f"{leaf}={'FUT'[of]}" for leaf, of in zip(names, given, strict=True))
            verdict = ("FALSE", "UNKNOWN", "TRUE")[self.functions.value(of_model, given)]
            word = "not active" if inside == 2 else "active"
            self.emitted.differs(node, f"{point}: {id_} {word}, the model says {verdict}")
            return

    def _step(self, lines: Lines) -> None:
        kept = "self.raw, self._source = raw, source"
        names = read_inputs(lines, [(input_.attribute, None) for input_ in self.inputs], kept)
        if names.count("_") > 1:
            raise UnprovedError(None, "an input is not judged")
        for k, name in enumerate(names):
            lines.expect(*self._judged(k, name))
        if self.options.filter and names:
            row = f"({', '.join(names)},)"
            lines.expect(f"values = {row}\n{row} = self.filter.apply(values)")
        values = {name: k for k, name in enumerate(names)} | self.constants
        while gates := [of for form in _GATES if (of := lines.find(form)) is not None]:
            for of in gates:
                args = values[of["a"]], values[of.get("b", of["r"])]
                values[of["r"]] = self.functions.gate("And" if of["sign"] == "<" else "Or", args)
        returned = lines.returned()
        flags = [*map(ast.unparse, returned.elts if isinstance(returned, ast.Tuple) else ())]
        if len(flags) != len(self.consert.guarantees):
            raise UnprovedError(returned)
        for flag, guarantee in zip(flags, self.consert.guarantees, strict=True):
            name = flag.removesuffix(" == 2")
            if flag == name or name not in values:
                raise UnprovedError(returned)
            self._compare(returned, values[name], guarantee.id)

    def _judged(self, k: int, x: str) -> Iterator[str]:
        """Yield how an input is judged: by the runtime, or quickly for common types."""
        dimension, unknown = self.dimensions[k], f"1 if {x} is None else self.judge({k}, {x})"
        if isinstance(dimension, BinaryDimension):
            unknown = f"0 if {x} is {not dimension.value} else {unknown}"
            test, known = f"{x} is {dimension.value}", f"{x} = 2"
        elif isinstance(dimension, CategoricalDimension):
            texts = ", ".join(map(repr, dimension.covered))
            test, known = f"type({x}) is str", f"{x} = 2 if {x} in {{{texts}}} else 0"
        else:
            test, known = f"type({x}) is float or type({x}) is int", ""
            for start, end, closed in self._ranges(k):
                inside = f"{number(start)} <= {x} {'<=' if closed else '<'} {number(end)}"
                known += f"{'el' if known else ''}if {inside}:\n        {x} = 2\n    "
            known = known or "if False:\n        pass\n    "
            known += f"else:\n        {x} = 0 if {x} == {x} else 1"
        yield f"{x} = {unknown}"
        yield f"if {test}:\n    {known}\nelse:\n    {x} = {unknown}"

    def _execute(self, lines: Lines) -> None:
        lines.expect("eddi_runtime.look_again(source, t_ns)")
        guarantees = self.consert.guarantees
        names = unpacked(lines, "self.step(source)", len(guarantees))
        if "t_ns" in names:
            raise UnprovedError(None, "a name has two meanings")
        expected = [
            {"id": self.options.published(of.id), "active": Call(name)}
            for of, name in zip(guarantees, names, strict=True)
        ]
        lines.expect(f"self.look(t_ns)\nreturn {expected!r}")
        lines.end()
