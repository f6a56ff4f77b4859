"""Whether a generated SafeML monitor has the settings and the reference of its model."""

from __future__ import annotations

import ast
import hashlib
from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING

import numpy as np

from eddi_scaffold.evidence.emitted import Call, Emitted

if TYPE_CHECKING:
    from eddi_scaffold.kinds.safeml.scope import ReferenceSample, Rows, SafeMLOptions

_ROUNDED = 1e-8  # part by which a written threshold may be above the one that was found
_MOST_IN_TEXT = 2000  # numbers of a table; more are in a file


_NAMES = {"ks": "KolmogorovSmirnov", "cvm": "CramerVonMises", "ad": "AndersonDarling"}


def verify(
    reference: ReferenceSample,
    options: SafeMLOptions,
    critical: tuple[Sequence[tuple[float, float]], float] | None,
    emitted: Emitted,
) -> Iterator[str]:
    """Compare a text with its model, thresholds and axes with those found; yield what is proved.

    ``critical`` are critical values with their levels and the slope beyond, of no KS test.
    """
    monitor = emitted.monitor("safeml.SafeML")
    plan, settings, design = options.plan, options.plan.settings, options.plan.design
    metric, window, backend = settings.metric, settings.window_size, settings.array_backend
    tail = Call("safeml.Kolmogorov", (plan.n, window))
    if critical is not None:
        tail = Call("safeml.Interpolated", (tuple(critical[0]), critical[1]))
    expected = {
        "metric": metric,
        "metric_name": f"{_NAMES[metric]}Distance",
        "window_size": window,
        "stride": settings.stride,
        "significance_level": settings.significance_level,
        "tail": tail,
        "hold": settings.on_omission == "hold",
        "single": plan.single,
        "array_backend": None if backend == "numpy" else backend,
    }
    for name, value in expected.items():
        emitted.attribute(monitor, name, value)
    emitted.same("max_age", monitor.attributes.pop("max_age", None), options.max_age)
    for name, found in (("threshold", plan.threshold), ("threshold_theoretical", plan.theoretical)):
        node = monitor.attributes.get(name)
        written = node.value if isinstance(node, ast.Constant) else None
        is_near = isinstance(written, float) and found <= written <= found * (1 + _ROUNDED)
        wanted = int(found) if metric == "ks" else written if is_near else found
        emitted.attribute(monitor, name, wanted)
    rows = reference.rows.astype(np.float32).astype(np.float64) if plan.single else reference.rows
    if plan.calibration is not None or design.table is not None:
        rows = rows[: len(rows) // 2]
    axes = None
    if design.table is not None:
        floor = {} if design.floor is None else {"floor": design.floor}
        axes = Call("safeml.Axes", (_table("axes.bin", design.table),), floor)
    emitted.attribute(monitor, "axes", axes)
    sample = np.sort(rows.T) if design.table is None else rows
    emitted.attribute(monitor, "reference", _table("reference.bin", sample))
    emitted.end(monitor)
    count, features = rows.shape
    yield f"settings; the reference: {count} rows of {features} features"
    yield "thresholds and axes as generation found them"


def _table(file: str, rows: Rows) -> object:
    """Return the numbers, or of many the digest of their file."""
    if rows.size <= _MOST_IN_TEXT:
        return tuple(map(tuple, rows.tolist()))
    digest = hashlib.sha256(rows.astype("<f8").tobytes()).hexdigest()
    return Call("safeml.Table", (Call("__spec__"), file, digest, rows.shape))
