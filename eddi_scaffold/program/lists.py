"""Reductions of the lists of a message: the nearest obstacle of a scan, the share of what holds.

In Python every operation is done on columns, one after the other.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

from eddi_scaffold.program import python_text
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

TRUTHS = ("list_count", "list_any", "list_all")  # reductions of truth values
OPERATIONS = (
    *("neg", "abs", "sqrt", "least", "greatest", "add", "sub", "mul", "div"),
    *("lt", "le", "gt", "ge", "eq", "ne", "eq_bool", "ne_bool"),
    *("xor", "and", "or", "not", "implies", "known", "known_bool"),
)
"""What can be done with one element and with numbers of its message."""


@dataclass(frozen=True)
class Part:
    """A list or a number of the message."""

    name: str  # as in the text
    type: str  # `number`, `bool` or `text`
    is_list: bool  # a list of these
    range: tuple[float, float] | None  # least and greatest value; None for no limits
    infinite: bool  # infinity is a value


@dataclass(frozen=True)
class Element:
    """An operation on elements, or on numbers of the message."""

    op: str  # `input`, `constant`, or one of `OPERATIONS`
    args: tuple[int, ...]  # numbers of the nodes it works on
    value: Any  # number of the input, or the constant
    is_list: bool  # it has a value for each element


@dataclass(frozen=True)
class Reduction:
    """One value of the lists of a message."""

    op: str  # `list_min` and others of numbers, or one of `TRUTHS`
    inputs: tuple[Part, ...]  # what it reads, lists first or last as they come
    nodes: tuple[Element, ...]  # what is computed, each argument before its use
    value: int  # number of the node that is reduced
    limits: tuple[tuple[int, int, int], ...]  # input, and the nodes of its limits
    coverage: float | None  # share of known elements that is enough; None: all
    length: tuple[int, int] | None  # least and most elements; None: any
    sector: tuple[float, float] | None  # angles from and to; None: all
    angles: tuple[int, ...]  # numbers of the inputs with the angles of the scan
    messages: bool  # a list of messages can be empty


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
    """Return the method of a reduction."""
    arguments = "".join(f", x{k}" for k in range(len(reduction.inputs)))
    head = [f"    def reduce_{number_}(self{arguments}):", f"        # {comment(name)}"]
    return [*head, *_Columns(reduction, prefix).lines()]


class _Columns:
    """The columns of one reduction: ``x0`` is its first input, ``r0`` the first thing computed."""

    def __init__(self, reduction: Reduction, prefix: str) -> None:
        self.reduction = reduction
        self.prefix = prefix
        self.lists = [k for k, input_ in enumerate(reduction.inputs) if input_.is_list]

    def lines(self) -> Iterator[str]:
        """Yield the lines of the method."""
        reduction = self.reduction
        for k, part in enumerate(reduction.inputs):
            yield from self._read(f"x{k}", part)
        if reduction.length is not None or reduction.sector is not None or len(self.lists) > 1:
            yield from self._shortened()
        empty = _EMPTY.get(reduction.op) if reduction.messages else None
        yield f"        if not x{self.lists[0]}:"
        yield (
            f'            raise {self.prefix}Unknown("the list is empty")'
            if empty is None
            else f"            return {empty}"
        )
        computed = [(k, node) for k, node in enumerate(reduction.nodes) if node.op != "input"]
        yield from (self._computed(k, node) for k, node in computed if not node.is_list)
        for k, low, high in reduction.limits:
            limits = f"{self._name(low)}, {self._name(high)}"
            yield f"        x{k} = {self.prefix}limited(x{k}, {limits})"
        yield from (self._computed(k, node) for k, node in computed if node.is_list)
        yield from returned(self._result(), 8)

    def _read(self, name: str, part: Part) -> Iterator[str]:
        """Yield the lines that make a raw list or number what the reduction computes with."""
        convert = f"{self.prefix}{_CONVERSIONS[part.type]}"
        if part.is_list:
            more = [convert] if part.type != "number" else []
            column = call(f"{self.prefix}column", [name, text_literal(part.name), *more])
            yield from assignment(name, column, 8)
        else:
            yield f"        {name} = {convert}({name})"
        if part.type == "bool" or (part.infinite and part.range is None):
            return
        limits = [] if part.range is None else [literal(part.range)]
        values = name if part.is_list else f"[{name}]"
        known = call(f"{self.prefix}known", [values, *limits], infinite=literal(part.infinite))
        yield from assignment(name if part.is_list else f"({name},)", known, 8)

    def _shortened(self) -> Iterator[str]:
        """Yield the lines that check how long the lists are, and cut a sector out of them."""
        sector, length = self.reduction.sector, self.reduction.length
        limits = [] if length is None else [literal(length)]
        lists = tuple_of(f"x{k}" for k in self.lists)
        count = call(f"{self.prefix}length_of", [lists, *limits])
        if sector is None:
            yield from statement(count, 8)
            return
        angles = [*(f"x{k}" for k in self.reduction.angles), *map(number, sector)]
        yield from assignment("count", count, 8)
        ends = call(f"{self.prefix}sector", ["count", *angles])
        yield from assignment("first, end", ends, 8)
        yield from (f"        x{k} = x{k}[first:end]" for k in self.lists)

    def _name(self, k: int) -> str:
        node = self.reduction.nodes[k]
        return f"x{node.value}" if node.op == "input" else f"r{k}"

    def _computed(self, k: int, node: Element) -> str:
        if node.op == "constant":
            return f"        r{k} = {literal(node.value)}"
        names = [self._name(arg) for arg in node.args]
        columns = [at for at, arg in enumerate(node.args) if self.reduction.nodes[arg].is_list]
        each = ["ab"[at] if at in columns else name for at, name in enumerate(names)]
        text = _OF_ELEMENTS[node.op].format(*each, p=self.prefix)
        if not columns:
            return f"        r{k} = {text}"
        target = ", ".join("ab"[at] for at in columns)
        values = ", ".join(names[at] for at in columns)
        values = f"zip({values})" if len(columns) > 1 else values
        return f"        r{k} = [{text} for {target} in {values}]"

    def _result(self) -> python_text.Part:
        op, prefix = self.reduction.op, self.prefix
        values, share = self._name(self.reduction.value), self.reduction.coverage
        coverage = [] if share is None else [literal(share)]
        if op == "list_count":
            return call(f"{prefix}count", [values, *coverage])
        if op in TRUTHS:
            decisive = "2" if op == "list_any" else "0"
            return call(f"{prefix}decided", [values, decisive, *coverage])
        return call(f"{prefix}aggregate", [_AGGREGATES[op].format(p=prefix), values, *coverage])
