"""Report on a checked text: canonical form, variables, memory and cost."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from eddi_scaffold.common.problems import has_errors, plural
from eddi_scaffold.conditions.analysis import Analysis
from eddi_scaffold.conditions.scope import Variable
from eddi_scaffold.conditions.syntax import duration_text
from eddi_scaffold.program.instructions import BUFFERED, LEAVES, WINDOWS, Operation, Program

_ARRAYS = {"count": 1, "median": 3, "sum": 4, "average": 4, "stddev": 4}
"""Buffered operation -> arrays of 8 bytes per sample in C; 2 for all others."""
_RING_BYTES = 48


def as_json(analysis: Analysis, files: Mapping[str, str] | None = None) -> dict[str, Any]:
    """Return the stable JSON of ``event --json``, with the files that were generated."""
    problems = [problem.as_json() for problem in analysis.problems]
    keys = {"code": "code", "severity": "level", "line": "line", "column": "col"}
    keys |= {"message": "message", "hint": "hint"}
    return {
        "ok": analysis.program is not None,
        "problems": problems,
        "diagnostics": [{name: problem[key] for name, key in keys.items()} for problem in problems],
        "canonical": {event.id: event.canonical for event in analysis.events},
        "variables": [
            {
                "name": entry.name,
                "type": _type_text(entry),
                "unit": entry.unit,
                "range": None if entry.range is None else list(entry.range),
                "timeout_s": None if entry.timeout is None else entry.timeout / 1e9,
                "infinite": entry.infinite,
            }
            for entry in analysis.inputs
        ],
        "files": dict(files or {}),
    }


def as_text(analysis: Analysis) -> list[str]:
    """Return the lines of ``event --check``."""
    lines = []
    for event in analysis.events:
        polarity = "" if event.type == "number" else f" ({event.polarity})"
        lines.append(f"EVENT {event.id}{polarity} := {event.canonical}")
    lines += map(_variable_text, analysis.inputs)
    if analysis.program is not None and not has_errors(analysis.problems):
        lines.append(cost_line(analysis.program))
    return lines


def cost_line(program: Program) -> str:
    """Return one line on memory (of the C target) and operations in a step."""
    operations = [entry for entry in program.operations if entry.op not in LEAVES]
    windows = sum(operation.op in WINDOWS for operation in operations)
    memory = sum(map(_bytes, operations))
    size = f"{memory / 1024:.1f} KiB" if memory >= 1024 else f"{memory} bytes"
    return f"a step: {plural(len(operations), 'operation')}, {plural(windows, 'window')}, {size}"


def _bytes(operation: Operation) -> int:
    """Return what an operation remembers in C, about."""
    if operation.op not in BUFFERED:
        return 16
    covered = 0 if operation.coverage is None else 9 * operation.capacity + _RING_BYTES
    return 8 * _ARRAYS.get(operation.op, 2) * operation.capacity + _RING_BYTES + covered


def _variable_text(variable: Variable) -> str:
    parts = [f"VAR {variable.name} : {_type_text(variable)}"]
    if variable.unit:
        parts.append(f"UNIT {variable.unit}")
    if variable.timeout:
        parts.append(f"TIMEOUT {duration_text(variable.timeout)}")
    if variable.range is not None:
        parts.append(f"RANGE {variable.range[0]!r} .. {variable.range[1]!r}")
    return " ".join([*parts, *(["ALLOW INF"] if variable.infinite else [])])


def _type_text(variable: Variable) -> str:
    if variable.type is None:
        return "unknown"
    return variable.type.enum or variable.type.kind.upper()
