"""What a host gives for each variable of a form: values as they are, and lists that are reduced."""

from __future__ import annotations

from dataclasses import dataclass

from eddi_scaffold.compiling.expressions.form import Form


@dataclass(frozen=True)
class HostInput:
    """One value that a host gives in each step.

    Attributes:
        name: as in the text (``scan.ranges[*]``).
        type: ``number``, ``bool``, ``enum`` or ``text``.
        list: it is a list of these.
        literals: texts of an ENUM.
    """

    name: str
    type: str
    list: bool = False
    literals: tuple[str, ...] = ()


class Sampling:
    """Which values of a host each variable of a form is made of.

    Attributes:
        inputs: what the host gives, once each, in the order of the variables.
        uses: for each variable the numbers of the inputs that it is made of.
    """

    def __init__(self, form: Form) -> None:
        found: dict[str, HostInput] = {}
        names: list[list[str]] = []
        for variable in form.variables:
            if variable.reduction is None:
                kind = "text" if variable.text else variable.type
                given = [HostInput(variable.name, kind, False, variable.literals)]
            else:
                given = [
                    HostInput(one.name, one.type, one.is_list) for one in variable.reduction.inputs
                ]
            for one in given:
                found.setdefault(one.name, one)
            names.append([one.name for one in given])
        numbers = {name: k for k, name in enumerate(found)}
        self.inputs = tuple(found.values())
        self.uses = [[numbers[name] for name in used] for used in names]
