"""The lines of a method that reduces lists of a message, as it was read."""

from __future__ import annotations

import math
import re
from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from eddi_scaffold.program.lists import Reduction

VALUES = {
    "lt": "2 if A < B else 0 if A >= B else 1",
    "le": "2 if A <= B else 0 if A > B else 1",
    "gt": "2 if A > B else 0 if A <= B else 1",
    "ge": "2 if A >= B else 0 if A < B else 1",
    "eq": "2 if A == B else 0 if A < B or A > B else 1",
    "ne": "0 if A == B else 2 if A < B or A > B else 1",
    "eq_bool": "1 if A == 1 or B == 1 else 2 - (A ^ B)",
    "ne_bool": "1 if A == 1 or B == 1 else A ^ B",
    "xor": "1 if A == 1 or B == 1 else A ^ B",
    "not": "2 - A",
    "abs": "abs(A)",
    "least": "NAN if A != A or B != B else B if B < A else A",
    "greatest": "NAN if A != A or B != B else B if B > A else A",
    "known": "2 if A == A else 0",
    "known_bool": "0 if A == 1 else 2",
}
"""What a value becomes: no pair but a comparison and its exact negation leaves NaN UNKNOWN."""
_OF_ELEMENTS = {
    **VALUES,
    "and": "min(A, B)",
    "or": "max(A, B)",
    "implies": "max(2 - A, B)",
    "neg": "lists.finite(-A)",
    "add": "lists.finite(A + B)",
    "sub": "lists.finite(A - B)",
    "mul": "lists.finite(A * B)",
    "div": "lists.quotient(A, B)",
    "sqrt": "lists.root(A)",
}
_CONVERSIONS = {"number": "number_of", "bool": "truth_of", "text": "number_in"}
_AGGREGATES = {"average": "average", "stddev": "deviation", "median": "median", "sum": "total"}
_EMPTY = {"list_sum": "0.0", "list_count": "0.0", "list_any": "False"}


def number(value: float | None) -> str:
    """Return a number as it stands in the text."""
    return repr(math.nan if value is None else float(value)).upper().replace("E", "e")


def reduction_lines(reduction: Reduction, names: Sequence[str]) -> Iterator[str]:
    """Yield the lines of a reduction of lists: one for each part, then for each operation."""
    inputs, nodes = reduction.inputs, reduction.nodes
    lists = [name for name, part in zip(names, inputs, strict=True) if part.is_list]
    for x, part in zip(names, inputs, strict=True):
        convert = f"lists.{_CONVERSIONS[part.type]}"
        more = f", {convert}" if part.type != "number" else ""
        yield (
            f"{x} = lists.column({x}, {part.name!r}{more})"
            if part.is_list
            else f"{x} = {convert}({x})"
        )
        if part.type != "bool" and not (part.infinite and part.range is None):
            ends = "" if part.range is None else f", ({', '.join(map(number, part.range))})"
            values, target = (x, x) if part.is_list else (f"[{x}]", f"({x},)")
            yield f"{target} = lists.known({values}{ends}, infinite={part.infinite})"
    length = "" if reduction.length is None else f", {reduction.length}"
    count = f"lists.length_of(({', '.join(lists)},){length})"
    if reduction.sector is not None:
        angles = [names[j] for j in reduction.angles] + [number(end) for end in reduction.sector]
        yield f"count = {count}"
        yield f"first, end = lists.sector(count, {', '.join(angles)})"
        yield from (f"{x} = {x}[first:end]" for x in lists)
    elif length or len(lists) > 1:
        yield count
    empty = _EMPTY.get(reduction.op) if reduction.messages else None
    raised = "raise lists.Unknown('the list is empty')"
    yield f"if not {lists[0]}:\n    {raised if empty is None else f'return {empty}'}"
    texts = [names[node.value] if node.op == "input" else f"r{j}" for j, node in enumerate(nodes)]

    def computed(j: int) -> str:
        node = nodes[j]
        if node.op == "constant":
            return f"r{j} = {number(node.value) if isinstance(node.value, float) else node.value}"
        pairs = [("ab"[at], texts[arg]) for at, arg in enumerate(node.args) if nodes[arg].is_list]
        columns = dict(pairs)
        each = ["ab"[at] if "ab"[at] in columns else texts[arg] for at, arg in enumerate(node.args)]
        text = re.sub(r"\b[AB]\b", lambda of: each["AB".index(of[0])], _OF_ELEMENTS[node.op])
        if not columns:
            return f"r{j} = {text}"
        values = ", ".join(columns.values())
        values = f"zip({values})" if len(columns) > 1 else values
        return f"r{j} = [{text} for {', '.join(columns)} in {values}]"

    made = [j for j, node in enumerate(nodes) if node.op != "input"]
    yield from (computed(j) for j in made if not nodes[j].is_list)
    for j, low, high in reduction.limits:
        yield f"{names[j]} = lists.limited({names[j]}, {texts[low]}, {texts[high]})"
    yield from (computed(j) for j in made if nodes[j].is_list)
    op, value = reduction.op.removeprefix("list_"), texts[reduction.value]
    share = "" if reduction.coverage is None else f", {number(reduction.coverage)}"
    if op in ("any", "all"):
        yield f"return lists.decided({value}, {2 if op == 'any' else 0}{share})"
    elif op == "count":
        yield f"return lists.count({value}{share})"
    else:
        called = f"lists.{_AGGREGATES[op]}" if op in _AGGREGATES else op
        yield f"return lists.aggregate({called}, {value}{share})"
