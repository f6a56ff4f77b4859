"""Report on a checked text: canonical form, variables, memory and cost."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from eddi_scaffold.common.problems import has_errors, plural
from eddi_scaffold.conditions.analysis import Analysis
from eddi_scaffold.conditions.scope import Variable
from eddi_scaffold.conditions.syntax import duration_text
from eddi_scaffold.program.builder import read_form
from eddi_scaffold.program.instructions import BUFFERED, LEAVES, WINDOWS, Operation

_ARRAYS = {"count": 1, "median": 3, "sum": 4, "average": 4, "stddev": 4}
"""Buffered operation -> arrays of 8 bytes per sample in C; 2 for all others."""
_RING_BYTES = 48


def as_json(analysis: Analysis, files: Mapping[str, str] | None = None) -> dict[str, Any]:
    """Return the stable JSON of ``event --json``.

    Args:
        analysis: what was checked.
        files: file name -> text of what was generated.
    """
    return {
        "ok": analysis.form is not None,
        "problems": [problem.as_json() for problem in analysis.problems],
        "diagnostics": [
            {
                "code": problem.code,
                "severity": problem.level,
                "line": problem.place.line,
                "column": problem.place.col,
                "message": problem.message,
                "hint": problem.hint,
            }
            for problem in analysis.problems
        ],
        "canonical": {event.id: event.canonical for event in analysis.events},
        "variables": [_variable_json(variable) for variable in analysis.inputs],
        "files": dict(files or {}),
    }


def as_text(analysis: Analysis) -> list[str]:
    """Return the lines of ``event --check`` for a text without errors."""
    lines = []
    for event in analysis.events:
        polarity = "" if event.type == "number" else f" ({event.polarity})"
        lines.append(f"EVENT {event.id}{polarity} := {event.canonical}")
    lines += [f"VAR {_variable_text(variable)}" for variable in analysis.inputs]
    if analysis.form is not None and not has_errors(analysis.problems):
        lines.append(cost_line(analysis.form))
    return lines


def cost_line(document: Mapping[str, Any]) -> str:
    """Return one line on memory (of the C target) and operations in a step."""
    done = read_form(document).operations
    operations = sum(one.op not in LEAVES for one in done)
    windows = sum(one.op in WINDOWS for one in done)
    memory = sum(map(_bytes, done))
    size = f"{memory / 1024:.1f} KiB" if memory >= 1024 else f"{memory} bytes"
    return f"a step: {plural(operations, 'operation')}, {plural(windows, 'window')}, {size}"


def _bytes(one: Operation) -> int:
    """Return what an operation remembers in C, about."""
    if one.op in BUFFERED:
        covered = 0 if one.coverage is None else 9 * one.capacity + _RING_BYTES
        return 8 * _ARRAYS.get(one.op, 2) * one.capacity + _RING_BYTES + covered
    return 0 if one.op in LEAVES else 16


def _variable_json(variable: Variable) -> dict[str, Any]:
    return {
        "name": variable.name,
        "type": _type_text(variable),
        "unit": variable.unit,
        "range": None if variable.range is None else list(variable.range),
        "timeout_s": None if variable.timeout is None else variable.timeout / 1e9,
        "infinite": variable.infinite,
    }


def _variable_text(variable: Variable) -> str:
    parts = [f"{variable.name} : {_type_text(variable)}"]
    parts += [f"UNIT {variable.unit}"] if variable.unit else []
    parts += [f"TIMEOUT {duration_text(variable.timeout)}"] if variable.timeout else []
    if variable.range is not None:
        parts.append(f"RANGE {variable.range[0]!r} .. {variable.range[1]!r}")
    return " ".join([*parts, *(["ALLOW INF"] if variable.infinite else [])])


def _type_text(variable: Variable) -> str:
    if variable.type is None:
        return "unknown"
    return variable.type.enum or variable.type.kind.upper()
