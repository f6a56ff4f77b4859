"""What a host gives for each read of a program: values as they are, and lists to be reduced."""

from __future__ import annotations

from dataclasses import dataclass

from eddi_scaffold.compiling.program.instructions import Program


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
    """Which values of a host each read of a program is made of.

    Attributes:
        inputs: what the host gives, once each, in the order of the reads.
        uses: for each read the numbers of the inputs that it is made of.
    """

    def __init__(self, program: Program) -> None:
        found: dict[str, HostInput] = {}
        names: list[list[str]] = []
        for read in program.reads:
            if read.reduction is None:
                kind = "text" if read.text else read.type
                given = [HostInput(read.name, kind, False, read.literals)]
            else:
                given = [
                    HostInput(input_.name, input_.type, input_.is_list)
                    for input_ in read.reduction.inputs
                ]
            for one in given:
                found.setdefault(one.name, one)
            names.append([one.name for one in given])
        numbers = {name: k for k, name in enumerate(found)}
        self.inputs = tuple(found.values())
        self.uses = [[numbers[name] for name in used] for used in names]
