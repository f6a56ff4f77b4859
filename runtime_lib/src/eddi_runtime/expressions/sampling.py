"""What a host gives for each variable of a form: values as they are, and lists that are reduced."""

from __future__ import annotations

from typing import Any, Dict, List, NamedTuple, Sequence, Tuple

from .form import Form


class HostInput(NamedTuple):
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
    literals: Tuple[str, ...] = ()


class Sampling:
    """From the values that a host gives to those that ``Engine.step`` takes.

    Attributes:
        inputs: what the host gives, once each, in the order of the variables.
        uses: for each variable the numbers of the inputs that it is made of.
        reasons: for each variable why it was UNKNOWN in the last step, as far as its lists show it.
    """

    def __init__(self, form: Form) -> None:
        found: Dict[str, HostInput] = {}
        self.uses: List[List[int]] = []
        for variable in form.variables:
            if variable.reduction is None:
                kind = "text" if variable.text else variable.type
                given = [HostInput(variable.name, kind, False, variable.literals)]
            else:
                given = [
                    HostInput(one["name"], one["type"], one.get("list") is True)
                    for one in variable.reduction.inputs
                ]
            for one in given:
                found.setdefault(one.name, one)
            numbers = {name: k for k, name in enumerate(found)}
            self.uses.append([numbers[one.name] for one in given])
        self.inputs = tuple(found.values())
        self.reasons = [""] * len(form.variables)
        self._variables = form.variables

    def raws(self, values: Sequence[Any]) -> List[Any]:
        """Return a raw value for each variable; never raises."""
        return [self.raw(k, [values[one] for one in used]) for k, used in enumerate(self.uses)]

    def raw(self, number: int, values: Sequence[Any]) -> Any:
        """Return the raw value of one variable, of the inputs that it uses; never raises."""
        reduction = self._variables[number].reduction
        if reduction is None:
            return values[0]
        value, self.reasons[number] = reduction.value(values)
        return value
