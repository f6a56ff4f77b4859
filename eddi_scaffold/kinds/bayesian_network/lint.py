"""What is often wrong in the methods of ``bayesian_network_config.py``: warnings with their line.

The file is read as text and never run. Which paths a body has is not followed: ``discretisation:``
declares the same without a gap, and with NaN as missing.
"""

from __future__ import annotations

import ast
import re
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, replace
from pathlib import PurePath

from eddi_scaffold.common.escaping import parse_shallow
from eddi_scaffold.common.files import Source
from eddi_scaffold.common.problems import Place, Problem, did_you_mean, problem

FILE = "bayesian_network_config.py"
_DECLARED = re.compile(r"\s*# Declared: (?:discretised|taken) from ")


@dataclass(frozen=True)
class _OutcomeAssignment:
    """An assignment ``outcome_<state> = ...``.

    Attributes:
        name: its target.
        value: the number that is assigned, ``None`` for any other expression.
        line: where it is.
    """

    name: str
    value: float | None
    line: int


@dataclass(frozen=True)
class _Method:
    """One method ``node_<name>``: the code before its region, and in it."""

    name: str
    outcomes: tuple[str, ...]
    declared: bool
    body: tuple[ast.stmt, ...]


def is_config_module(name: str) -> bool:
    """Return whether a file is the module in which people write, by its name."""
    return PurePath(name).name == FILE


def lint(source: Source) -> list[Problem]:
    """Return what looks wrong (B406, B412), or that the file is not Python (B418)."""
    try:
        tree = parse_shallow(source.data)
    except SyntaxError as fault:
        place = Place(source.name, fault.lineno or 1, fault.offset or 1)
        return [problem("B418.syntax", place, msg=fault.msg)]
    lines = source.data.decode("utf-8", "replace").splitlines()
    found: list[Problem] = []
    for item in ast.walk(tree):
        if isinstance(item, ast.FunctionDef) and item.name.startswith("node_"):
            method = _method(item, lines)
            found += [replace(p, place=replace(p.place, file=source.name)) for p in _faults(method)]
    return found


def _method(function: ast.FunctionDef, lines: list[str]) -> _Method:
    begin, end = (
        next((k for k, one in enumerate(function.body) if _is_marker(one, word)), None)
        for word in ("begin", "end")
    )
    start = 0 if begin is None else begin + 1
    head = function.body if begin is None else function.body[:begin]
    given = [found for one in head if (found := _assignment(one)) is not None]
    outcomes = [one.name for one in given if one.value == 0.0]
    stop = function.body[start].lineno if start < len(function.body) else function.lineno
    declared = any(_DECLARED.match(line) for line in lines[function.lineno : stop])
    body = function.body[start : end if begin is not None else None]
    return _Method(function.name, tuple(outcomes), declared, tuple(body))


def _is_marker(statement: ast.stmt, word: str) -> bool:
    if not isinstance(statement, ast.Expr) or not isinstance(statement.value, ast.Constant):
        return False
    return f"manual edit {word}" in str(statement.value.value).casefold()


def _faults(method: _Method) -> Iterator[Problem]:
    """Yield what is wrong, at its line of a file without a name."""
    yield from _names(method)
    yield from _values(method)
    real = [assignment for assignment in _assignments(method.body) if assignment.value != 0.0]
    if real and method.declared:
        yield problem("B406", Place(line=real[0].line), method=method.name)
    flags = [statement for statement in _statements(method.body) if _flags_output(statement)]
    if real and flags:
        yield problem("B412.echo", Place(line=flags[0].lineno), method=method.name)


def _names(method: _Method) -> Iterator[Problem]:
    seen: set[str] = set()
    for statement in method.body:
        for item in ast.walk(statement):
            if not isinstance(item, ast.Name) or not item.id.startswith("outcome_"):
                continue
            if item.id not in method.outcomes and item.id not in seen:
                seen.add(item.id)
                hint = did_you_mean(item.id, method.outcomes)
                place = Place(line=item.lineno)
                yield problem("B412.outcome", place, hint=hint, method=method.name, name=item.id)


def _values(method: _Method) -> Iterator[Problem]:
    for assignment in _assignments(method.body):
        if assignment.value is not None and not 0.0 <= assignment.value <= 1.0:
            place, value = Place(line=assignment.line), assignment.value
            yield problem("B412.outside", place, method=method.name, value=value)


def _statements(body: Iterable[ast.stmt]) -> Iterator[ast.stmt]:
    """Yield every statement of a body, those inside others too, in the order of the text."""
    for statement in body:
        for item in ast.walk(statement):
            if isinstance(item, ast.stmt):
                yield item


def _assignments(body: Iterable[ast.stmt]) -> Iterator[_OutcomeAssignment]:
    """Yield every assignment to an outcome in a body, those inside others too."""
    for statement in _statements(body):
        found = _assignment(statement)
        if found is not None:
            yield found


def _assignment(statement: ast.stmt) -> _OutcomeAssignment | None:
    """Return the assignment to an outcome that a statement is, ``None`` for all others."""
    match statement:
        case ast.Assign(targets=[ast.Name(id=name)], value=value) if name.startswith("outcome_"):
            return _OutcomeAssignment(name, _constant(value), statement.lineno)
    return None


def _flags_output(statement: ast.stmt) -> bool:
    """Return whether a statement is ``is_bn_output = ...`` with something else than False."""
    if not isinstance(statement, ast.Assign) or len(statement.targets) != 1:
        return False
    target, value = statement.targets[0], statement.value
    is_flag = isinstance(target, ast.Name) and target.id == "is_bn_output"
    return is_flag and not (isinstance(value, ast.Constant) and value.value is False)


def _constant(value: ast.expr) -> float | None:
    """Return the number that an expression is, ``None`` for all others."""
    if isinstance(value, ast.UnaryOp) and isinstance(value.op, ast.USub):
        number = _constant(value.operand)
        return None if number is None else -number
    written = value.value if isinstance(value, ast.Constant) else None
    if isinstance(written, int | float) and not isinstance(written, bool):
        try:
            return float(written)
        except OverflowError:
            return None
    return None
