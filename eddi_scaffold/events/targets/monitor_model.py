"""What both targets print: the checked form with names for everything."""

from __future__ import annotations

from dataclasses import dataclass

from eddi_runtime.event.form import Form, read_form

from eddi_scaffold.events.analysis import Analysis
from eddi_scaffold.events.targets.names import module_name, one_line, unique_names


@dataclass(frozen=True)
class MonitorModel:
    """One monitor to print.

    Attributes:
        name: what files and functions begin with.
        form: the checked form.
        variables: an identifier for each variable.
        events: an identifier for each output.
        numeric: the only output is a number.
        source: lines of the text, for comments.
        units: unit of each variable, empty for none.
        enums: name of the ENUM of each variable, empty for none.
    """

    name: str
    form: Form
    variables: tuple[str, ...]
    events: tuple[str, ...]
    numeric: bool
    source: tuple[str, ...]
    units: tuple[str, ...]
    enums: tuple[str, ...]


def monitor_model(analysis: Analysis, name: str) -> MonitorModel:
    """Return what is printed of an analysis without errors.

    Args:
        analysis: of the text.
        name: of the monitor; any text.
    """
    assert analysis.form is not None
    form = read_form(analysis.form)
    return MonitorModel(
        name=module_name(name),
        form=form,
        variables=tuple(unique_names(variable.name for variable in form.variables)),
        events=tuple(unique_names(output.id for output in form.outputs)),
        numeric=form.nodes[form.outputs[0].node].type == "number",
        source=tuple(one_line(line) for line in analysis.text.strip().split("\n")),
        units=tuple(variable.unit or "" for variable in analysis.variables),
        enums=tuple(variable.type.enum if variable.type else "" for variable in analysis.variables),
    )


def describe(model: MonitorModel, number: int) -> str:
    """Return one line on a variable: type, unit, range, timeout."""
    variable = model.form.variables[number]
    parts = [variable.name, variable.type if not model.enums[number] else model.enums[number]]
    if model.units[number]:
        parts.append(f"in {model.units[number]}")
    if variable.range is not None:
        parts.append(f"from {variable.range[0]!r} to {variable.range[1]!r}")
    if variable.infinite:
        parts.append("may be infinite")
    if variable.timeout is not None:
        parts.append(f"UNKNOWN after {variable.timeout / 1e9:g} s without a new sample")
    return one_line(", ".join(parts))
