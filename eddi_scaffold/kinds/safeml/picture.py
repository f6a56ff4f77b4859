"""The picture of a SafeML monitor: what goes through which tests to the verdict."""

from __future__ import annotations

from eddi_scaffold.diagrams import Diagram, DiagramEdge, DiagramNode, LegendEntry
from eddi_scaffold.kinds.safeml.model import METRIC_NAMES, Plan, SafeMLFile

_SHOWN = 8
_LEGEND = (
    LegendEntry("samples", "rounded", "input"),
    LegendEntry("comparison", "table", "gate"),
    LegendEntry("verdict", "hexagon", "output"),
)


def picture(name: str, file: SafeMLFile, plan: Plan | None) -> Diagram:
    """Return what a picture of the monitor shows; without thresholds where there are none."""
    settings = file.settings
    rows, features = file.reference.rows.shape
    level = f"{100 * settings.significance_level:.3g} %"
    nodes = (
        DiagramNode("window", ("samples", f"the last {settings.window_size}"), "rounded", "input"),
        DiagramNode(
            "reference",
            (file.reference.source.file_name, f"{rows} rows, {features} features"),
            "rounded",
            "input",
        ),
        DiagramNode("tests", (METRIC_NAMES[settings.metric], *_tests(plan)), "table", "gate"),
        DiagramNode("verdict", ("odd_violation", f"level {level}"), "hexagon", "output"),
    )
    edges = (
        DiagramEdge("window", "tests"),
        DiagramEdge("reference", "tests"),
        DiagramEdge("tests", "verdict", _threshold(plan)),
    )
    text = "samples and reference are compared, and the largest distance decides"
    return Diagram(f"SafeML {name}", nodes, edges, "down", _LEGEND, text)


def _tests(plan: Plan | None) -> tuple[str, ...]:
    if plan is None:
        return ("no thresholds",)
    more = plan.tests - _SHOWN
    return (*plan.labels[:_SHOWN], *((f"and {more} more",) if more > 0 else ()))


def _threshold(plan: Plan | None) -> str:
    return "" if plan is None else f">= {plan.scale(plan.threshold):.4g}"
