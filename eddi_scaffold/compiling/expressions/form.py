"""The program of conditions, made of the graph that their check gives.

``nodes`` are in the order of evaluation, each argument before its use; equal sub-expressions are
one node. No name takes part in the evaluation: variables are numbered.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any

from eddi_scaffold.compiling.expressions.words import words_of
from eddi_scaffold.compiling.program.building import Builder
from eddi_scaffold.compiling.program.instructions import (
    BOOL,
    ENUM,
    LEAVES,
    NUMBER,
    Operation,
    Program,
    Read,
    Result,
)
from eddi_scaffold.compiling.program.reduction import Element, Part, Reduction

VERSION = 1
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


def read_form(form: Mapping[str, Any]) -> Program:
    """Return the program of conditions.

    Args:
        form: what ``eddi_scaffold.conditions`` made of them.
    """
    rows = form["nodes"]
    aged = {row["value"] for row in rows if row["op"] == "age"}
    reads = tuple(_read(row, aged=k in aged) for k, row in enumerate(form["variables"]))
    operations: list[Operation] = []
    for row in rows:
        operations.append(_operation(row, reads, operations))
    results = (
        Result(row["id"], row["node"], row["polarity"] == "HAZARD") for row in form["outputs"]
    )
    described = (
        operation._replace(about=f"{operation.about} {words}")
        for operation, words in zip(operations, words_of(reads, operations), strict=True)
    )
    return Program(form["period"], reads, tuple(described), tuple(results))


def joined(programs: Sequence[Program]) -> Program:
    """Return one program with the first result of each, in which equal reads are one."""
    builder = Builder()
    results = []
    for program in programs:
        places = builder.append(program)
        result = program.results[0]
        results.append(result._replace(operation=places[result.operation]))
    return builder.program(programs[0].period, results)


def _read(row: Mapping[str, Any], *, aged: bool) -> Read:
    limits, timeout, reduction = row.get("range"), row.get("timeout"), row.get("reduction")
    return Read(
        name=row["name"],
        type=row["type"],
        range=None if limits is None else (float(limits[0]), float(limits[1])),
        timeout=timeout,
        infinite=row.get("infinite", False),
        literals=tuple(row.get("literals", ())),
        stamped=aged or timeout is not None,
        text=row.get("text", False),
        reduction=None if reduction is None else read_reduction(reduction),
    )


def _operation(
    row: Mapping[str, Any], reads: Sequence[Read], before: Sequence[Operation]
) -> Operation:
    op, args = row["op"], tuple(row.get("args", ()))
    value: Any = row.get("value")
    infinite = op in KEEPS_INFINITY and any(before[k].infinite for k in args)
    if op == "variable":
        type_, infinite = reads[value].type, reads[value].infinite
    elif op in LEAVES:
        type_ = {"number": NUMBER, "truth": BOOL, "literal": ENUM}[op]
        value = float(value) if op == "number" and value is not None else value
    else:
        type_ = SIGNATURES[op][1]
    line, column = row["at"]
    return Operation(
        op,
        args,
        type_,
        value,
        about=f"{line}:{column}",
        window=row.get("window", 0),
        capacity=row.get("capacity", 0),
        coverage=row.get("coverage"),
        infinite=infinite,
    )


def read_reduction(row: Mapping[str, Any]) -> Reduction:
    """Return how one value is made of lists."""
    inputs = tuple(
        Part(
            one["name"],
            one["type"],
            one.get("list", False),
            _pair(one.get("range")),
            one.get("infinite", False),
        )
        for one in row["inputs"]
    )
    elements: list[Element] = []
    for node in row["nodes"]:
        op, args, value = node["op"], tuple(node.get("args", ())), node.get("value")
        if op == "constant" and not isinstance(value, int):
            value = math.nan if value is None else float(value)
        is_list = inputs[value].is_list if op == "input" else any(elements[k].is_list for k in args)
        elements.append(Element(op, args, value, is_list))
    return Reduction(
        row["op"],
        inputs,
        tuple(elements),
        row["value"],
        tuple((one, low, high) for one, low, high in row.get("limits", ())),
        row.get("coverage"),
        _pair(row.get("length")),
        _pair(row.get("sector")),
        tuple(row.get("angles", ())),
        row.get("messages", False),
    )


def _pair(value: Sequence[Any] | None) -> Any:
    return None if value is None else tuple(value)
