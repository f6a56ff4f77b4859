"""The intermediate form of events: a typed expression graph in JSON, checked before it is used.

``nodes`` are in the order of evaluation, each argument before its use; equal sub-expressions are
one node. No name takes part in the evaluation: variables are numbered.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any

from eddi_scaffold.compiling.document import ModelError, take
from eddi_scaffold.compiling.expressions.reduction import read_reduction
from eddi_scaffold.compiling.expressions.words import words_of
from eddi_scaffold.compiling.program.building import Builder
from eddi_scaffold.compiling.program.instructions import (
    BOOL,
    BUFFERED,
    ENUM,
    LEAVES,
    MAX_NS,
    NUMBER,
    WINDOWS,
    Operation,
    Program,
    Read,
    Result,
)

VERSION = 1
TYPES = (NUMBER, BOOL, ENUM)
NUMBERS = (NUMBER, NUMBER)
TRUTHS = (BOOL, BOOL)
SIGNATURES: Mapping[str, tuple[tuple[str, ...], str]] = {
    "neg": ((NUMBER,), NUMBER),
    "abs": ((NUMBER,), NUMBER),
    "sqrt": ((NUMBER,), NUMBER),
    "least": (NUMBERS, NUMBER),
    "greatest": (NUMBERS, NUMBER),
    "add": (NUMBERS, NUMBER),
    "sub": (NUMBERS, NUMBER),
    "mul": (NUMBERS, NUMBER),
    "div": (NUMBERS, NUMBER),
    "lt": (NUMBERS, BOOL),
    "le": (NUMBERS, BOOL),
    "gt": (NUMBERS, BOOL),
    "ge": (NUMBERS, BOOL),
    "eq": (NUMBERS, BOOL),
    "ne": (NUMBERS, BOOL),
    "eq_bool": (TRUTHS, BOOL),
    "ne_bool": (TRUTHS, BOOL),
    "eq_enum": ((ENUM, ENUM), BOOL),
    "ne_enum": ((ENUM, ENUM), BOOL),
    "and": (TRUTHS, BOOL),
    "or": (TRUTHS, BOOL),
    "xor": (TRUTHS, BOOL),
    "implies": (TRUTHS, BOOL),
    "not": ((BOOL,), BOOL),
    "average": ((NUMBER,), NUMBER),
    "sum": ((NUMBER,), NUMBER),
    "max": ((NUMBER,), NUMBER),
    "min": ((NUMBER,), NUMBER),
    "median": ((NUMBER,), NUMBER),
    "stddev": ((NUMBER,), NUMBER),
    "rate": ((NUMBER,), NUMBER),
    "count": ((BOOL,), NUMBER),
    "time": ((BOOL,), BOOL),
    "once": ((BOOL,), BOOL),
    "rise": ((BOOL,), BOOL),
    "fall": ((BOOL,), BOOL),
    "edge": ((BOOL,), BOOL),
    "latch": (TRUTHS, BOOL),
    "hysteresis": ((NUMBER, NUMBER, NUMBER), BOOL),
    "elapsed": ((BOOL,), NUMBER),
    "known": ((NUMBER,), BOOL),
    "known_bool": ((BOOL,), BOOL),
    "known_enum": ((ENUM,), BOOL),
    "age": ((), NUMBER),
}
"""Operation -> types of its arguments and of its value; ``age`` names a variable."""
MAX_CAPACITY = 1 << 20
"""Samples in one window: 16 MB in C."""
KEEPS_INFINITY = ("abs", "least", "greatest", "max", "min", "median")
"""Operations whose value can be infinite when an argument is."""


def read_form(document: Mapping[str, Any]) -> Program:
    """Check an intermediate form, as ``json`` gives it, and return its program.

    Raises:
        ModelError: the form is damaged or of another version.
    """
    where = "the form"
    if take(document, "version", int, where) != VERSION:
        raise ModelError("", f"the form has another version than {VERSION}")
    period = _check_bounds(take(document, "period", int, where), "period", 0)
    rows = take(document, "nodes", list, where)
    aged = {row.get("value") for row in rows if isinstance(row, dict) and row.get("op") == "age"}
    reads = tuple(
        _read(item, f"variable {k}", aged=k in aged)
        for k, item in enumerate(take(document, "variables", list, where))
    )
    operations: list[Operation] = []
    for row in rows:
        operations.append(_operation(row, f"node {len(operations)}", reads, operations, period))
    results = tuple(
        _result(item, f"output {k}", len(operations))
        for k, item in enumerate(take(document, "outputs", list, where))
    )
    if not results or len({result.id for result in results}) != len(results):
        raise ModelError("", "the outputs are none, or two have one id")
    words = words_of(reads, operations)
    told = (
        operation._replace(about=f"{operation.about} {text}")
        for operation, text in zip(operations, words, strict=True)
    )
    return Program(period, reads, tuple(told), results)


def joined(programs: Sequence[Program]) -> Program:
    """Return one program with the first result of each, in which equal reads are one.

    Raises:
        ModelError: they are for different rates.
    """
    if len({one.period for one in programs}) > 1:
        raise ModelError("", "the parts of an expression have different rates")
    builder = Builder()
    results = []
    for program in programs:
        places = builder.append(program)
        result = program.results[0]
        results.append(result._replace(operation=places[result.operation]))
    return builder.program(programs[0].period, results)


def _check_bounds(value: int, name: str, least: int) -> int:
    if not least <= value <= MAX_NS:
        raise ModelError("", f"{name} {value} is out of bounds")
    return value


def _finite(value: Any, where: str) -> float:
    if isinstance(value, (int, float)) and not isinstance(value, bool) and math.isfinite(value):
        return float(value)
    raise ModelError("", f"{where} is not a finite number")


def _read(item: Any, where: str, *, aged: bool) -> Read:
    kind = take(item, "type", str, where)
    if kind not in TYPES:
        raise ModelError("", f"{where} has the unknown type {kind!r}")
    limits = item.get("range")
    if limits is not None:
        if not isinstance(limits, list) or len(limits) != 2:
            raise ModelError("", f"'range' of {where} is not a pair of numbers")
        limits = (_finite(limits[0], where), _finite(limits[1], where))
    timeout = item.get("timeout")
    if timeout is not None:
        _check_bounds(take(item, "timeout", int, where), "timeout", 1)
    literals = item.get("literals", [])
    if not isinstance(literals, list) or not all(isinstance(literal, str) for literal in literals):
        raise ModelError("", f"'literals' of {where} is not a list of texts")
    reduction = item.get("reduction")
    return Read(
        name=take(item, "name", str, where),
        type=kind,
        range=limits,
        timeout=timeout,
        infinite=item.get("infinite") is True,
        literals=tuple(literals),
        stamped=aged or timeout is not None,
        text=item.get("text") is True,
        reduction=None if reduction is None else read_reduction(reduction, where),
    )


def _operation(
    row: Any, where: str, reads: Sequence[Read], before: Sequence[Operation], period: int
) -> Operation:
    op = take(row, "op", str, where)
    args = tuple(row.get("args", []))
    if not all(type(k) is int and 0 <= k < len(before) for k in args):
        raise ModelError("", f"{where} works on a node that is not before it")
    at = row.get("at", [0, 0])
    if not isinstance(at, list) or len(at) != 2 or not all(type(k) is int for k in at):
        raise ModelError("", f"'at' of {where} is not a pair of numbers")
    more: dict[str, Any] = {}
    if op in LEAVES:
        kind, more["value"] = _leaf(op, row, where, reads)
        more["infinite"] = op == "variable" and reads[more["value"]].infinite
    elif op in SIGNATURES:
        kinds, kind = SIGNATURES[op]
        if tuple(before[k].type for k in args) != kinds:
            raise ModelError("", f"the arguments of {where} are not of the types of {op}")
        more["value"] = _index(row, where, len(reads)) if op == "age" else None
        more["infinite"] = op in KEEPS_INFINITY and any(before[k].infinite for k in args)
        if op in WINDOWS:
            more.update(_window(op, row, where, period))
    else:
        raise ModelError("", f"{where} has the unknown operation {op!r}")
    return Operation(op, args, kind, about=f"{at[0]}:{at[1]}", **more)


def _leaf(op: str, row: Any, where: str, reads: Sequence[Read]) -> tuple[str, Any]:
    if op == "variable":
        k = _index(row, where, len(reads))
        return reads[k].type, k
    if op == "number":
        value = row.get("value")
        return NUMBER, None if value is None else _finite(value, where)
    if op == "truth":
        return BOOL, _index(row, where, 3)
    return ENUM, _index(row, where, 1 << 16)


def _index(row: Any, where: str, end: int) -> int:
    k: int = take(row, "value", int, where)
    if not 0 <= k < end:
        raise ModelError("", f"'value' of {where} is out of bounds")
    return k


def _window(op: str, row: Any, where: str, period: int) -> dict[str, Any]:
    length = _check_bounds(take(row, "window", int, where), "window", max(1, period))
    found: dict[str, Any] = {"window": length}
    if period == 0:
        raise ModelError("", f"{where} has a window, but there is no period")
    if op in BUFFERED:
        found["capacity"] = take(row, "capacity", int, where)
        if not 2 <= found["capacity"] <= MAX_CAPACITY:
            raise ModelError("", f"'capacity' of {where} is out of bounds")
        if row.get("coverage") is not None:
            found["coverage"] = _finite(row["coverage"], where)
    return found


def _result(item: Any, where: str, operations: int) -> Result:
    node = take(item, "node", int, where)
    if not 0 <= node < operations:
        raise ModelError("", f"{where} is not among the nodes")
    return Result(take(item, "id", str, where), node, item.get("polarity") == "HAZARD")
