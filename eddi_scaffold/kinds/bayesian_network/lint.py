"""What is often wrong in the methods of ``bayesian_network_config.py``: warnings with their line.

The file is read as text and never run. The faults are those of published monitors that were made
with the tools of SESAME D7.2: a missing ``else``, 0.0 in place of 1.0, NaN that counts as safe.
"""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import PurePath

from eddi_scaffold.common.escaping import parse_shallow
from eddi_scaffold.common.files import Source
from eddi_scaffold.common.problems import Place, Problem, did_you_mean, error, warning
from eddi_scaffold.kinds.bayesian_network import lint_ways as ways

FILE = "bayesian_network_config.py"
_DECLARED = re.compile(r"\s*# Declared: (?:discretised|taken) from ")
_GUARDS = ("isnan", "isfinite", "isinf")


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
    """Return what looks wrong (B406, B410 to B417), or that the file is not Python (B418)."""
    try:
        tree = parse_shallow(source.data)
    except SyntaxError as fault:
        place = Place(source.name, fault.lineno or 1, fault.offset or 1)
        return [error("B418", f"this is not Python: {fault.msg}", place)]
    lines = source.data.decode("utf-8", "replace").splitlines()
    found: list[Problem] = []
    for item in ast.walk(tree):
        if isinstance(item, ast.FunctionDef) and item.name.startswith("node_"):
            method = _method(item, lines)
            found += [
                warning(code, text, Place(source.name, line), hint)
                for code, line, text, hint in _faults(method)
            ]
    return found


def _method(function: ast.FunctionDef, lines: list[str]) -> _Method:
    begin, end = (
        next((k for k, one in enumerate(function.body) if _is_marker(one, word)), None)
        for word in ("begin", "end")
    )
    start = 0 if begin is None else begin + 1
    head = function.body if begin is None else function.body[:begin]
    given = [found for one in head if (found := ways.assignment(one)) is not None]
    outcomes = [one.name for one in given if one.value == 0.0]
    stop = function.body[start].lineno if start < len(function.body) else function.lineno
    declared = any(_DECLARED.match(line) for line in lines[function.lineno : stop])
    body = function.body[start : end if begin is not None else None]
    return _Method(function.name, tuple(outcomes), declared, tuple(body))


def _is_marker(statement: ast.stmt, word: str) -> bool:
    if not isinstance(statement, ast.Expr) or not isinstance(statement.value, ast.Constant):
        return False
    return f"manual edit {word}" in str(statement.value.value).casefold()


Fault = tuple[str, int, str, "str | None"]


def _faults(method: _Method) -> Iterator[Fault]:
    """Yield code, line, message and hint of each fault."""
    yield from _names(method)
    yield from _values(method)
    real = [assignment for assignment in ways.assignments(method.body) if assignment.value != 0.0]
    if real and method.declared:
        text = (
            f"{method.name} is declared in the configuration and set here, which takes precedence"
        )
        yield "B406", real[0].line, text, "remove the declaration, or this body"
    flags = [
        statement for statement in ways.statements(method.body) if ways.flags_output(statement)
    ]
    if real and flags:
        text = f"{method.name} is an output and evidence at once: it only echoes what is set"
        yield "B414", flags[0].lineno, text, None
    yield from _ways(method)
    for chain in ways.chains(method.body):
        yield from _chain(method, chain)


def _names(method: _Method) -> Iterator[Fault]:
    seen: set[str] = set()
    for statement in method.body:
        for item in ast.walk(statement):
            if not isinstance(item, ast.Name) or not item.id.startswith("outcome_"):
                continue
            if item.id not in method.outcomes and item.id not in seen:
                seen.add(item.id)
                hint = did_you_mean(item.id, method.outcomes)
                text = f"{method.name} has no {item.id!r}"
                yield "B412", item.lineno, text, hint


def _values(method: _Method) -> Iterator[Fault]:
    for assignment in ways.assignments(method.body):
        if assignment.value is not None and not 0.0 <= assignment.value <= 1.0:
            text = f"{method.name}: an outcome of {assignment.value:g} is outside [0, 1]"
            yield "B417", assignment.line, text, None


def _ways(method: _Method) -> Iterator[Fault]:
    """Yield what is wrong with one of the ways through the whole method."""
    found = ways.through(method.body)
    if found is None:
        return
    open_chain = next((chain for chain in ways.chains(method.body) if chain.sets_no_else), None)
    if method.declared:
        open_chain = None  # the declaration applies where nothing is set
    if open_chain and any(way.names for way in found) and not all(way.names for way in found):
        text = f"a path through {method.name} sets no outcome: the node is unobserved there"
        yield "B410", open_chain.line, text, "is an `else` missing?"
    twice = next((way for way in found if len(way.sure) > 1), None)
    if twice is not None:
        names = " and ".join(sorted(twice.sure))
        text = f"a path through {method.name} sets {names} to 1"
        yield "B413", max(twice.lines), text, "two certain states contradict each other: set one"


def _chain(method: _Method, chain: ways.IfChain) -> Iterator[Fault]:
    for zero in chain.zeros_in_else():
        text = f"{method.name}: this `else` sets an outcome to 0, which it is already"
        yield "B411", zero.line, text, "is 1.0 meant?"
    guarded = any(
        isinstance(item, ast.Name | ast.Attribute)
        and getattr(item, "attr", getattr(item, "id", "")) in _GUARDS
        for statement in method.body
        for item in ast.walk(statement)
    )
    if chain.else_sets and chain.orders and not guarded:
        text = f"{method.name}: NaN takes this `else`"
        hint = "test for it first (math.isfinite), or declare the node in the configuration"
        yield "B415", chain.otherwise[0].lineno, text, hint
    for line, low, high in chain.breaks():
        what = "leave a gap" if low < high else "overlap"
        text = f"{method.name}: the comparisons {what} between {low:g} and {high:g}"
        yield "B416", line, text, None
