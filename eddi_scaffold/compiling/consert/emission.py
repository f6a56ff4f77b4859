"""The class ``Monitor`` of a ConSert: its inputs and its graph as tables, its step as text."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from eddi_scaffold.compiling.consert.graph import Graph, build_graph
from eddi_scaffold.compiling.consert.model import (
    BinaryLeaf,
    CategoricalLeaf,
    ConSertData,
    Interval,
    Leaf,
    Service,
    read_consert,
)
from eddi_scaffold.compiling.document import ModelError, ModelFile, take
from eddi_scaffold.compiling.inputs import attribute_of, head_lines
from eddi_scaffold.compiling.text import (
    Group,
    Item,
    Part,
    assignment,
    call,
    comment,
    literal,
    number,
    returned,
    statement,
    text_literal,
    tuple_of,
    unpacked,
    variables,
)

FORMAT = 2
MODULES = ("filters",)
"""Modules of the part that a ConSert imports where it uses them."""

STRAIGHT_LINE_LIMIT = 20_000
"""Inputs + edges + gates up to which the step is written out; beyond, the runtime's loop over the
tables does the same, 10 times slower: Python compiles such a text in seconds and with gigabytes.
"""

_MAX_RANGES = 8
"""Ranges of a leaf that are written out; more are judged by the general function."""

_MAX_SAMPLES = 100_000
"""Longest history of a filter; at 1 kHz that is 100 s."""

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
        limit: size above which the step is left to the runtime's loop.

    Raises:
        ModelError: the model is wrong, or has a constant that no author meant.
    """
    data = read_consert(model_file)
    graph = build_graph(data)
    if graph.unsupported and not allow_unsupported:
        listed = ", ".join(map(repr, graph.unsupported))
        raise ModelError("", f"constant without being meant as default: {listed}")
    chosen = _filter(model_file.settings)
    lines = [
        *head_lines("consert.ConSert", model_file, data.paths),
        *_tables(data, graph),
    ]
    if chosen is not None:
        lines += ["", "    def __init__(self):"]
        lines += statement(call("super().__init__", [chosen]), 8)
    size = graph.leaves + sum(len(node.inputs) + 1 for node in graph.nodes)
    if size <= limit:
        lines += ["", *_step(data, graph, model_file, filtered=chosen is not None)]
    return lines


def _tables(data: ConSertData, graph: Graph) -> list[str]:
    node = dict(zip((g.id for g in data.guarantees), graph.guarantees, strict=True))
    nodes = (
        Item(
            tuple_of(
                [
                    text_literal(graph.names[k]),
                    text_literal("And" if one.is_and else "Or"),
                    literal(one.inputs),
                ]
            ),
            behind=str(k),
        )
        for k, one in enumerate(graph.nodes, graph.leaves)
    )
    guarantees = (
        call(
            "consert.Guarantee",
            [text_literal(one.id), str(node[one.id])],
            **_given(
                published=None if one.published == one.id else one.published,
                default=one.default or None,
                ranking=one.ranking,
            ),
        )
        for one in data.guarantees
    )
    lines = assignment("leaves", tuple_of(map(_leaf, data.leaves)), 4)
    if graph.nodes:
        lines += ["    # Name, gate, numbers of what it reads: the inputs first, then these nodes."]
    lines += assignment("nodes", tuple_of(nodes), 4)
    lines += assignment("guarantees", tuple_of(guarantees), 4)
    if data.services:
        lines += assignment("services", tuple_of(map(_service, data.services)), 4)
    return lines


def _given(**values: Any) -> dict[str, Part]:
    return {key: literal(value) for key, value in values.items() if value is not None}


def _service(service: Service) -> Part:
    return literal((service.id, service.guarantees))


def _leaf(leaf: Leaf) -> Part:
    if isinstance(leaf, BinaryLeaf):
        return "consert.Binary()"
    if isinstance(leaf, CategoricalLeaf):
        return call("consert.Categorical", map(text_literal, leaf.covered))
    ranges = tuple_of(
        tuple_of([number(one.start), number(one.end), str(one.closed)]) for one in leaf.ranges
    )
    return call("consert.Numeric", [ranges, text_literal(leaf.text)])


def _filter(settings: Mapping[str, Any]) -> Part | None:
    """Return the object that filters the leaves, ``None`` for no filter.

    Raises:
        ModelError: the filter is not known or its number is not a whole number above 0.
    """
    wanted = settings.get("filter")
    kind = "none" if wanted is None else take(wanted, "kind", str, "the filter")
    if kind == "none":
        return None
    if kind == "debounce":
        needed = _samples(wanted, "regain_after")
        return call("filters.Debounce", [str(needed)]) if needed > 1 else None
    if kind == "majority":
        window = _samples(wanted, "window")
        return call("filters.Majority", [str(window)]) if window > 1 else None
    raise ModelError("", f"the filter {kind!r} is not known: none, debounce or majority")


