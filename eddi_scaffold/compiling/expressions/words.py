"""The words of a condition, as a form has them: comments beside what was made of them."""

from __future__ import annotations

from eddi_scaffold.compiling.expressions.form import WINDOWS, Form, Node
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


def words_of(form: Form) -> list[str]:
    """Return the words of each node, cut to what fits a comment."""
    found: list[str] = []
    for node in form.nodes:
        whole = node.op not in _BETWEEN and node.op not in ("neg", "not")
        inner = [found[k] if whole else _inside(form.nodes[k], found[k]) for k in node.args]
        found.append(comment(_words(form, node, inner)))
    return found


def _inside(node: Node, text: str) -> str:
    return f"({text})" if node.op in _BETWEEN else text


def _words(form: Form, node: Node, inner: list[str]) -> str:
    if node.op in ("variable", "age"):
        name = form.variables[node.value].name
        return name if node.op == "variable" else f"AGE({name})"
    if node.op == "number":
        return "UNKNOWN" if node.value is None else f"{node.value!r}".removesuffix(".0")
    if node.op == "truth":
        return _TRUTHS[node.value]
    if node.op == "literal":
        return f"literal {node.value}"
    if node.op in ("eq_enum", "ne_enum"):
        inner = _named(form, node, inner)
    if node.op in _BETWEEN:
        return f"{inner[0]} {_BETWEEN[node.op]} {inner[1]}"
    if node.op in ("neg", "not"):
        return f"{'-' if node.op == 'neg' else 'NOT '}{inner[0]}"
    if node.op in WINDOWS:
        inner = [*inner, f"{node.window / 1e9:g} s"]
    if node.coverage is not None:
        inner = [*inner, f"COVERAGE {node.coverage!r}"]
    return f"{node.op.partition('_')[0].upper()}({', '.join(inner)})"


def _named(form: Form, node: Node, inner: list[str]) -> list[str]:
    """Return the texts of two values of an ENUM, literals by the names that the other one has."""
    values = [form.nodes[k] for k in node.args]
    literals = next((form.variables[v.value].literals for v in values if v.op == "variable"), ())
    return [
        literals[value.value] if value.op == "literal" and value.value < len(literals) else text
        for value, text in zip(values, inner, strict=True)
    ]
