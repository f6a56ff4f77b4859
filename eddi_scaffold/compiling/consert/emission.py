"""The class ``Monitor`` of a ConSert: its inputs and path sets as tables, its step as text."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from eddi_scaffold.compiling.consert.graph import Graph
from eddi_scaffold.compiling.consert.model import (
    BinaryLeaf,
    CategoricalLeaf,
    ConSertData,
    Leaf,
    Service,
)
from eddi_scaffold.compiling.consert.paths import written_paths
from eddi_scaffold.compiling.consert.program import Compiled, compiled, program_of
from eddi_scaffold.compiling.document import ModelFile
from eddi_scaffold.compiling.inputs import attribute_of, declaration_of, head_lines
from eddi_scaffold.compiling.program.python import Printer
from eddi_scaffold.compiling.text import (
    Group,
    Item,
    Part,
    assignment,
    call,
    literal,
    number,
    returned,
    statement,
    text_literal,
    tuple_of,
    unpacked,
    variables,
)

__all__ = ["FORMAT", "MODULES", "lines_of", "program_of"]

FORMAT = 3
MODULES = ("filters", "search")
"""Modules of the part that a ConSert imports where it uses them."""

STRAIGHT_LINE_LIMIT = 20_000
"""Inputs + edges + gates up to which the step is written out; beyond, the runtime's loop over the
tables does the same, 10 times slower: Python compiles such a text in seconds and with gigabytes.
"""

_RESERVED = {
    "float",
    "getattr",
    "int",
    "raw",
    "self",
    "source",
    "str",
    "t_ns",
    "type",
    "values",
    "INF",
}


def lines_of(
    model_file: ModelFile, *, allow_unsupported: bool = False, limit: int = STRAIGHT_LINE_LIMIT
) -> list[str]:
    """Return the lines of the class.

    Args:
        model_file: the model.
        allow_unsupported: take guarantees without support and gates without input as the
            constants that they are in SESAME's first tool; for tests of the evaluation only.
        limit: size above which step and path sets are left to the runtime.

    Raises:
        ModelError: the model is wrong, or has a constant that no author meant.
    """
    consert = compiled(model_file, allow_unsupported=allow_unsupported)
    data, graph = consert.data, consert.graph
    size = graph.leaves + sum(len(node.inputs) + 1 for node in graph.nodes)
    lines = [
        *head_lines("consert.ConSert", declaration_of(model_file), data.paths),
        *_tables(data, graph, written_paths(graph) if size <= limit else None),
    ]
    if data.filter is not None:
        kind, steps = data.filter
        made = call(f"filters.{kind.capitalize()}", [str(steps)])
        lines += ["", "    def __init__(self):", *statement(call("super().__init__", [made]), 8)]
    if size <= limit:
        lines += ["", *_step(consert, model_file)]
    return lines


def _tables(
    data: ConSertData, graph: Graph, paths: Sequence[Sequence[Sequence[str]]] | None
) -> list[str]:
    lines = assignment("leaves", tuple_of(map(_leaf, data.leaves)), 4)
    sets: list[dict[str, Part]]
    if paths is None:
        lines += _graph(graph)
        sets = [{"node": str(k)} for k in graph.guarantees]
    else:
        if data.guarantees:
            lines += ["    # Paths: the smallest sets of inputs of which each gives the guarantee."]
        sets = [{"paths": literal(path)} for path in paths]
    guarantees = (
        call(
            "consert.Guarantee",
            [text_literal(guarantee.id)],
            **found,
            **_given(
                published=None if guarantee.published == guarantee.id else guarantee.published,
                default=guarantee.default or None,
                ranking=guarantee.ranking,
            ),
        )
        for guarantee, found in zip(data.guarantees, sets, strict=True)
    )
    lines += assignment("guarantees", tuple_of(guarantees), 4)
    if data.services:
        lines += assignment("services", tuple_of(map(_service, data.services)), 4)
    return lines


def _graph(graph: Graph) -> list[str]:
    """Return what path sets are searched in, where they are too many to be written down."""
    nodes = (
        Item(
            tuple_of(
                [
                    text_literal(graph.names[k]),
                    text_literal("And" if node.is_and else "Or"),
                    literal(node.inputs),
                ]
            ),
            behind=str(k),
        )
        for k, node in enumerate(graph.nodes, graph.leaves)
    )
    lines = ["    # Name, gate, numbers of what it reads: the inputs first, then these nodes."]
    return lines + assignment("graph", call("search.Graph", ["inputs", tuple_of(nodes)]), 4)


def _given(**values: Any) -> dict[str, Part]:
    return {key: literal(value) for key, value in values.items() if value is not None}


def _service(service: Service) -> Part:
    return literal((service.id, service.guarantees))


def _leaf(leaf: Leaf) -> Part:
    if isinstance(leaf, BinaryLeaf):
        return "consert.Binary()" if leaf.good else "consert.Binary(False)"
    if isinstance(leaf, CategoricalLeaf):
        return call("consert.Categorical", map(text_literal, leaf.covered))
    ranges = tuple_of(
        tuple_of([number(range_.start), number(range_.end), str(range_.closed)])
        for range_ in leaf.ranges
    )
    return call("consert.Numeric", [ranges, text_literal(leaf.text)])


def _step(consert: Compiled, model_file: ModelFile) -> list[str]:
    data, graph = consert.data, consert.graph
    names = variables(graph.names, _RESERVED)
    leaves = names[: graph.leaves]
    elements = {one: names[k] for one, k in consert.elements.items()}
    printer = Printer(consert.program, leaves, elements)
    lines = ["    def step(self, source):"]
    if leaves:
        lines += ["        try:"]
        reads = tuple_of(attribute_of("source", input_.attribute) for input_ in model_file.inputs)
        lines += assignment("raw", reads, 12)
        lines += ["        except Exception:", "            raw = self.read(source)"]
        lines += ["        self.raw, self.source = raw, source"]
        lines += unpacked(leaves, "raw")
    return [*lines, *printer.operations(), *printer.flags(), *_rows(data, graph, names)]


def _rows(data: ConSertData, graph: Graph, names: Sequence[str]) -> list[str]:
    """Return the method that names the flags (SESAME D7.2 Fig 9)."""
    if not data.guarantees:
        return []
    flags = [names[k] for k in graph.guarantees]
    rows = (
        Item(
            Group(
                "{",
                (Item(text_literal(guarantee.published), '"id": '), Item(flag, '"active": ')),
                "}",
            )
        )
        for guarantee, flag in zip(data.guarantees, flags, strict=True)
    )
    lines = ["", "    def execute_step(self, source, t_ns=None):"]
    lines += ["        eddi_runtime.look_again(source, t_ns)"]
    lines += unpacked(flags, "self.step(source)")
    return [*lines, *returned(Group("[", tuple(rows), "]"), 8)]
