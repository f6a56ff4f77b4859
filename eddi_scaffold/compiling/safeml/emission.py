"""The class ``Monitor`` of a perception scope: nothing but constants."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from eddi_scaffold.compiling.document import ModelFile
from eddi_scaffold.compiling.inputs import declaration_of, head_lines
from eddi_scaffold.compiling.safeml.limits import critical_values
from eddi_scaffold.compiling.safeml.model import Axes, SafeMLData, Table, read_safeml
from eddi_scaffold.compiling.text import (
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


def lines_of(model_file: ModelFile) -> list[str]:
    """Return the lines of the class.

    Raises:
        ModelError: the model is wrong.
    """
    data = read_safeml(model_file)
    lines = [
        *head_lines("safeml.SafeML", declaration_of(model_file), {}),
        f'    metric = "{data.metric}"',
        f'    metric_name = "{data.metric_name}"',
    ]
    for name in ("window_size", "stride", "significance_level"):
        lines += assignment(name, literal(getattr(data, name)), 4)
    lines += _thresholds(data)
    for name in ("hold", "max_age", "single"):
        lines += assignment(name, literal(getattr(data, name)), 4)
    if data.array_backend != "numpy":
        lines += [f'    array_backend = "{data.array_backend}"']
    if data.axes is not None:
        lines += assignment("axes", _axes(data.axes), 4)
    what = "Features, each ascending" if data.axes is None else "Rows"
    lines += [f"    # {what}: {comment(data.about)}"]
    return [*lines, *assignment("reference", _table(data.sample), 4)]


def tables_of(model_file: ModelFile) -> Mapping[str, str]:
    """Return name -> SHA-256 of the files of numbers that the monitor reads.

    Raises:
        ModelError: the model is wrong.
    """
    data = read_safeml(model_file)
    tables = [data.sample, *([data.axes.table] if data.axes is not None else [])]
    return {table.file: table.sha256 for table in tables if table.numbers is None}


def _thresholds(data: SafeMLData) -> list[str]:
    sizes = f"of {data.size} reference values and {data.window_size} of the window"
    scaled = f": {data.size * data.window_size} D" if data.metric == "ks" else ""
    lines = [f"    # Distance {sizes}{scaled}"]
    for name in ("threshold", "threshold_theoretical"):
        lines += assignment(name, literal(getattr(data, name)), 4)
    if data.metric == "ks":
        return [*lines, f"    tail = safeml.Kolmogorov({data.size}, {data.window_size})"]
    points, slope = critical_values(data.metric, data.size, data.window_size)
    lines += ["    # Critical values with their levels, and the slope beyond"]
    law = call("safeml.Interpolated", [literal(tuple(points)), number(slope)])
    return [*lines, *assignment("tail", law, 4)]


def _axes(axes: Axes) -> Part:
    names = ["means", "divisors", *(f"component {k}" for k in range(axes.table.rows - 2))]
    floor = {} if axes.floor is None else {"floor": number(axes.floor)}
    return call("safeml.Axes", [_table(axes.table, names)], **floor)


def _table(table: Table, names: Sequence[str] = ()) -> Part:
    if table.numbers is None:
        shape = literal((table.rows, table.columns))
        texts = (text_literal(table.file), text_literal(table.sha256))
        return call("safeml.Table", ["__spec__", *texts, shape])
    above = names or [""] * table.rows
    rows = (tuple_of(map(number, row)) for row in table.numbers)
    return tuple_of(Item(row, above=name) for row, name in zip(rows, above, strict=True))
