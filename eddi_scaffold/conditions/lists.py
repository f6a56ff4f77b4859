"""Reductions of lists in a text: what they read, and what the program does with them."""

from __future__ import annotations

import math
from collections.abc import Sequence

from eddi_scaffold.common.units import converted, find
from eddi_scaffold.conditions.graph import At, GraphBuilder
from eddi_scaffold.conditions.scope import NUMBER, Scope, Variable, result_of
from eddi_scaffold.conditions.syntax import (
    File,
    ReductionOptions,
    SyntaxNode,
    array_of,
    canonical,
    first_below,
    is_list_path,
)
from eddi_scaffold.conditions.tokens import TextFindings
from eddi_scaffold.program.lists import OPERATIONS, Element, Part, Reduction

_ALLOWED = (*OPERATIONS, "number", "truth", "name", "hypot", "clamp", "number_of")
_KEEP_INFINITY = ("list_min", "list_max", "list_median")
_ELEMENTS = {"variable": "input", "number": "constant", "truth": "constant"}
"""Operation of the text -> what it is among the elements."""
_ANGLES = ("angle_min", "angle_max", "angle_increment")
"""Fields of a scan that define the directions of its elements."""


class Elements(GraphBuilder):
    """The content of the parentheses of a reduction: it is computed for each element."""

    @property
    def lists(self) -> list[str]:
        """The variables that are lists."""
        return [name for name in self.used if is_list_path(name)]

    def allows(self, node: SyntaxNode, scope: Scope) -> bool:
        """Return whether a node can be here."""
        is_outside = scope.knows(node.text) and node.text not in {
            *scope.variables,
            *scope.constants,
        }
        return (
            node.options is None and node.op in _ALLOWED and not (node.op == "name" and is_outside)
        )

    def unit(self, scope: Scope) -> str | None:
        """Return the unit of the elements, ``None`` for none or several lists."""
        units = {scope.variables[name].unit for name in self.lists}
        return units.pop() if len(units) == 1 else None


def elements_of(file: File) -> dict[int, Elements]:
    """Return for each node inside of a reduction where its value goes."""
    places: dict[int, Elements] = {}
    for k, node in enumerate(file.nodes):
        if node.options is not None:
            places |= dict.fromkeys(range(first_below(file, k), k), Elements())
    return places


def reduced(
    file: File,
    root: int,
    elements: Elements,
    nodes: Sequence[int],
    scope: Scope,
    findings: TextFindings,
) -> Variable:
    """Return the variable that a reduction is.

    Raises:
        Refused: something is wrong with it.
    """
    node, options, lists = file.nodes[root], file.nodes[root].options, elements.lists
    assert options is not None
    limits = [  # those that the messages document: input, nodes of the limits
        [elements.used[name], *(elements.variable(limit, At()) for limit in within)]
        for name in lists
        if (within := scope.variables[name].within) is not None
    ]
    numbers = [name for name in lists if scope.variables[name].type == NUMBER]
    heads = list(dict.fromkeys(name.partition(".")[0].partition("[")[0] for name in elements.used))
    if len(heads) > 1:
        findings.refuse("E007.two_messages", node.start, first=heads[0], second=heads[1])
    if len({array_of(name)[0] for name in lists}) > 1 and len(set(map(_container, lists))) > 1:
        findings.refuse("E007.two_lists", node.start, first=lists[0], second=lists[1])
    if options.within:
        if len(numbers) != 1:
            findings.refuse("E007.within", node.start)
        limits.append([elements.used[numbers[0]], *nodes[1:]])
    sector = _sector(options, lists, elements, findings)
    rows, new = elements.needed([nodes[0], *(n for limit in limits for n in limit[1:])])
    parts = [
        scope.variables.get(name) or Variable(name, NUMBER, declared=False)
        for name in elements.used
    ]
    kinds = (part.type.kind if part.type is not None else "number" for part in parts)
    inputs = tuple(
        Part(part.name, kind, is_list_path(part.name), part.range, part.infinite)
        for part, kind in zip(parts, kinds, strict=True)
    )
    computed: list[Element] = []
    for row in rows:
        op, value = _ELEMENTS.get(row.op, row.op), row.value
        sources = [inputs[value]] if op == "input" else [computed[n] for n in row.args]
        value = math.nan if row.op == "number" and value is None else value
        computed.append(Element(op, row.args, value, any(source.is_list for source in sources)))
    infinite = [part for part in parts if part.name in lists and part.infinite]
    return Variable(
        canonical(file, root),
        result_of(node.op),
        timeout=min((part.timeout for part in parts if part.timeout is not None), default=None),
        infinite=node.op in _KEEP_INFINITY and bool(infinite),
        defined=all(part.defined for part in infinite),
        reduction=Reduction(
            node.op,
            inputs,
            tuple(computed),
            new[nodes[0]],
            tuple((place, new[low], new[high]) for place, low, high in limits),
            node.coverage,
            options.length,
            *sector,
            bool(array_of(lists[0])[1]),
        ),
        parts=tuple(parts),
    )


def _container(name: str) -> tuple[str, str, str]:
    """Return in what a plain list lies, and which part of it is taken; no two others are equal."""
    array, rest = array_of(name)
    before, _, part = array.rpartition("[")
    parent, _, _ = before.rpartition(".")
    return (parent, part, "") if not rest and not is_list_path(parent) else (name, part, rest)


def _sector(
    options: ReductionOptions, lists: list[str], elements: Elements, findings: TextFindings
) -> tuple[tuple[float, float] | None, tuple[int, ...]]:
    """Return the angles of a sector, and the inputs with those of the scan."""
    ends = []
    for end in options.sector or ():
        unit = find(end.unit) if end.unit else None
        if unit is None or unit.dimension != "angle":
            findings.refuse("E009.sector", end.at)
        ends.append(converted(end.value, end.unit or "", "rad"))
    if not ends:
        return None, ()
    if ends[0] >= ends[1]:
        findings.refuse("E007.empty_sector", options.sector_at)
    scan = _container(lists[0])[0]
    array, rest = array_of(lists[0])
    if len(lists) != 1 or rest or not array.endswith("[*]"):
        findings.refuse("E007.scan", options.sector_at)
    for angle in _ANGLES:
        elements.variable(f"{scan}.{angle}", At())
    angles = tuple(elements.used[f"{scan}.{angle}"] for angle in _ANGLES)
    return (ends[0], ends[1]), angles
