"""Gates of fault trees as programs, against every value of their basic events."""

from itertools import product

import pytest

from eddi_scaffold.program.gates import Gate, fault_of, program_of
from eddi_scaffold.program.instructions import Program

VALUES = (0, 1, 2)  # FALSE, UNKNOWN, TRUE
DONE = {
    "and": min,
    "or": max,
    "not": lambda args: 2 - args[0],
    "xor": lambda args: 1 if 1 in args else 2 * (args[0] != args[1]),
}


def evaluated(program: Program, inputs: dict[str, int]) -> int:
    values: list[int] = []
    for operation in program.operations:
        args = [values[k] for k in operation.args]
        if operation.op == "variable":
            values.append(inputs[program.reads[operation.value].name])
        else:
            values.append(operation.value if operation.op == "truth" else DONE[operation.op](args))
    return values[program.results[0].operation]


def test_a_vote_needs_so_many() -> None:
    events = "abcd"
    for k in range(1, 5):
        program = program_of(
            {"top": Gate("VOTE", (*events,), k)}, "top", {e: e for e in events}, 10
        )
        for row in product(VALUES, repeat=4):
            wanted = sorted(row, reverse=True)[k - 1]
            assert evaluated(program, dict(zip(events, row, strict=True))) == wanted


def test_a_shared_event_is_read_once() -> None:
    gates = {
        "top": Gate("AND", ("left", "right")),
        "left": Gate("OR", ("a", "power")),
        "right": Gate("XOR", ("never", "power")),
        "never": Gate("NOT", ("port",)),
        "port": Gate("OR", ()),
    }
    program = program_of(gates, "top", {"a": "in_a", "power": "in_power"}, 10)
    assert sorted(read.name for read in program.reads) == ["in_a", "in_power"]
    for a, power in product(VALUES, repeat=2):
        wanted = min(max(a, power), 2 - power)
        assert evaluated(program, {"in_a": a, "in_power": power}) == wanted


@pytest.mark.parametrize(
    ("gate", "fault"),
    [
        (Gate("PAND", ("a", "b")), "PAND 'top' depends on an order"),
        (Gate("NOT", ("a", "b")), "NOT 'top' has 2 inputs"),
        (Gate("XOR", ("a",)), "XOR 'top' has 1 inputs"),
        (Gate("VOTE", ("a", "b")), "VOTE 'top' does not say how many of 2 it needs"),
        (Gate("VOTE", ("a", "b"), 3), "VOTE 'top' does not say how many of 2 it needs"),
        (Gate("OR", ("a", "top")), "'top' is a cause of itself"),
        (Gate("AND", ("a", "b")), ""),
    ],
)
def test_what_has_no_value_in_each_step(gate: Gate, fault: str) -> None:
    assert fault_of({"top": gate}, "top") == fault
