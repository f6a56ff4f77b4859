"""Standalone monitors of a checked text."""

from __future__ import annotations

from eddi_scaffold.compiling.expressions.form import read_form
from eddi_scaffold.language.analysis import Analysis
from eddi_scaffold.targets import Target, printed
from eddi_scaffold.targets.monitor_model import MonitorModel, named

__all__ = ["Target", "generate", "monitor_model"]


def generate(analysis: Analysis, target: Target, name: str) -> dict[str, str]:
    """Return file name -> text of a standalone monitor.

    Args:
        analysis: of a text without errors.
        target: the language.
        name: what files and functions begin with; any text.

    Raises:
        EddiError: the language has no lists or texts yet (E026).
    """
    return printed(monitor_model(analysis, name), target)


def monitor_model(analysis: Analysis, name: str) -> MonitorModel:
    """Return what is printed of an analysis without errors.

    Args:
        analysis: of the text.
        name: of the monitor; any text.
    """
    assert analysis.form is not None
    units = {one.name: one.unit or "" for one in (*analysis.inputs, *analysis.variables)}
    enums = {one.name: one.type.enum for one in analysis.variables if one.type is not None}
    source = analysis.text.strip().split("\n")
    return named(read_form(analysis.form), name, source, units=units, enums=enums)
