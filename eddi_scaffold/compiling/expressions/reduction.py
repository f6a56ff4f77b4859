"""Reductions of lists as ``json`` gives them, checked."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any

from eddi_scaffold.compiling.document import ModelError, take
from eddi_scaffold.compiling.program.reduction import (
    AGGREGATES,
    OPERATIONS,
    TRUTHS,
    Element,
    Part,
    Reduction,
)

_TYPES = ("number", "bool", "text")


def read_reduction(row: Mapping[str, Any], where: str) -> Reduction:
    """Check what the language made, as ``json`` gives it.

    Raises:
        ModelError: it is damaged.
    """
    try:
        return _reduction(row)
    except (ArithmeticError, AttributeError, LookupError, TypeError, ValueError) as problem:
        raise ModelError("", f"the reduction of {where} is damaged: {problem}") from None


def _reduction(row: Mapping[str, Any]) -> Reduction:
    op = take(row, "op", str, "it")
    if op not in AGGREGATES and op not in TRUTHS:
        raise ValueError(f"there is no reduction {op!r}")
    inputs = tuple(_part(one) for one in take(row, "inputs", list, "it"))
    nodes: list[Element] = []
    for item in take(row, "nodes", list, "it"):
        nodes.append(_element(item, nodes, inputs))
    limits = tuple((one, low, high) for one, low, high in row.get("limits", ()))
    found = Reduction(
        op,
        inputs,
        tuple(nodes),
        take(row, "value", int, "it"),
        limits,
        None if row.get("coverage") is None else _number(row["coverage"]),
        _pair(row.get("length")),
        _pair(row.get("sector")),
        tuple(row.get("angles", ())),
        row.get("messages") is True,
    )
    _check(found)
    return found


def _check(found: Reduction) -> None:
    ends = [node for limit in found.limits for node in limit[1:]]
    lists = [one for one, _, _ in found.limits]
    if not any(input_.is_list for input_ in found.inputs):
        raise IndexError("a reduction without a list")
    _among([found.value, *ends], len(found.nodes))
    _among([*lists, *found.angles], len(found.inputs))
    if not found.nodes[found.value].is_list or any(found.nodes[k].is_list for k in ends):
        raise ValueError("a list is reduced, and its limits are numbers")
    if not all(found.inputs[k].is_list for k in lists):
        raise ValueError("limits are those of a list")
    if any(found.inputs[k].is_list for k in found.angles):
        raise ValueError("an angle is a number")
    if found.sector is not None and len(found.angles) != 3:
        raise ValueError("a sector needs three angles")


def _among(numbers: Sequence[Any], count: int) -> None:
    if not all(type(k) is int and 0 <= k < count for k in numbers):
        raise IndexError("a number of what is not there")


def _part(item: Any) -> Part:
    kind = take(item, "type", str, "an input")
    if kind not in _TYPES:
        raise ValueError(f"an input has the unknown type {kind!r}")
    limits = _pair(item.get("range"))
    name = take(item, "name", str, "an input")
    return Part(name, kind, item.get("list") is True, limits, item.get("infinite") is True)


def _element(item: Any, before: Sequence[Element], inputs: Sequence[Part]) -> Element:
    op = take(item, "op", str, "a node")
    args, value = tuple(item.get("args", ())), item.get("value")
    if op == "input":
        _among([value], len(inputs))
        return Element(op, (), value, inputs[value].is_list)
    if op == "constant":
        return Element(op, (), value if type(value) is int else _constant(value), is_list=False)
    if op not in OPERATIONS:
        raise ValueError(f"a node has the unknown operation {op!r}")
    _among(args, len(before))
    if len(args) != (1 if op in _UNARY else 2):
        raise ValueError(f"{op!r} of {len(args)} nodes")
    return Element(op, args, None, any(before[k].is_list for k in args))


_UNARY = ("neg", "abs", "sqrt", "not", "known", "known_bool")


def _constant(value: Any) -> float:
    return math.nan if value is None else _number(value)


def _pair(value: Any) -> Any:
    if value is None:
        return None
    low, high = value
    return _number(low), _number(high)


def _number(value: Any) -> Any:
    if type(value) not in (int, float) or not math.isfinite(value):
        raise ValueError(f"{value!r} is no finite number")
    return value
