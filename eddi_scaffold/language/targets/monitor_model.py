"""What both targets print: the checked form with names for everything."""

from __future__ import annotations

from dataclasses import dataclass, replace

from eddi_scaffold.compiling.expressions.form import Form, read_form
from eddi_scaffold.compiling.expressions.sampling import HostInput, Sampling
from eddi_scaffold.escaping import c_comment
from eddi_scaffold.language.analysis import Analysis
from eddi_scaffold.language.targets.names import module_name, unique_names


@dataclass(frozen=True)
class HostArgument:
    """One value that the host gives.

    Attributes:
        input: its name and type.
        word: an identifier.
        description: one line on it.
        stamped: the time of its sample is asked for.
    """

    input: HostInput
    word: str
    description: str
    stamped: bool


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
        sampling: from what the host gives to the variables.
        given: what the host gives.
    """

    name: str
    form: Form
    variables: tuple[str, ...]
    events: tuple[str, ...]
    numeric: bool
    source: tuple[str, ...]
    units: tuple[str, ...]
    enums: tuple[str, ...]
    sampling: Sampling
    given: tuple[HostArgument, ...] = ()

    @property
    def has_lists(self) -> bool:
        """Whether a variable is made of lists."""
        return any(variable.reduction is not None for variable in self.form.variables)


def monitor_model(analysis: Analysis, name: str) -> MonitorModel:
    """Return what is printed of an analysis without errors.

    Args:
        analysis: of the text.
        name: of the monitor; any text.
    """
    assert analysis.form is not None
    form = read_form(analysis.form)
    model = MonitorModel(
        name=module_name(name),
        form=form,
        variables=tuple(unique_names(variable.name for variable in form.variables)),
        events=tuple(unique_names(output.id for output in form.outputs)),
        numeric=form.nodes[form.outputs[0].node].type == "number",
        source=tuple(c_comment(line) for line in analysis.text.strip().split("\n")),
        units=tuple(variable.unit or "" for variable in analysis.variables),
        enums=tuple(variable.type.enum if variable.type else "" for variable in analysis.variables),
        sampling=Sampling(form),
    )
    return replace(model, given=_given(model, analysis))


def _given(model: MonitorModel, analysis: Analysis) -> tuple[HostArgument, ...]:
    """Return what the host gives: variables as they are, and the parts of reductions."""
    inputs = model.sampling.inputs
    plain = {
        variable.name: (model.variables[k], describe(model, k))
        for k, variable in enumerate(model.form.variables)
        if variable.reduction is None
    }
    taken = [*model.variables]
    units = {one.name: one.unit for one in analysis.inputs}
    found = []
    for number, one in enumerate(inputs):
        if one.name not in plain:
            taken.append(unique_names([*taken, one.name])[-1])
            unit = f", in {units[one.name]}" if units.get(one.name) else ""
            shown = f"{one.name}, {'list of ' if one.list else ''}{one.type}{unit}"
            plain[one.name] = taken[-1], c_comment(shown)
        stamped = any(
            variable.stamped and number in used
            for variable, used in zip(model.form.variables, model.sampling.uses, strict=True)
        )
        found.append(HostArgument(one, *plain[one.name], stamped))
    return tuple(found)


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
    return c_comment(", ".join(parts))
