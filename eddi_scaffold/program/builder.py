"""Programs in the making: of the graph that a check of conditions gives, and of other programs.

``nodes`` of a graph are in the order of evaluation, each argument before its use; equal
sub-expressions are one node. No name takes part in the evaluation: variables are numbered.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
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

VERSION = 1


def _signatures() -> Iterator[tuple[str, tuple[tuple[str, ...], str]]]:
    for operations, arguments, type_ in (
        ("neg abs sqrt average sum max min median stddev rate", (NUMBER,), NUMBER),
        ("least greatest add sub mul div", (NUMBER, NUMBER), NUMBER),
        ("lt le gt ge eq ne", (NUMBER, NUMBER), BOOL),
        ("eq_bool ne_bool and or xor implies latch", (BOOL, BOOL), BOOL),
        ("eq_enum ne_enum", (ENUM, ENUM), BOOL),
        ("not time once rise fall edge known_bool", (BOOL,), BOOL),
        ("count elapsed", (BOOL,), NUMBER),
        ("hysteresis", (NUMBER, NUMBER, NUMBER), BOOL),
        ("known", (NUMBER,), BOOL),
        ("known_enum", (ENUM,), BOOL),
        ("age", (), NUMBER),
    ):
        yield from ((operation, (arguments, type_)) for operation in operations.split())


SIGNATURES: Mapping[str, tuple[tuple[str, ...], str]] = dict(_signatures())
"""Operation -> types of its arguments and of its value; ``age`` names a variable."""
MAX_CAPACITY = 1 << 20
"""Samples in one window: 16 MB in C."""
KEEPS_INFINITY = ("abs", "least", "greatest", "max", "min", "median")
"""Operations whose value can be infinite when an argument is."""
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
    "and": "AND",
    "or": "OR",
    "xor": "XOR",
    "implies": "IMPLIES",
}
_TRUTHS = ("FALSE", "UNKNOWN", "TRUE")


class Builder:
    """A program in the making; equal reads are one."""

    def __init__(self) -> None:
        self._reads: dict[Read, int] = {}
        self._operations: list[Operation] = []

    def add(self, operation: Operation) -> int:
        """Add an operation; return its number."""
        self._operations.append(operation)
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
            op, value = operation.op, operation.value
            if op == "variable" and value in given:
                places.append(given[value])
                continue
            value = numbers[value] if op in ("variable", "age") else value
            args = tuple(places[k] for k in operation.args)
            places.append(self.add(operation._replace(args=args, value=value)))
        return places

    def program(self, period: int, results: Sequence[Result]) -> Program:
        """Return the program."""
        return Program(period, tuple(self._reads), tuple(self._operations), tuple(results))


def joined(programs: Sequence[Program]) -> Program:
    """Return one program with the first result of each, in which equal reads are one."""
    builder = Builder()
    results = []
    for program in programs:
        places = builder.append(program)
        result = program.results[0]
        results.append(result._replace(operation=places[result.operation]))
    return builder.program(programs[0].period, results)


def read_form(form: Mapping[str, Any]) -> Program:
    """Return the program of conditions.

    Args:
        form: what ``eddi_scaffold.conditions`` made of them.
    """
    rows = form["nodes"]
    aged = {row["value"] for row in rows if row["op"] == "age"}
    reads = tuple(_read(row, aged=k in aged) for k, row in enumerate(form["variables"]))
    operations: list[Operation] = []
    words: list[str] = []
    for row in rows:
        operation = _operation(row, reads, operations)
        words.append(comment(_words(reads, operation, operations, words)))
        operations.append(operation._replace(about=f"{operation.about} {words[-1]}"))
    results = (
        Result(row["id"], row["node"], row["polarity"] == "HAZARD") for row in form["outputs"]
    )
    return Program(form["period"], reads, tuple(operations), tuple(results))


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
            part["name"],
            part["type"],
            part.get("list", False),
            _pair(part.get("range")),
            part.get("infinite", False),
        )
        for part in row["inputs"]
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
        tuple((part, low, high) for part, low, high in row.get("limits", ())),
        row.get("coverage"),
        _pair(row.get("length")),
        _pair(row.get("sector")),
        tuple(row.get("angles", ())),
        row.get("messages", False),
    )


def _pair(value: Sequence[Any] | None) -> Any:
    return None if value is None else tuple(value)


def _words(
    reads: Sequence[Read], operation: Operation, before: Sequence[Operation], words: Sequence[str]
) -> str:
    """Return the words of an operation, as they stand in comments beside what is made of it.

    Args:
        reads: what the program reads.
        operation: what is done.
        before: the operations before it.
        words: of these.
    """
    op, value = operation.op, operation.value
    base = op.partition("_")[0]
    if op in ("variable", "age"):
        name = reads[value].name
        return name if op == "variable" else f"AGE({name})"
    if op == "number":
        return "UNKNOWN" if value is None else f"{value!r}".removesuffix(".0")
    if op == "truth":
        return _TRUTHS[value]
    if op == "literal":
        return f"literal {value}"
    arguments = [before[k] for k in operation.args]
    inner = [words[k] for k in operation.args]
    if base in _BETWEEN or op in ("neg", "not"):
        pairs = zip(arguments, inner, strict=True)
        inner = [
            f"({text})" if argument.op.partition("_")[0] in _BETWEEN else text
            for argument, text in pairs
        ]
    if op in ("eq_enum", "ne_enum"):  # literals by the names that the other one has
        literals = next(
            (reads[argument.value].literals for argument in arguments if argument.op == "variable"),
            (),
        )
        for k, argument in enumerate(arguments):
            if argument.op == "literal" and argument.value < len(literals):
                inner[k] = literals[argument.value]
    if base in _BETWEEN:
        return f"{inner[0]} {_BETWEEN[base]} {inner[1]}"
    if op in ("neg", "not"):
        return f"{'-' if op == 'neg' else 'NOT '}{inner[0]}"
    if op in WINDOWS:
        inner = [*inner, f"{operation.window / 1e9:g} s"]
    if operation.coverage is not None:
        inner = [*inner, f"COVERAGE {operation.coverage!r}"]
    return f"{base.upper()}({', '.join(inner)})"
