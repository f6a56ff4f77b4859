"""Reductions of lists in a text: what they read, and their rows in the intermediate form."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from typing import Any

from eddi_scaffold.common.units import converted, find
from eddi_scaffold.conditions.findings import TextFindings
from eddi_scaffold.conditions.form_builder import GraphBuilder
from eddi_scaffold.conditions.scope import BOOL, NUMBER, Scope, Variable
from eddi_scaffold.conditions.syntax import (
    File,
    ReductionOptions,
    SyntaxNode,
    array_of,
    canonical,
    is_list_path,
)
from eddi_scaffold.program.lists import OPERATIONS, TRUTHS

_PLAIN = (*OPERATIONS, "number", "truth", "name", "hypot", "clamp", "number_of")
_KEEP_INFINITY = ("list_min", "list_max", "list_median")
ANGLES = ("angle_min", "angle_max", "angle_increment")
"""Fields of a scan that define the directions of its elements."""


@dataclass
class Elements:
    """The content of the parentheses of one reduction: it is computed for each element.

    Attributes:
        builder: its graph.
        used: variables in the order of their first use.
    """

    builder: GraphBuilder = field(default_factory=lambda: GraphBuilder(0))
    used: dict[str, int] = field(default_factory=dict)

    def objection(self, node: SyntaxNode, scope: Scope) -> str:
        """Return why a node cannot be here, empty when it can."""
        if node.options is not None:
            return "a reduction inside of a reduction: lists of lists are one list"
        if node.op not in _PLAIN:
            return f"{node.op.upper()} remembers earlier steps, a list is of one message"
        is_variable = node.text in scope.variables or not scope.knows(node.text)
        if node.op == "name" and not is_variable and node.text not in scope.constants:
            return f"{node.text} is not part of the message: only its fields, and constants"
        return ""

    def number(self, name: str) -> int:
        """Return the node of a variable that a limit or a sector needs."""
        number = self.used.setdefault(name, len(self.used))
        return self.builder.variable("variable", number, (0, 0))


def elements_of(file: File) -> dict[int, Elements]:
    """Return for each node inside of a reduction where its value goes."""
    found: dict[int, Elements] = {}
    for k, node in enumerate(file.nodes):
        if node.options is not None:
            first = k
            while file.nodes[first].args:
                first = file.nodes[first].args[0]
            inside = Elements()
            found.update((one, inside) for one in range(first, k))
    return found


def reduced(
    file: File,
    root: int,
    elements: Elements,
    nodes: list[int],
    scope: Scope,
    findings: TextFindings,
) -> Variable | None:
    """Return the variable that a reduction is, ``None`` when something is wrong with it.

    Args:
        file: the text.
        root: number of the reduction.
        elements: its graph.
        nodes: of the graph: the value of an element, and the limits of WITHIN.
        scope: what the names mean.
        findings: gets E007 and E009.
    """
    node = file.nodes[root]
    assert node.options is not None
    lists = [name for name in elements.used if is_list_path(name)]
    row: dict[str, Any] = {"op": node.op}
    limits = list(_documented(lists, elements, scope))
    try:
        _one_message(elements.used, lists)
        if node.options.within:
            limits.append([_limited(lists, elements, scope), *nodes[1:]])
        row |= _sector(node.options, lists, elements)
    except _Wrong as wrong:
        at = node.start if wrong.at is None else wrong.at
        findings.add(wrong.case, at, **wrong.fields)
        return None
    needed, new = elements.builder.needed([nodes[0], *(n for limit in limits for n in limit[1:])])
    parts = [_part(name, scope) for name in elements.used]
    row["inputs"] = [_input(part) for part in parts]
    row["nodes"] = [_node(one) for one in needed]
    row["value"] = new[nodes[0]]
    row |= _render_options(
        node.options, [[limit[0], *(new[n] for n in limit[1:])] for limit in limits]
    )
    if array_of(lists[0])[1]:
        row["messages"] = True
    infinite = [part for part in parts if part.name in lists and part.infinite]
    timeouts = [part.timeout for part in parts if part.timeout is not None]
    return Variable(
        canonical(file, root),
        NUMBER if node.op == "list_count" or node.op not in TRUTHS else BOOL,
        timeout=min(timeouts, default=None),
        infinite=node.op in _KEEP_INFINITY and bool(infinite),
        defined=all(one.defined for one in infinite),
        reduction=row,
        parts=tuple(parts),
    )


class _Wrong(Exception):  # noqa: N818 - it ends one reduction
    def __init__(self, case: str, at: int | None = None, /, **fields: str) -> None:
        super().__init__(case)
        self.case, self.at, self.fields = case, at, fields


def _head(name: str) -> str:
    return name.partition(".")[0].partition("[")[0]


def _one_message(names: Iterable[str], lists: list[str]) -> None:
    """Check that everything is of one message, and the lists have one length."""
    heads = list(dict.fromkeys(_head(name) for name in names))
    if len(heads) > 1:
        raise _Wrong("E007.two_messages", first=heads[0], second=heads[1])
    if len({array_of(name)[0] for name in lists}) > 1 and len(set(map(_place_of, lists))) > 1:
        raise _Wrong("E007.two_lists", first=lists[0], second=lists[1])


def _place_of(name: str) -> tuple[str, str, str]:
    """Return in what a plain list lies, and which part of it is taken; no two others are equal."""
    array, rest = array_of(name)
    before, _, part = array.rpartition("[")
    parent, _, _ = before.rpartition(".")
    return (parent, part, "") if not rest and not is_list_path(parent) else (name, part, rest)


def _documented(lists: list[str], elements: Elements, scope: Scope) -> Iterator[list[int]]:
    """Yield the limits that the messages document: input, nodes of the limits."""
    for name in lists:
        within = scope.variables[name].within
        if within is not None:
            yield [elements.used[name], *(elements.number(one) for one in within)]


def _limited(lists: list[str], elements: Elements, scope: Scope) -> int:
    numbers = [name for name in lists if scope.variables[name].type == NUMBER]
    if len(numbers) != 1:
        raise _Wrong("E007.within")
    return elements.used[numbers[0]]


def unit_of_list(elements: Elements, scope: Scope) -> str | None:
    """Return the unit of the elements, ``None`` for none or several lists."""
    units = {scope.variables[name].unit for name in elements.used if is_list_path(name)}
    return units.pop() if len(units) == 1 else None


def _sector(options: ReductionOptions, lists: list[str], elements: Elements) -> Mapping[str, Any]:
    if options.sector is None:
        return {}
    ends = []
    for end in options.sector:
        unit = find(end.unit) if end.unit else None
        if unit is None or unit.dimension != "angle":
            raise _Wrong("E009.sector", end.at)
        ends.append(converted(end.value, end.unit or "", "rad"))
    at = dict(options.at)["SECTOR"]
    if ends[0] >= ends[1]:
        raise _Wrong("E007.empty_sector", at)
    scans = {_place_of(name)[0] for name in lists if not array_of(name)[1]}
    if len(lists) != 1 or len(scans) != 1 or not array_of(lists[0])[0].endswith("[*]"):
        raise _Wrong("E007.scan", at)
    (scan,) = scans
    for angle in ANGLES:
        elements.number(f"{scan}.{angle}")
    return {"sector": ends, "angles": [elements.used[f"{scan}.{angle}"] for angle in ANGLES]}


def _part(name: str, scope: Scope) -> Variable:
    return scope.variables.get(name) or Variable(name, NUMBER, declared=False)


def _input(part: Variable) -> dict[str, Any]:
    kind = part.type.kind if part.type is not None else "number"
    row: dict[str, Any] = {"name": part.name, "type": kind}
    if is_list_path(part.name):
        row["list"] = True
    if part.range is not None:
        row["range"] = list(part.range)
    if part.infinite:
        row["infinite"] = True
    return row


def _node(row: Mapping[str, Any]) -> dict[str, Any]:
    if row["op"] == "variable":
        return {"op": "input", "value": row["value"]}
    if row["op"] in ("number", "truth"):
        return {"op": "constant", "value": row["value"]}
    return {"op": row["op"], "args": row["args"]}


def _render_options(options: ReductionOptions, limits: list[list[int]]) -> dict[str, Any]:
    rendered: dict[str, Any] = {"limits": limits} if limits else {}
    if options.coverage is not None:
        rendered["coverage"] = options.coverage
    if options.length is not None:
        rendered["length"] = list(options.length)
    return rendered
