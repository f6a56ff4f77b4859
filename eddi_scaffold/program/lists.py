"""Reductions of the lists of a message: the nearest obstacle of a scan, the share of what holds."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from eddi_scaffold.program.python_text import Part as Text
from eddi_scaffold.program.python_text import (
    assignment,
    call,
    comment,
    literal,
    number,
    returned,
    statement,
    text_literal,
    tuple_of,
)

AGGREGATES = ("list_min", "list_max", "list_median", "list_sum", "list_average", "list_stddev")
"""Reductions of numbers."""
TRUTHS = ("list_count", "list_any", "list_all")
"""Reductions of truth values."""
OPERATIONS = (
    *("neg", "abs", "sqrt", "least", "greatest", "add", "sub", "mul", "div"),
    *("lt", "le", "gt", "ge", "eq", "ne", "eq_bool", "ne_bool"),
    *("xor", "and", "or", "not", "implies", "known", "known_bool"),
)
"""What can be done with one element and with numbers of its message."""


@dataclass(frozen=True)
class Part:
    """A list or a number of the message.

    Attributes:
        name: as in the text.
        type: ``number``, ``bool`` or ``text``.
        is_list: a list of these.
        range: least and greatest value; None for no limits.
        infinite: infinity is a value.
    """

    name: str
    type: str
    is_list: bool
    range: tuple[float, float] | None
    infinite: bool


@dataclass(frozen=True)
class Element:
    """An operation on elements, or on numbers of the message.

    Attributes:
        op: ``input``, ``constant``, or one of ``OPERATIONS``.
        args: numbers of the nodes it works on.
        value: number of the input, or the constant.
        is_list: it has a value for each element.
    """

    op: str
    args: tuple[int, ...]
    value: Any
    is_list: bool


@dataclass(frozen=True)
class Reduction:
    """One value of the lists of a message.

    Attributes:
        op: one of ``AGGREGATES`` or ``TRUTHS``.
        inputs: what it reads, lists first or last as they come.
        nodes: what is computed, each argument before its use.
        value: number of the node that is reduced.
        limits: input, and the nodes of its limits.
        coverage: share of known elements that is enough; None: all.
        length: least and most elements; None: any.
        sector: angles from and to; None: all.
        angles: numbers of the inputs with the angles of the scan.
        messages: a list of messages can be empty.
    """

    op: str
    inputs: tuple[Part, ...]
    nodes: tuple[Element, ...]
    value: int
    limits: tuple[tuple[int, int, int], ...]
    coverage: float | None
    length: tuple[int, int] | None
    sector: tuple[float, float] | None
    angles: tuple[int, ...]
    messages: bool


ON_VALUES = {
    "lt": "2 if {0} < {1} else 0 if {0} >= {1} else 1",
    "le": "2 if {0} <= {1} else 0 if {0} > {1} else 1",
    "gt": "2 if {0} > {1} else 0 if {0} <= {1} else 1",
    "ge": "2 if {0} >= {1} else 0 if {0} < {1} else 1",
    "eq": "2 if {0} == {1} else 0 if {0} < {1} or {0} > {1} else 1",
    "ne": "0 if {0} == {1} else 2 if {0} < {1} or {0} > {1} else 1",
    "eq_bool": "1 if {0} == 1 or {1} == 1 else 2 - ({0} ^ {1})",
    "ne_bool": "1 if {0} == 1 or {1} == 1 else {0} ^ {1}",
    "xor": "1 if {0} == 1 or {1} == 1 else {0} ^ {1}",
    "not": "2 - {0}",
    "abs": "abs({0})",
    "least": "NAN if {0} != {0} or {1} != {1} else {1} if {1} < {0} else {0}",
    "greatest": "NAN if {0} != {0} or {1} != {1} else {1} if {1} > {0} else {0}",
    "known": "2 if {0} == {0} else 0",
    "known_bool": "0 if {0} == 1 else 2",
}
"""Operation on one value, or on one element -> its Python, of names and numbers."""
_OF_ELEMENTS = {
    **ON_VALUES,
    "and": "min({0}, {1})",
    "or": "max({0}, {1})",
    "implies": "max(2 - {0}, {1})",
    "neg": "{p}finite(-{0})",
    "add": "{p}finite({0} + {1})",
    "sub": "{p}finite({0} - {1})",
    "mul": "{p}finite({0} * {1})",
    "div": "{p}quotient({0}, {1})",
    "sqrt": "{p}root({0})",
}
_AGGREGATES = {
    "list_min": "min",
    "list_max": "max",
    "list_median": "{p}median",
    "list_sum": "{p}total",
    "list_average": "{p}average",
    "list_stddev": "{p}deviation",
}
_EMPTY = {"list_sum": "0.0", "list_count": "0.0", "list_any": "False"}
"""Value of an empty list of messages; any other empty list is UNKNOWN."""
_CONVERSIONS = {"number": "number_of", "bool": "truth_of", "text": "number_in"}


def reduction_lines(number_: int, name: str, reduction: Reduction, prefix: str) -> list[str]:
    """Return the method of a reduction.

    Args:
        number_: of the variable.
        name: of the variable: the reduction as in the text.
        reduction: what it is.
        prefix: of what it calls.
    """
    lists = [k for k, input_ in enumerate(reduction.inputs) if input_.is_list]
    arguments = "".join(f", x{k}" for k in range(len(reduction.inputs)))
    lines = [f"    def reduce_{number_}(self{arguments}):", f"        # {comment(name)}"]
    for k, part in enumerate(reduction.inputs):
        lines += _read(f"x{k}", part, prefix)
    lines += _shortened(reduction, lists, prefix)
    empty = _EMPTY.get(reduction.op) if reduction.messages else None
    lines += [f"        if not x{lists[0]}:"]
    lines += [
        f'            raise {prefix}Unknown("the list is empty")'
        if empty is None
        else f"            return {empty}"
    ]
    nodes = list(enumerate(reduction.nodes))
    for k, node in nodes:
        if not node.is_list and node.op != "input":
            lines += _node(k, node, reduction, prefix)
    for k, low, high in reduction.limits:
        ends = (_name(one, reduction) for one in (low, high))
        lines += [f"        x{k} = {prefix}limited(x{k}, {', '.join(ends)})"]
    for k, node in nodes:
        if node.is_list and node.op != "input":
            lines += _node(k, node, reduction, prefix)
    return [*lines, *returned(_result(reduction, prefix), 8)]


def _read(name: str, part: Part, prefix: str) -> list[str]:
    """Return the lines that make a raw list or number what the reduction computes with."""
    convert = f"{prefix}{_CONVERSIONS[part.type]}"
    if part.is_list:
        more = [convert] if part.type != "number" else []
        lines = assignment(name, call(f"{prefix}column", [name, text_literal(part.name), *more]), 8)
    else:
        lines = [f"        {name} = {convert}({name})"]
    if part.type == "bool" or (part.infinite and part.range is None):
        return lines
    limits = [] if part.range is None else [literal(part.range)]
    values = name if part.is_list else f"[{name}]"
    known = call(f"{prefix}known", [values, *limits], infinite=literal(part.infinite))
    return [*lines, *assignment(name if part.is_list else f"({name},)", known, 8)]


def _shortened(reduction: Reduction, lists: list[int], prefix: str) -> list[str]:
    """Return the lines that check how long the lists are, and cut a sector out of them."""
    if reduction.length is None and reduction.sector is None and len(lists) == 1:
        return []
    wanted = [] if reduction.length is None else [literal(reduction.length)]
    count = call(f"{prefix}length_of", [tuple_of(f"x{k}" for k in lists), *wanted])
    if reduction.sector is None:
        return statement(count, 8)
    angles = [f"x{k}" for k in reduction.angles]
    ends = [number(one) for one in reduction.sector]
    lines = assignment("count", count, 8)
    lines += assignment("first, end", call(f"{prefix}sector", ["count", *angles, *ends]), 8)
    return [*lines, *(f"        x{k} = x{k}[first:end]" for k in lists)]


def _name(node: int, reduction: Reduction) -> str:
    one = reduction.nodes[node]
    return f"x{one.value}" if one.op == "input" else f"r{node}"


def _node(number_: int, node: Element, reduction: Reduction, prefix: str) -> list[str]:
    if node.op == "constant":
        return [f"        r{number_} = {literal(node.value)}"]
    names = [_name(k, reduction) for k in node.args]
    columns = [k for k, arg in enumerate(node.args) if reduction.nodes[arg].is_list]
    each = list(names)
    for k in columns:
        each[k] = "ab"[k]
    text = _OF_ELEMENTS[node.op].format(*each, p=prefix)
    if not columns:
        return [f"        r{number_} = {text}"]
    target = ", ".join("ab"[k] for k in columns)
    values = ", ".join(names[k] for k in columns)
    values = f"zip({values})" if len(columns) > 1 else values
    return [f"        r{number_} = [{text} for {target} in {values}]"]


def _result(reduction: Reduction, prefix: str) -> Text:
    values = _name(reduction.value, reduction)
    coverage = [] if reduction.coverage is None else [literal(reduction.coverage)]
    if reduction.op not in TRUTHS:
        how = _AGGREGATES[reduction.op].format(p=prefix)
        return call(f"{prefix}aggregate", [how, values, *coverage])
    if reduction.op == "list_count":
        return call(f"{prefix}count", [values, *coverage])
    decisive = "2" if reduction.op == "list_any" else "0"
    return call(f"{prefix}decided", [values, decisive, *coverage])
