"""The class ``Monitor`` of a perception scope: nothing but constants."""

from __future__ import annotations

import hashlib
from collections.abc import Callable, Iterator, Sequence
from decimal import ROUND_CEILING, Context, Decimal

from eddi_scaffold.kinds.safeml import scope
from eddi_scaffold.kinds.safeml.thresholds import critical_values
from eddi_scaffold.program import python_text as py
from eddi_scaffold.program.monitor_text import CompiledMonitor, Declaration, head_lines

FORMAT = 1
MOST_IN_TEXT = 2000
"""Numbers of a table that a person may still want to look at; more are in a file."""


def compile_safeml(
    reference: scope.ReferenceSample, options: scope.SafeMLOptions, declaration: Declaration
) -> CompiledMonitor:
    """Compile a configured SafeML monitor."""
    plan, settings, design = options.plan, options.plan.settings, options.plan.design
    tables: dict[str, bytes] = {}
    lines = head_lines("safeml.SafeML", declaration, {})
    lines += _constants(
        metric=settings.metric,
        metric_name=scope.METRIC_NAMES[settings.metric],
        window_size=settings.window_size,
        stride=settings.stride,
        significance_level=settings.significance_level,
    )
    lines += _thresholds(plan)
    hold, backend = settings.on_omission == "hold", settings.array_backend
    lines += _constants(hold=hold, max_age=options.max_age, single=plan.single)
    if backend != "numpy":
        lines += _constants(array_backend=backend)
    rows, features = reference.rows.shape
    what = "Features, each ascending"
    if design.table is not None:
        what = "Rows"
        names = [f"component {k}" for k in range(len(design.table) - 2)]
        table = _table("axes.bin", design.table, tables, ["means", "divisors", *names])
        limit = {} if design.floor is None else {"floor": py.number(design.floor)}
        lines += py.assignment("axes", py.call("safeml.Axes", [table], **limit), 4)
    about = py.comment(f"{reference.source.file_name}: {rows} rows, {features} features")
    lines.append(f"    # {what}: {about}")
    lines += py.assignment("reference", _table("reference.bin", design.sample, tables), 4)
    return CompiledMonitor(FORMAT, lines, tables=tables)


def _constants(**values: object) -> list[str]:
    return [
        line for name, value in values.items() for line in py.assignment(name, py.literal(value), 4)
    ]


def _thresholds(plan: scope.Plan) -> Iterator[str]:
    """Yield the thresholds: those of Kolmogorov-Smirnov are whole numbers, n m D."""
    metric, n, m = plan.settings.metric, plan.n, plan.settings.window_size
    scaled = f": {n * m} D" if metric == "ks" else ""
    yield f"    # Distance of {n} reference values and {m} of the window{scaled}"
    written: Callable[[float], float] = int if metric == "ks" else upwards
    theoretical = written(plan.theoretical)
    yield from _constants(threshold=written(plan.threshold), threshold_theoretical=theoretical)
    if metric == "ks":
        yield f"    tail = safeml.Kolmogorov({n}, {m})"
        return
    points, slope = critical_values(metric, n, m)
    yield "    # Critical values with their levels, and the slope beyond"
    law = py.call("safeml.Interpolated", [py.literal(tuple(points)), py.number(slope)])
    yield from py.assignment("tail", law, 4)


def upwards(value: float) -> float:
    """Return a number of nine digits that is not below ``value``: the same on every machine."""
    return float(Context(9, ROUND_CEILING).create_decimal(Decimal(value)))


def _table(
    file: str, rows: scope.Rows, tables: dict[str, bytes], names: Sequence[str] = ()
) -> py.Part:
    """Return a table, or where its file is, which goes to the others."""
    if rows.size > MOST_IN_TEXT:
        # Doubles, least significant byte first, row by row.
        tables[file] = rows.astype("<f8").tobytes()
        digest = hashlib.sha256(tables[file]).hexdigest()
        shape = py.literal(rows.shape)
        return py.call(
            "safeml.Table", ["__spec__", py.text_literal(file), py.text_literal(digest), shape]
        )
    texts = (py.tuple_of(map(py.number, row)) for row in rows.tolist())
    above = names or [""] * len(rows)
    return py.tuple_of(py.Item(row, above=name) for row, name in zip(texts, above, strict=True))
