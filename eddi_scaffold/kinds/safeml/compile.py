"""The class ``Monitor`` of a perception scope: nothing but constants."""

from __future__ import annotations

import hashlib
from collections.abc import Iterator, Sequence

from eddi_scaffold.kinds.safeml.plan import upwards
from eddi_scaffold.kinds.safeml.scope import (
    METRIC_NAMES,
    Plan,
    ReferenceSample,
    Rows,
    SafeMLOptions,
)
from eddi_scaffold.kinds.safeml.thresholds import critical_values
from eddi_scaffold.program.monitor_text import CompiledMonitor, Declaration, head_lines
from eddi_scaffold.program.python_text import (
    Item,
    Part,
    assignment,
    call,
    comment,
    literal,
    number,
    text_literal,
    tuple_of,
)

FORMAT = 1
MOST_IN_TEXT = 2000
"""Numbers of a table that a person may still want to look at; more are in a file."""


def compile_safeml(
    reference: ReferenceSample, options: SafeMLOptions, declaration: Declaration
) -> CompiledMonitor:
    """Compile a configured SafeML monitor."""
    plan, settings = options.plan, options.plan.settings
    tables: dict[str, bytes] = {}
    values: dict[str, object] = {
        "metric": settings.metric,
        "metric_name": METRIC_NAMES[settings.metric],
        "window_size": settings.window_size,
        "stride": settings.stride,
        "significance_level": settings.significance_level,
    }
    lines = head_lines("safeml.SafeML", declaration, {})
    for name, value in values.items():
        lines += assignment(name, literal(value), 4)
    lines += _thresholds(plan)
    values = {
        "hold": settings.on_omission == "hold",
        "max_age": options.max_age,
        "single": plan.spec.single,
    }
    if settings.array_backend != "numpy":
        values["array_backend"] = settings.array_backend
    for name, value in values.items():
        lines += assignment(name, literal(value), 4)
    rows, features = reference.rows.shape
    what = "Features, each ascending"
    if plan.design.table is not None:
        what = "Rows"
        names = [
            "means",
            "divisors",
            *(f"component {k}" for k in range(len(plan.design.table) - 2)),
        ]
        table = _table("axes.bin", plan.design.table, tables, names)
        floor = plan.design.floor
        limit = {} if floor is None else {"floor": number(floor)}
        lines += assignment("axes", call("safeml.Axes", [table], **limit), 4)
    about = f"{reference.source.file_name}: {rows} rows, {features} features"
    lines += [f"    # {what}: {comment(about)}"]
    lines += assignment("reference", _table("reference.bin", plan.design.sample, tables), 4)
    return CompiledMonitor(FORMAT, lines, tables=tables)


def _thresholds(plan: Plan) -> Iterator[str]:
    """Yield the thresholds: those of Kolmogorov-Smirnov are whole numbers, n m D."""
    metric, n, m = plan.settings.metric, plan.n, plan.settings.window_size
    scaled = f": {n * m} D" if metric == "ks" else ""
    yield f"    # Distance of {n} reference values and {m} of the window{scaled}"
    thresholds = {"threshold": plan.threshold, "threshold_theoretical": plan.theoretical}
    for name, value in thresholds.items():
        yield from assignment(name, literal(int(value) if metric == "ks" else upwards(value)), 4)
    if metric == "ks":
        yield f"    tail = safeml.Kolmogorov({n}, {m})"
        return
    points, slope = critical_values(metric, n, m)
    yield "    # Critical values with their levels, and the slope beyond"
    law = call("safeml.Interpolated", [literal(tuple(points)), number(slope)])
    yield from assignment("tail", law, 4)


def _table(file: str, rows: Rows, tables: dict[str, bytes], names: Sequence[str] = ()) -> Part:
    """Return a table, or where its file is, which goes to the others."""
    if rows.size > MOST_IN_TEXT:
        # Doubles, least significant byte first, row by row.
        tables[file] = rows.astype("<f8").tobytes()
        digest = hashlib.sha256(tables[file]).hexdigest()
        shape = literal(rows.shape)
        return call("safeml.Table", ["__spec__", text_literal(file), text_literal(digest), shape])
    texts = (tuple_of(map(number, row)) for row in rows.tolist())
    above = names or [""] * len(rows)
    return tuple_of(Item(row, above=name) for row, name in zip(texts, above, strict=True))
