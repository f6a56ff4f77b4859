"""Standalone monitors from programs: one printer per language."""

from __future__ import annotations

from typing import Literal

from eddi_scaffold.common.problems import EddiError, problem
from eddi_scaffold.targets.c import c_files
from eddi_scaffold.targets.monitor_model import StandaloneMonitor
from eddi_scaffold.targets.python import python_module

Target = Literal["python", "c"]
_PRINTERS = {"python": python_module, "c": c_files}


def printed(model: StandaloneMonitor, target: Target) -> dict[str, str]:
    """Return file name -> text of a standalone monitor.

    Args:
        model: what it does, with names for everything.
        target: the language.

    Raises:
        EddiError: the language has no lists or numbers in texts yet (E026).
    """
    given = [(read, model.sampling.uses[k]) for k, read in enumerate(model.program.reads)]
    used = {use for read, uses in given if read.reduction is not None or read.text for use in uses}
    inputs = [model.sampling.inputs[one] for one in sorted(used)]
    lists = [input_.name for input_ in inputs if input_.list or input_.type == "text"]
    if target == "c" and lists:
        raise EddiError(problem("E026.lists", lists=", ".join(lists)))
    return _PRINTERS[target](model)