def _samples(wanted: Any, key: str) -> int:
    found: int = take(wanted, key, int, "the filter") if key in wanted else 1
    if not 1 <= found <= _MAX_SAMPLES:
        raise ModelError("", f"{key!r} of the filter is not from 1 to {_MAX_SAMPLES}")
    return found


def _step(data: ConSertData, graph: Graph, model_file: ModelFile, *, filtered: bool) -> list[str]:
    names = variables(graph.names, _RESERVED)
    leaves = names[: graph.leaves]
    lines = ["    def step(self, source):"]
    if leaves:
        lines += ["        try:"]
        reads = tuple_of(attribute_of("source", one.attribute) for one in model_file.inputs)
        lines += assignment("raw", reads, 12)
        lines += ["        except Exception:", "            raw = self.read(source)"]
        lines += ["        self.raw, self.source = raw, source"]
        lines += unpacked(leaves, "raw")
    for k, leaf in enumerate(data.leaves):
        lines += [f"        # {_about(leaf.id, data)}"]
        lines += _judgement(k, leaf, names[k])
    if filtered and leaves:
        lines += assignment("values", tuple_of(leaves), 8)
        lines += unpacked(leaves, "self.filter.apply(values)")
    held = _gates(data, graph, names, lines)
    flags = (Item(f"{held[k]} == 2", behind=_about(graph.names[k], data)) for k in graph.guarantees)
    lines += returned(tuple_of(flags), 8)
    return [*lines, *_rows(data, graph, names)]


def _rows(data: ConSertData, graph: Graph, names: Sequence[str]) -> list[str]:
    """Return the method that names the flags (SESAME D7.2 Fig 9)."""
    if not data.guarantees:
        return []
    flags = [names[k] for k in graph.guarantees]
    rows = (
        Item(
            Group("{", (Item(text_literal(one.published), '"id": '), Item(flag, '"active": ')), "}")
        )
        for one, flag in zip(data.guarantees, flags, strict=True)
    )
    lines = ["", "    def execute_step(self, source, t_ns=None):"]
    lines += unpacked(flags, "self.step(source)")
    return [*lines, *returned(Group("[", tuple(rows), "]"), 8)]


def _about(name: str, data: ConSertData) -> str:
    path = data.paths.get(name, "")
    return comment(f"{name}: {path}" if path else name)


def _judgement(k: int, leaf: Leaf, value: str) -> list[str]:
    """Return the lines that judge a variable: common values here, the rest by the runtime."""
    judged = f"1 if {value} is None else self.judge({k}, {value})"
    if isinstance(leaf, BinaryLeaf):
        return [
            f"        if {value} is True:",
            f"            {value} = 2",
            "        else:",
            f"            {value} = 0 if {value} is False else {judged}",
        ]
    if isinstance(leaf, CategoricalLeaf):
        if not leaf.covered:
            return [f"        {value} = {judged}"]
        covered = ", ".join(map(text_literal, leaf.covered))
        known = f"{value} = 2 if {value} in {{{covered}}} else 0"
        if len(known) > 88 or not all(map(str.isascii, leaf.covered)):
            return [f"        {value} = {judged}"]
        return [
            f"        if type({value}) is str:",
            f"            {known}",
            "        else:",
            f"            {value} = {judged}",
        ]
    if not 0 < len(leaf.ranges) <= _MAX_RANGES:
        return [f"        {value} = {judged}"]
    lines = [f"        if type({value}) is float or type({value}) is int:"]
    for place, one in enumerate(leaf.ranges):
        lines.append(f"            {'elif' if place else 'if'} {_inside(value, one)}:")
        lines.append(f"                {value} = 2")
    lines += ["            else:"]
    lines += [f"                {value} = 0 if {value} == {value} else 1  # NaN is unknown"]
    return [*lines, "        else:", f"            {value} = {judged}"]


def _inside(value: str, interval: Interval) -> str:
    end = "<=" if interval.closed else "<"
    return f"{number(interval.start)} <= {value} {end} {number(interval.end)}"


def _gates(data: ConSertData, graph: Graph, names: list[str], lines: list[str]) -> list[str]:
    """Append the lines of each gate; return what holds the value of each node."""
    held = names[: graph.leaves]
    for k, (is_and, inputs) in enumerate(graph.nodes, graph.leaves):
        if k not in graph.needed:
            held.append("")
        elif not inputs:
            held.append("2" if is_and else "0")
        elif len(inputs) == 1:
            held.append(held[inputs[0]])
        else:
            held.append(names[k])
            lines.append(f"        # {'And' if is_and else 'Or'} {_about(graph.names[k], data)}")
            lines += _extreme(names[k], "<" if is_and else ">", [held[one] for one in inputs])
    return held


def _extreme(target: str, sign: str, values: Sequence[str]) -> list[str]:
    first, second, *rest = values
    lines = [f"        {target} = {first} if {first} {sign} {second} else {second}"]
    for one in rest:
        lines += [f"        if {one} {sign} {target}:", f"            {target} = {one}"]
    return lines
