"""Standalone monitors from the intermediate form: one printer per language."""

from __future__ import annotations

from typing import Literal

from eddi_scaffold.language.analysis import Analysis
from eddi_scaffold.language.targets.c import c_files
from eddi_scaffold.language.targets.monitor_model import monitor_model
from eddi_scaffold.language.targets.python import python_module
from eddi_scaffold.problems import EddiError, error

Target = Literal["python", "c"]
_PRINTERS = {"python": python_module, "c": c_files}


def generate(analysis: Analysis, target: Target, name: str) -> dict[str, str]:
    """Return file name -> text of a standalone monitor.

    Args:
        analysis: of a text without errors.
        target: the language.
        name: what files and functions begin with; any text.

    Raises:
        EddiError: the language has no lists or texts yet (E026).
    """
    model = monitor_model(analysis, name)
    lists = [one.input.name for one in model.given if one.input.list or one.input.type == "text"]
    if target == "c" and lists:
        message = f"the target c takes neither lists nor texts yet: {', '.join(lists)}"
        hint = "--target python, or give the reduced value as a variable: VAR nearest : NUMBER"
        raise EddiError(error("E026", message, hint=hint))
    return _PRINTERS[target](model)
