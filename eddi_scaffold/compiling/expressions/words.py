"""The words of a condition, as a form has them: comments beside what was made of them."""

from __future__ import annotations

from collections.abc import Sequence

from eddi_scaffold.compiling.program.instructions import WINDOWS, Operation, Read
from eddi_scaffold.compiling.text import comment

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
