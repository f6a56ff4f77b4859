"""The words of a condition, as a form has them: comments beside what was made of them."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any

from eddi_scaffold.program.instructions import (
    BOOL,
    ENUM,
    LEAVES,
    NUMBER,
    WINDOWS,
    Operation,
    Program,
    Read,
    Result,
)
from eddi_scaffold.program.lists import Element, Part, Reduction
from eddi_scaffold.program.python_text import comment

_BETWEEN = {
    "add": "+",
    "sub": "-",
    "mul": "*",
    "div": "/",
    "lt": "<",
    "le": "<=",
    "gt": ">",
    "ge": ">=",
    "eq": "==",
    "ne": "!=",
    "eq_bool": "==",
    "ne_bool": "!=",
    "eq_enum": "==",
    "ne_enum": "!=",
    "and": "AND",
    "or": "OR",
    "xor": "XOR",
    "implies": "IMPLIES",
}
_TRUTHS = ("FALSE", "UNKNOWN", "TRUE")


def words_of(reads: Sequence[Read], operations: Sequence[Operation]) -> list[str]:
    """Return the words of each operation, cut to what fits a comment."""
    found: list[str] = []
    for operation in operations:
        whole = operation.op not in _BETWEEN and operation.op not in ("neg", "not")
        inner = [found[k] if whole else _inside(operations[k], found[k]) for k in operation.args]
        if operation.op in ("eq_enum", "ne_enum"):
            inner = _named(reads, [operations[k] for k in operation.args], inner)
        found.append(comment(_words(reads, operation, inner)))
    return found


def _inside(one: Operation, text: str) -> str:
    return f"({text})" if one.op in _BETWEEN else text


def _words(reads: Sequence[Read], one: Operation, inner: list[str]) -> str:
    if one.op in ("variable", "age"):
        name = reads[one.value].name
        return name if one.op == "variable" else f"AGE({name})"
    if one.op == "number":
        return "UNKNOWN" if one.value is None else f"{one.value!r}".removesuffix(".0")
    if one.op == "truth":
        return _TRUTHS[one.value]
    if one.op == "literal":
        return f"literal {one.value}"
    if one.op in _BETWEEN:
        return f"{inner[0]} {_BETWEEN[one.op]} {inner[1]}"
    if one.op in ("neg", "not"):
        return f"{'-' if one.op == 'neg' else 'NOT '}{inner[0]}"
    if one.op in WINDOWS:
        inner = [*inner, f"{one.window / 1e9:g} s"]
    if one.coverage is not None:
        inner = [*inner, f"COVERAGE {one.coverage!r}"]
    return f"{one.op.partition('_')[0].upper()}({', '.join(inner)})"


def _named(reads: Sequence[Read], values: Sequence[Operation], texts: list[str]) -> list[str]:
    """Return the texts of two values of an ENUM, literals by the names that the other one has."""
    literals = next((reads[value.value].literals for value in values if value.op == "variable"), ())
    return [
        literals[value.value] if value.op == "literal" and value.value < len(literals) else text
        for value, text in zip(values, texts, strict=True)
    ]


class Builder:
    """A program in the making; equal reads are one."""

    def __init__(self) -> None:
        self._reads: dict[Read, int] = {}
        self._operations: list[Operation] = []

    def add(self, one: Operation) -> int:
        """Add an operation; return its number."""
        self._operations.append(one)
        return len(self._operations) - 1

    def append(self, program: Program, given: Mapping[int, int] | None = None) -> list[int]:
        """Add the operations of a program; return the new number of each.

        Args:
            program: what is added.
            given: what it reads -> the operation here that gives that.
        """
        given = given or {}
        numbers = {
            k: self._reads.setdefault(read, len(self._reads))
            for k, read in enumerate(program.reads)
            if k not in given
        }
        places: list[int] = []
        for operation in program.operations:
            if operation.op == "variable" and operation.value in given:
                places.append(given[operation.value])
                continue
            value = (
                numbers[operation.value] if operation.op in ("variable", "age") else operation.value
            )
            args = tuple(places[k] for k in operation.args)
            places.append(self.add(operation._replace(args=args, value=value)))
        return places

    def program(self, period: int, results: Sequence[Result]) -> Program:
        """Return the program."""
        return Program(period, tuple(self._reads), tuple(self._operations), tuple(results))


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
