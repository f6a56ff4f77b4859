"""Checked texts reported and run: costs, standalone monitors, verdicts on recorded values."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Mapping
from typing import Any, Literal

from eddi_scaffold.common.problems import Place, Problem, has_errors, plural, problem
from eddi_scaffold.conditions.analysis import Analysis
from eddi_scaffold.conditions.c_vectors import vectors_of_conditions
from eddi_scaffold.conditions.scope import Variable
from eddi_scaffold.conditions.syntax import duration_text, is_list_path
from eddi_scaffold.program.c_files import c_files
from eddi_scaffold.program.instructions import BOOL, BUFFERED, LEAVES, WINDOWS, Program
from eddi_scaffold.program.running import Engine
from eddi_scaffold.program.standalone import StandaloneMonitor, Target, named
from eddi_scaffold.program.standalone_python import python_module

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
    memory = 0  # that operations remember, about
    for entry in operations:
        covered = 0 if entry.coverage is None else 9 * entry.capacity + _RING_BYTES
        ring = 8 * _ARRAYS.get(entry.op, 2) * entry.capacity + _RING_BYTES + covered
        memory += ring if entry.op in BUFFERED else 16
    size = f"{memory / 1024:.1f} KiB" if memory >= 1024 else f"{memory} bytes"
    return f"a step: {plural(len(operations), 'operation')}, {plural(windows, 'window')}, {size}"


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


Verdict = bool | float | None  # a truth value or a number; None is UNKNOWN
Column = Literal["float", "bool", "str", "float[]", "bool[]"]
_COLUMNS: Mapping[str, Column] = {"number": "float", "bool": "bool"}
_LISTS: Mapping[str, Column] = {"number": "float[]", "bool": "bool[]"}


def generate(analysis: Analysis, target: Target, name: str) -> dict[str, str]:
    """Return file name -> text of a standalone monitor of a text without errors.

    Raises:
        EddiError: the language has no lists or texts yet (E026).
    """
    model = monitor_model(analysis, name)
    if target == "python":
        return python_module(model)
    return c_files(model) | vectors_of_conditions(model)


def without_limits(analysis: Analysis, file: str) -> list[Problem]:
    """Report the variables without a VAR: no sample of theirs gets old (W003)."""
    ageless = [entry for entry in analysis.inputs if entry.timeout is None and not entry.declared]
    if not ageless:
        return []
    names = ", ".join(entry.name for entry in ageless)
    example = ageless[0]
    kind = example.type.kind.upper() if example.type is not None else "NUMBER"
    return [problem("W003.variables", Place(file), names=names, example=example.name, kind=kind)]


def monitor_model(analysis: Analysis, name: str) -> StandaloneMonitor:
    """Return what is printed of an analysis without errors; the name may be any text."""
    assert analysis.program is not None
    entries = (*analysis.inputs, *analysis.variables)
    units = {entry.name: entry.unit or "" for entry in entries}
    enums = {entry.name: entry.type.enum for entry in analysis.variables if entry.type is not None}
    source = analysis.text.strip().split("\n")
    return named(analysis.program, name, source, units=units, enums=enums)


def columns(analysis: Analysis) -> dict[str, Column]:
    """Return variable -> type of its column in a recording."""
    return {entry.name: column_of(entry) for entry in analysis.inputs}


def column_of(variable: Variable) -> Column:
    """Return the type of a variable as that of an input; a text stands for an enum."""
    kind = "number" if variable.type is None else variable.type.kind
    return (_LISTS if is_list_path(variable.name) else _COLUMNS).get(kind, "str")


def play(
    analysis: Analysis, rows: Iterable[tuple[float, Mapping[str, Any]]]
) -> Iterator[tuple[float, dict[str, Verdict]]]:
    """Yield (time in seconds, event -> verdict) for each row of new samples."""
    assert analysis.program is not None
    engine = Engine(analysis.program)
    names = [entry.name for entry in engine.sampling.inputs]
    values: dict[str, Any] = dict.fromkeys(names)
    stamps: dict[str, int | None] = dict.fromkeys(names)
    types = [engine.program.operations[result.operation].type for result in engine.program.results]
    for t, samples in rows:
        now = round(t * 1e9)
        for name in samples.keys() & values.keys():
            values[name], stamps[name] = samples[name], now
        verdicts: dict[str, Verdict] = {}
        step = engine.step(now, [*values.values()], [*stamps.values()])
        for result, type_, value in zip(engine.program.results, types, step, strict=True):
            is_unknown = value == 1 if type_ == BOOL else math.isnan(value)
            verdicts[result.id] = None if is_unknown else value == 2 if type_ == BOOL else value
        yield t, verdicts
