"""A ConSert as straight-line Python: judge the evidence, then one line for each gate."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from fractions import Fraction
from typing import NamedTuple

from eddi_scaffold.common.graphs import in_order, reached
from eddi_scaffold.kinds.consert import consert as model
from eddi_scaffold.kinds.consert.graph import written_paths
from eddi_scaffold.kinds.consert.options import ConSertOptions
from eddi_scaffold.kinds.consert.ranges import exact
from eddi_scaffold.program import python_text as py
from eddi_scaffold.program.input_expressions import BoundInput, inlined
from eddi_scaffold.program.instructions import (
    BOOL,
    MAX_NS,
    NUMBER,
    TEXT,
    Interval,
    Operation,
    Program,
    Read,
    Result,
)
from eddi_scaffold.program.monitor_text import (
    CompiledMonitor,
    Declaration,
    attribute_of,
    head_lines,
)
from eddi_scaffold.program.python_step import Printer

FORMAT = 3
MODULES = ("filters", "search")  # Modules of the part that a ConSert imports where it uses them

STRAIGHT_LINE_LIMIT = 20_000
"""Inputs + edges + gates up to which the step is written out; beyond, the runtime's loop over the
tables does the same, 10 times slower: Python compiles such a text in seconds and with gigabytes.
"""

_LEGEND = "# 0 BAD, 1 UNKNOWN, 2 GOOD. AND takes the least, OR the greatest. Active means GOOD.\n"
_RESERVED = {"float", "getattr", "int", "raw", "self", "source", "str", "t_ns", "type", "values"}
_RESERVED |= {"INF", "eddi_runtime"}


class Leaf(NamedTuple):
    """Evidence or a demand as it is judged, with bounds in the unit in which values arrive."""

    id: str
    type: str
    judgement: str  # the operation that judges it
    covered: tuple[str, ...] | tuple[Interval, ...] | None  # the texts or ranges that are good
    constructor: py.Part  # the same for the runtime
    about: str  # the same for people


def compile_consert(
    consert: model.ConSert,
    options: ConSertOptions,
    declaration: Declaration,
    *,
    limit: int = STRAIGHT_LINE_LIMIT,
) -> CompiledMonitor:
    """Compile a ConSert; beyond the limit, step and path sets are left to the runtime."""
    return _Compilation(consert, options, declaration).compiled(limit)


class _Compilation:
    """The elements of a ConSert by number: first the inputs, then gates and guarantees."""

    def __init__(
        self, consert: model.ConSert, options: ConSertOptions, declaration: Declaration
    ) -> None:
        self.consert, self.options, self.declaration = consert, options, declaration
        leaves = {node.id: node for node in consert.leaf_nodes}
        self.leaves = [_leaf(leaves[input_.id], input_) for input_ in declaration.inputs]
        self.paths = {node.id: node.place.path or "" for node in consert.nodes}
        self.sources = consert.inputs
        self.ors = {gate.id for gate in consert.gates if gate.function == "Or"}
        self.inner = in_order(
            {
                id_: tuple(source for source in sources if source not in leaves)
                for id_, sources in self.sources.items()
                if id_ not in leaves
            }
        )
        self.names = [*(leaf.id for leaf in self.leaves), *self.inner]
        self.numbers = {name: k for k, name in enumerate(self.names)}

    def compiled(self, limit: int) -> CompiledMonitor:
        """Return the monitor."""
        program, elements = self._program()
        size = len(self.leaves) + sum(len(self.sources[name]) + 1 for name in self.inner)
        lines = [
            *head_lines("consert.ConSert", self.declaration, self.paths),
            *py.assignment("leaves", py.tuple_of(leaf.constructor for leaf in self.leaves), 4),
            *self._guarantees(written_paths(self.consert) if size <= limit else None),
        ]
        if self.options.filter:
            filter_ = f"filters.{self.options.filter.capitalize()}"
            made = py.call("super().__init__", [py.call(filter_, [str(self.options.filter_steps)])])
            lines += ["", "    def __init__(self):", *py.statement(made, 8)]
        if size <= limit:
            lines += ["", *self._step(program, elements)]
        program = inlined(program, self.declaration.inputs)
        return CompiledMonitor(FORMAT, lines, MODULES, program=program, legend=_LEGEND)

    def _about(self, name: str) -> str:
        path = self.paths[name]
        return py.comment(f"{name}: {path}" if path else name)

    def _program(self) -> tuple[Program, dict[int, str]]:
        """Return the program, and operation -> the element whose value it is."""
        operations, elements, values = list[Operation](), dict[int, str](), dict[str, int]()

        def add(operation: Operation, name: str) -> None:
            operations.append(operation)
            values[name] = len(operations) - 1
            elements[values[name]] = name

        for k, leaf in enumerate(self.leaves):
            operations.append(Operation("variable", (), leaf.type, k, leaf.id))
            raw, about = len(operations) - 1, self._about(leaf.id)
            add(Operation(leaf.judgement, (raw,), BOOL, leaf.covered, about), leaf.id)
        filter_, steps = self.options.filter, self.options.filter_steps
        for leaf in self.leaves if filter_ else ():
            about = f"{filter_} {self._about(leaf.id)}"
            add(Operation(filter_, (values[leaf.id],), BOOL, steps, about), leaf.id)
        guarantees = [guarantee.id for guarantee in self.consert.guarantees]
        needed = reached(self.sources, guarantees)
        for name in (name for name in self.inner if name in needed):
            gate = "Or" if name in self.ors else "And"
            args = tuple(values[source] for source in self.sources[name])
            about = self._about(name)
            if len(args) > 1:
                add(Operation(gate.lower(), args, BOOL, None, f"{gate} {about}"), name)
            elif args:
                values[name] = args[0]
            else:
                operations.append(Operation("truth", (), BOOL, 2 if gate == "And" else 0, about))
                values[name] = len(operations) - 1
        results = (
            Result(self.options.published(name), values[name], about=self._about(name))
            for name in guarantees
        )
        reads = map(_read, self.leaves, self.declaration.inputs)
        return Program(0, tuple(reads), tuple(operations), tuple(results)), elements

    def _guarantees(self, paths: Sequence[Sequence[Sequence[str]]] | None) -> Iterator[str]:
        """Yield the lines of guarantees and services; without paths, what these are searched in."""
        sets: list[dict[str, py.Part]]
        guarantees = self.consert.guarantees
        if paths is None:
            yield "    # Name, gate, numbers of what it reads: the inputs first, then these nodes."
            graph = py.call("search.Graph", ["inputs", py.tuple_of(self._graph())])
            yield from py.assignment("graph", graph, 4)
            sets = [{"node": str(self.numbers[guarantee.id])} for guarantee in guarantees]
        else:
            if guarantees:
                yield "    # Paths: the smallest sets of inputs of which each gives the guarantee."
            sets = [{"paths": py.literal(tuple(path))} for path in paths]
        rows = []
        for guarantee, keywords in zip(guarantees, sets, strict=True):
            published = self.options.published(guarantee.id)
            if published != guarantee.id:
                keywords["published"] = py.literal(published)
            if guarantee.default:
                keywords["default"] = "True"
            if guarantee.ranking is not None:
                keywords["ranking"] = py.literal(guarantee.ranking)
            rows.append(py.call("consert.Guarantee", [py.text_literal(guarantee.id)], **keywords))
        yield from py.assignment("guarantees", py.tuple_of(rows), 4)
        if services := self.consert.provided_services:
            parts = (py.literal((service.id, service.members)) for service in services)
            yield from py.assignment("services", py.tuple_of(parts), 4)

    def _graph(self) -> Iterator[py.Item]:
        for name in self.inner:
            gate = py.text_literal("Or" if name in self.ors else "And")
            sources = py.literal(tuple(self.numbers[source] for source in self.sources[name]))
            row = py.tuple_of([py.text_literal(name), gate, sources])
            yield py.Item(row, behind=str(self.numbers[name]))

    def _step(self, program: Program, elements: dict[int, str]) -> list[str]:
        names = dict(zip(self.names, py.variables(self.names, _RESERVED), strict=True))
        leaves = [names[leaf.id] for leaf in self.leaves]
        printer = Printer(program, leaves, {k: names[name] for k, name in elements.items()})
        lines = ["    def step(self, source):"]
        if leaves:
            inputs = self.declaration.inputs
            reads = py.tuple_of(attribute_of("source", input_.attribute) for input_ in inputs)
            lines += ["        try:", *py.assignment("raw", reads, 12)]
            lines += ["        except Exception:", "            raw = self.read(source)"]
            lines += ["        self.raw, self._source = raw, source", *py.unpacked(leaves, "raw")]
        lines += [*printer.operations(), *printer.flags()]
        if not self.consert.guarantees:
            return lines
        # The method that names the flags (SESAME D7.2 Fig 9).
        flags = [names[guarantee.id] for guarantee in self.consert.guarantees]
        rows = (
            py.Item(
                py.Group(
                    "{",
                    (py.Item(py.text_literal(result.id), '"id": '), py.Item(flag, '"active": ')),
                    "}",
                )
            )
            for result, flag in zip(program.results, flags, strict=True)
        )
        lines += ["", "    def execute_step(self, source, t_ns=None):"]
        lines += ["        eddi_runtime.look_again(source, t_ns)"]
        lines += py.unpacked(flags, "self.step(source)")
        lines += ["        self.look(t_ns)"]
        return [*lines, *py.returned(py.Group("[", tuple(rows), "]"), 8)]


def _leaf(node: model.Evidence | model.Demand, input_: BoundInput) -> Leaf:
    # A demand gets whether some guarantee that fulfils it is active, whatever its dimensions.
    dimension = node.dimension if isinstance(node, model.Evidence) else model.BinaryDimension("")
    if isinstance(dimension, model.BinaryDimension):
        if dimension.value:
            return Leaf(node.id, BOOL, "is_true", None, "consert.Binary()", "")
        return Leaf(node.id, BOOL, "is_false", None, "consert.Binary(False)", "good: false")
    if isinstance(dimension, model.CategoricalDimension):
        texts = dimension.covered
        constructor = py.call("consert.Categorical", map(py.text_literal, texts))
        return Leaf(node.id, TEXT, "is_covered", texts, constructor, f"good: {' or '.join(texts)}")
    ranges = []
    for covered in dimension.covered:
        start, end = _in_unit(covered.start, input_.factor), _in_unit(covered.end, input_.factor)
        start = start if covered.start_inclusive else math.nextafter(start, math.inf)
        ranges.append(Interval(start, end, covered.inclusive))
    text = " or ".join(covered.text() for covered in dimension.covered)
    text += f" {dimension.uom}" if dimension.uom else ""
    if input_.factor is not None:
        ends = (f"[{r.start:.9g}, {r.end:.9g}{']' if r.closed else ')'}" for r in ranges)
        text = f"{' or '.join(ends)}, which is {text}"
    rows = (py.tuple_of([py.number(r.start), py.number(r.end), str(r.closed)]) for r in ranges)
    unit = "%" if dimension.uom in {"percent", "pct"} else dimension.uom or ""
    needs = f"{' or '.join(covered.short for covered in dimension.covered)} {unit}".rstrip()
    shown: list[py.Part] = [py.text_literal(words) for words in (text, needs, unit)]
    shown += [py.literal(input_.factor)] if input_.factor is not None else []
    constructor = py.call("consert.Numeric", [py.tuple_of(rows), *shown])
    return Leaf(node.id, NUMBER, "is_within", tuple(ranges), constructor, f"good: {text}")


def _in_unit(bound: model.Bound, factor: tuple[int, int] | None) -> float:
    """Return a bound in the unit of the input.

    It is divided exactly and rounded once: ``36 km/h`` is exactly 10 m/s, and a value is never
    multiplied, which could round it into the range.
    """
    value = exact(bound)
    if factor is None or isinstance(value, float) or not value:
        return bound.value
    try:
        return float(value / Fraction(*factor))
    except OverflowError:
        return math.inf if value > 0 else -math.inf


def _read(leaf: Leaf, input_: BoundInput) -> Read:
    age = input_.max_age if isinstance(input_.max_age, int | float) else None
    timeout = None if age is None else round(min(age * 1e9, MAX_NS))
    return Read(
        leaf.id,
        leaf.type,
        timeout=timeout,
        infinite=leaf.type == NUMBER,
        stamped=timeout is not None,
        about=py.comment(leaf.about),
    )
