"""Functions that write out sums of products, evaluated for what is exact."""

from __future__ import annotations

import ast
import operator
from collections.abc import Callable, Mapping, Sequence
from fractions import Fraction
from typing import Any

from eddi_scaffold.evidence.emitted import UnprovedError

_MOST_TERMS = 20_000
_LARGE = 1e18
_OPERATIONS = {ast.Add: operator.add, ast.Mult: operator.mul}


class Polynomial(dict[tuple[Any, ...], Fraction]):
    """Variables of a product, sorted -> its coefficient."""

    def __add__(self, other: Polynomial) -> Polynomial:
        none = Fraction(0)
        sums = {of: self.get(of, none) + other.get(of, none) for of in {**self, **other}}
        return Polynomial({of: number for of, number in sums.items() if number})

    def __sub__(self, other: Polynomial) -> Polynomial:
        return self + Polynomial({of: -number for of, number in other.items()})

    def __mul__(self, other: Polynomial) -> Polynomial:
        if len(self) * len(other) > _MOST_TERMS:
            raise UnprovedError(None, "it has too many products")
        terms = Polynomial()
        for a, number in self.items():
            for b, factor in other.items():
                product = tuple(sorted(a + b))
                terms[product] = terms.get(product, Fraction(0)) + number * factor
        return terms


def variables(names: Sequence[Any]) -> list[Polynomial]:
    """Return a polynomial for each variable."""
    return [Polynomial({(name,): Fraction(1)}) for name in names]


def _is_variable(value: Any) -> bool:
    """Return whether a value is a variable: a difference of others may lose all its digits."""
    return isinstance(value, dict) and [*map(len, value)] == [1] == [*value.values()]


def returned(
    function: ast.AST,
    arguments: str,
    values: Mapping[str, Any],
    number: Callable[[float], Any] = lambda value: Polynomial({(): Fraction(value)}),
) -> Any:
    """Return what a function of assignments and a ``return`` gives; of a tuple, a list.

    ``values`` of its arguments, and ``number`` of a constant, can be added and multiplied. Nothing
    is subtracted but a variable from one, so what is computed has as many digits as what is exact.
    """
    if not isinstance(function, ast.FunctionDef) or ast.unparse(function.args) != arguments:
        raise UnprovedError(function)
    known = dict(values)

    def value_of(node: ast.expr) -> Any:
        match node:
            case ast.Constant(value=float() as constant) if 0.0 <= constant < _LARGE:
                return number(constant)
            case ast.Name(id=name) if name in known:
                return known[name]
            case ast.Tuple(elts=parts) | ast.List(elts=parts):
                return [value_of(part) for part in parts]
            case ast.Subscript(value=ast.Name(id=name), slice=ast.Constant(value=int() as place)):
                if isinstance(rows := known.get(name), list) and 0 <= place < len(rows):
                    return rows[place]
            case ast.BinOp(left=ast.Constant(value=1.0), op=ast.Sub(), right=ast.Name() as right):
                if _is_variable(of := value_of(right)):
                    return number(1.0) - of
            case ast.BinOp(left=left, op=op, right=right) if type(op) in _OPERATIONS:
                try:
                    return _OPERATIONS[type(op)](value_of(left), value_of(right))
                except TypeError:
                    pass
        raise UnprovedError(node)

    def assign(target: ast.expr, value: Any) -> None:
        if isinstance(target, ast.Name):
            known[target.id] = value
            return
        parts = target.elts if isinstance(target, ast.Tuple) else []
        if not parts or not isinstance(value, list) or len(parts) != len(value):
            raise UnprovedError(target)
        for part, of in zip(parts, value, strict=True):
            assign(part, of)

    for line in function.body:
        match line:
            case ast.Assign(targets=[target], value=value):
                assign(target, value_of(value))
            case ast.Return(value=ast.expr() as value) if line is function.body[-1]:
                return value_of(value)
            case _:
                raise UnprovedError(line)
    raise UnprovedError(function)
