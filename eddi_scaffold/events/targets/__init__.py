"""Standalone monitors from the intermediate form: one printer per language."""

from __future__ import annotations

from typing import Literal

from eddi_scaffold.events.analysis import Analysis
from eddi_scaffold.events.targets.c import c_files
from eddi_scaffold.events.targets.monitor_model import monitor_model
from eddi_scaffold.events.targets.python import python_module

Target = Literal["python", "c"]
_PRINTERS = {"python": python_module, "c": c_files}


def generate(analysis: Analysis, target: Target, name: str) -> dict[str, str]:
    """Return file name -> text of a standalone monitor.

    Args:
        analysis: of a text without errors.
        target: the language.
        name: what files and functions begin with; any text.
    """
    return _PRINTERS[target](monitor_model(analysis, name))
