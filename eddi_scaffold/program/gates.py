"""Gates of fault trees as conditions of their basic events, in each step."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

from eddi_scaffold.common.graphs import cycles, in_order
from eddi_scaffold.common.problems import Place
from eddi_scaffold.program.instructions import Builder, Operation, Program, Read, Result

_ORDERED = ("PAND", "POR", "SAND")  # whose value depends on the order of what happened
GATES = ("OR", "AND", "NOT", "XOR", "VOTE", *_ORDERED)


@dataclass(frozen=True)
class Gate:
    """A gate; what is no gate is a basic event."""

    type: str
    of: tuple[str, ...]  # names of gates and events
    k: int | None = None  # of a VOTE
    place: Place = field(default=Place(), compare=False)


def below(gates: Mapping[str, Gate], top: str) -> dict[str, tuple[str, ...]]:
    """Return a cause and all below it, each with what it is made of."""
    waiting, causes = [top], dict[str, tuple[str, ...]]()
    while waiting:
        name = waiting.pop()
        if name not in causes:
            causes[name] = gates[name].of if name in gates else ()
            waiting += reversed(causes[name])
    return causes


def fault_of(gates: Mapping[str, Gate], top: str) -> str:
    """Return why a cause has no value in each step, empty where it has one."""
    causes = below(gates, top)
    for name, gate in ((name, gates[name]) for name in causes if name in gates):
        number = {"NOT": 1, "XOR": 2}.get(gate.type, len(gate.of))
        if gate.type in _ORDERED:
            return f"{gate.type} {name!r} depends on an order"
        if len(gate.of) != number:
            return f"{gate.type} {name!r} has {len(gate.of)} inputs"
        if gate.type == "VOTE" and gate.k not in range(1, number + 1):
            return f"VOTE {name!r} does not say how many of {number} it needs"
    circles = cycles(causes)
    return f"{circles[0][0]!r} is a cause of itself" if circles else ""


def program_of(
    gates: Mapping[str, Gate], top: str, inputs: Mapping[str, str], rate: float
) -> Program:
    """Return the program of a cause without a fault, stepped ``rate`` times a second.

    ``inputs`` name for each basic event the Boolean input that says whether it has happened.
    """
    builder, values = Builder(), dict[str, int]()

    def add(op: str, args: Sequence[int], value: int | None = None) -> int:
        return builder.add(Operation(op, tuple(args), "bool", value, about=name))

    def at_least(number: int, args: Sequence[int]) -> int:
        row = [add("truth", (), 2)] + [add("truth", (), 0)] * number
        for arg in args:  # row[k]: at least k of those so far
            ands = [add("and", (fewer, arg)) for fewer in row[:-1]]
            pairs = zip(row[1:], ands, strict=True)
            row = [row[0], *(add("or", pair) for pair in pairs)]
        return row[number]

    causes = below(gates, top)
    for name in in_order(causes):
        gate, args = gates.get(name), [values[of] for of in causes[name]]
        if gate is None:
            read = Read(inputs[name], "bool")
            variable = Operation("variable", (), "bool", 0, about=name)
            (values[name],) = builder.append(Program(0, (read,), (variable,), ()))
        elif gate.type == "VOTE":
            values[name] = at_least(gate.k or 0, args)
        elif len(args) > 1 or gate.type == "NOT":
            values[name] = add(gate.type.lower(), args)
        else:  # a port without an input never occurs
            values[name] = args[0] if args else add("truth", (), 0)
    return builder.program(round(1e9 / rate), [Result(top, values[top])])
