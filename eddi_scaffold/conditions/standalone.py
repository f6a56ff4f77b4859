"""Standalone monitors of a checked text."""

from __future__ import annotations

from eddi_scaffold.common.problems import Place, Problem, problem
from eddi_scaffold.conditions.analysis import Analysis
from eddi_scaffold.program.builder import read_form
from eddi_scaffold.program.c_files import c_files
from eddi_scaffold.program.standalone import StandaloneMonitor, Target, named
from eddi_scaffold.program.standalone_python import python_module

__all__ = ["Target", "generate", "monitor_model", "without_limits"]

_FILES = {"python": python_module, "c": c_files}


def generate(analysis: Analysis, target: Target, name: str) -> dict[str, str]:
    """Return file name -> text of a standalone monitor.

    Args:
        analysis: of a text without errors.
        target: the language.
        name: what files and functions begin with; any text.

    Raises:
        EddiError: the language has no lists or texts yet (E026).
    """
    return _FILES[target](monitor_model(analysis, name))


def without_limits(analysis: Analysis, file: str) -> list[Problem]:
    """Report the variables without a VAR: no sample of theirs gets old (W003).

    Args:
        analysis: of a text without errors; it reports those with a VAR itself.
        file: name of the text.
    """
    of = [input_ for input_ in analysis.inputs if input_.timeout is None and not input_.declared]
    if not of:
        return []
    names = ", ".join(one.name for one in of)
    type_ = of[0].type.kind.upper() if of[0].type is not None else "NUMBER"
    return [problem("W003.variables", Place(file), names=names, example=of[0].name, kind=type_)]


def monitor_model(analysis: Analysis, name: str) -> StandaloneMonitor:
    """Return what is printed of an analysis without errors.

    Args:
        analysis: of the text.
        name: of the monitor; any text.
    """
    assert analysis.form is not None
    units = {one.name: one.unit or "" for one in (*analysis.inputs, *analysis.variables)}
    enums = {
        variable.name: variable.type.enum
        for variable in analysis.variables
        if variable.type is not None
    }
    source = analysis.text.strip().split("\n")
    return named(read_form(analysis.form), name, source, units=units, enums=enums)
