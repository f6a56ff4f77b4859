"""What a person should know of a SafeML monitor: thresholds, false alarms, what it can detect."""

from __future__ import annotations

from collections.abc import Sequence
from statistics import NormalDist

import numpy as np
from eddi_runtime.safeml.comparison import Comparison

from eddi_scaffold.common.escaping import markdown_text
from eddi_scaffold.diagrams import Diagram, DiagramEdge, DiagramNode, LegendEntry
from eddi_scaffold.kinds.safeml.scope import METRIC_NAMES, Plan, SafeMLFile
from eddi_scaffold.kinds.safeml.thresholds import of_windows

_LARGEST_SHIFT = 100.0
_SHOWN = 8
_LEGEND = (
    LegendEntry("samples", "rounded", "input"),
    LegendEntry("comparison", "table", "gate"),
    LegendEntry("verdict", "hexagon", "output"),
)


def outline(file: SafeMLFile, plan: Plan | None) -> Sequence[str]:
    """Return the lines that ``show`` prints."""
    settings, name = file.settings, file.reference.source.file_name
    rows, features = file.reference.rows.shape
    facts = ["no thresholds: see `check`"] if plan is None else _facts(plan)
    return [
        f"{METRIC_NAMES[settings.metric]} of the last {settings.window_size} samples",
        f"  reference {name}: {rows} rows, {features} features",
        *(f"  {fact}" for fact in facts),
    ]


def readme(plan: Plan, frequency: float | None) -> Sequence[str]:
    """Return lines of Markdown for the package's README."""
    settings, level = plan.settings, plan.settings.significance_level
    alarms = f"of correct steps, at most about {_percent(level)} are false violations"
    if frequency is not None:
        alarms += f": {level * frequency * 3600:,.0f} per hour at {frequency:g} Hz, in episodes"
    metric = METRIC_NAMES[settings.metric]
    lines = [
        f"{metric} of the last {settings.window_size} samples to {plan.n} reference samples:",
        "",
        *(f"- {markdown_text(fact)}" for fact in _facts(plan)),
        f"- {alarms}",
    ]
    shift = detectable_shift(plan)
    if shift is not None:
        lines.append(
            f"- in every other window or more it finds a shift of {shift:.2g} standard deviations "
            "of one tested value (normally distributed)"
        )
    held = "the last one" if settings.on_omission == "hold" else "false"
    verdict = (
        f"`omission` means that there is no verdict; then `odd_violation` is {held}. Evidence is "
        "`NOT omission AND NOT odd_violation` (`in_scope` of the status message), never "
        "`NOT odd_violation` alone."
    )
    return [*lines, "", verdict, ""]


def detectable_shift(plan: Plan) -> float | None:
    """Return the shift at which a typical window reaches the threshold.

    Typical: its values are the quantiles of a normal distribution, as are those of the reference.
    ``None`` when even the largest shift does not reach it.
    """
    normal, m = NormalDist(), plan.settings.window_size
    reference, window = (
        np.array([normal.inv_cdf((k + 0.5) / count) for k in range(count)]) for count in (plan.n, m)
    )
    comparison = Comparison(plan.settings.metric, reference[None], m)

    def reaches(shift: float) -> bool:
        statistic = of_windows(comparison, (window + shift)[None, None, :])[0, 0]
        return bool(statistic >= plan.threshold)

    low, high = 0.0, _LARGEST_SHIFT
    if not reaches(high):
        return None
    while high - low > 1e-3:
        middle = (low + high) / 2
        low, high = (low, middle) if reaches(middle) else (middle, high)
    return high


def _facts(plan: Plan) -> Sequence[str]:
    tests = f"{plan.tests} tests" if plan.tests > 1 else "one test"
    kinds = "features" if plan.design.table is None else "principal components"
    residual = " and the residual" if plan.design.floor is not None else ""
    how = f" ({plan.method}, for independent samples)"
    if plan.calibration:
        theoretical = f"{plan.scale(plan.theoretical):.4g}, {plan.method}"
        ratio = f"{plan.threshold / plan.theoretical:.2f} times"
        windows = plan.calibration.windows
        how = f", calibrated with {windows} windows (theoretical: {theoretical}; {ratio})"
    value, test = plan.autocorrelation
    together = _percent(plan.settings.significance_level)
    return (
        f"{tests} ({kinds}{residual}) at {plan.level:.3g} each: {together} together",
        f"threshold {plan.scale(plan.threshold):.4g}{how}",
        f"largest autocorrelation of neighbouring samples: {value:.2f} ({plan.labels[test]})",
    )


def _percent(level: float) -> str:
    return f"{100 * level:.3g} %"


def picture(name: str, file: SafeMLFile, plan: Plan | None) -> Diagram:
    """Return what a picture of the monitor shows; without thresholds where there are none."""
    settings, source = file.settings, file.reference.source
    rows, features = file.reference.rows.shape
    tests, threshold = ["no thresholds"], ""
    if plan is not None:
        tests, threshold = list(plan.labels[:_SHOWN]), f">= {plan.scale(plan.threshold):.4g}"
        tests += [f"and {plan.tests - _SHOWN} more"] if plan.tests > _SHOWN else []
    window = ("samples", f"the last {settings.window_size}")
    reference = (source.file_name, f"{rows} rows, {features} features")
    level = f"level {_percent(settings.significance_level)}"
    nodes = (
        DiagramNode("window", window, "rounded", "input"),
        DiagramNode("reference", reference, "rounded", "input"),
        DiagramNode("tests", (METRIC_NAMES[settings.metric], *tests), "table", "gate"),
        DiagramNode("verdict", ("odd_violation", level), "hexagon", "output"),
    )
    edges = (
        DiagramEdge("window", "tests"),
        DiagramEdge("reference", "tests"),
        DiagramEdge("tests", "verdict", threshold),
    )
    text = "samples and reference are compared, and the largest distance decides"
    return Diagram(f"SafeML {name}", nodes, edges, "down", _LEGEND, text)
