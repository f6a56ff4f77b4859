"""What both targets print: a program with names for everything."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

from eddi_scaffold.common.escaping import c_comment
from eddi_scaffold.compiling.program.instructions import Program
from eddi_scaffold.compiling.program.sampling import HostInput, Sampling
from eddi_scaffold.targets.names import module_name, unique_names


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
class StandaloneMonitor:
    """One monitor to print.

    Attributes:
        name: what files and functions begin with.
        kind: of its model, ``event`` or ``consert``.
        program: what it does.
        variables: an identifier for each variable.
        events: an identifier for each output.
        numeric: the only output is a number.
        source: lines of the text, for comments.
        units: value of the host -> its unit.
        enums: name of the ENUM of each variable, empty for none.
        sampling: from what the host gives to the variables.
        given: what the host gives.
    """

    name: str
    kind: str
    program: Program
    variables: tuple[str, ...]
    events: tuple[str, ...]
    numeric: bool
    source: tuple[str, ...]
    units: Mapping[str, str]
    enums: tuple[str, ...]
    sampling: Sampling
    given: tuple[HostArgument, ...] = ()

    @property
    def has_lists(self) -> bool:
        """Whether a variable is made of lists."""
        return any(variable.reduction is not None for variable in self.program.reads)


def named(
    program: Program,
    name: str,
    source: Sequence[str],
    *,
    kind: str = "event",
    units: Mapping[str, str] | None = None,
    enums: Mapping[str, str] | None = None,
) -> StandaloneMonitor:
    """Return what is printed of a program.

    Args:
        kind: of its model, ``event`` or ``consert``.
        program: what it does.
        name: of the monitor; any text.
        source: lines on what it was made of.
        kind: of its model.
        units: value of the host -> its unit.
        enums: what is read -> name of its ENUM.
    """
    model = StandaloneMonitor(
        name=module_name(name),
        kind=kind,
        program=program,
        variables=tuple(unique_names(read.name for read in program.reads)),
        events=tuple(unique_names(result.id for result in program.results)),
        numeric=[program.operations[result.operation].type for result in program.results]
        == ["number"],
        source=tuple(map(c_comment, source)),
        units=units or {},
        enums=tuple((enums or {}).get(read.name, "") for read in program.reads),
        sampling=Sampling(program),
    )
    return replace(model, given=_given(model))


def _given(model: StandaloneMonitor) -> tuple[HostArgument, ...]:
    """Return what the host gives: variables as they are, and the parts of reductions."""
    inputs = model.sampling.inputs
    plain = {
        read.name: (model.variables[k], describe(model, k))
        for k, read in enumerate(model.program.reads)
        if read.reduction is None
    }
    taken = [*model.variables]
    found = []
    for number, input_ in enumerate(inputs):
        if input_.name not in plain:
            taken.append(unique_names([*taken, input_.name])[-1])
            unit = f", in {model.units[input_.name]}" if model.units.get(input_.name) else ""
            shown = f"{input_.name}, {'list of ' if input_.list else ''}{input_.type}{unit}"
            plain[input_.name] = taken[-1], c_comment(shown)
        stamped = any(
            read.stamped and number in used
            for read, used in zip(model.program.reads, model.sampling.uses, strict=True)
        )
        found.append(HostArgument(input_, *plain[input_.name], stamped))
    return tuple(found)


def describe(model: StandaloneMonitor, number: int) -> str:
    """Return one line on a variable: type, unit, range, timeout."""
    variable = model.program.reads[number]
    parts = [variable.name, variable.type if not model.enums[number] else model.enums[number]]
    if model.units.get(variable.name):
        parts.append(f"in {model.units[variable.name]}")
    if variable.range is not None:
        parts.append(f"from {variable.range[0]!r} to {variable.range[1]!r}")
    if variable.infinite:
        parts.append("may be infinite")
    if variable.about:
        parts.append(variable.about)
    if variable.timeout is not None:
        parts.append(f"UNKNOWN after {variable.timeout / 1e9:g} s without a new sample")
    return c_comment(", ".join(parts))
