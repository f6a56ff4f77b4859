"""How long a condition holds after what it is about has ended."""

import math

from eddi_scaffold.conditions.analysis import analyse
from eddi_scaffold.conditions.lags import lags
from tests.data_files import tabled


@tabled
def test_seconds_after_unknown_and_after_a_bad_value(
    condition: str, unknown: float, value: float
) -> None:
    text = f"VAR x : NUMBER\nVAR b : BOOL\nVAR c : BOOL\nEVENT e (EVIDENCE) := {condition}"
    program = analyse(text, rate=10).program
    assert program is not None
    lag = lags(program, program.results[0].operation, 1)
    first = lag["x"] if "x" in lag else lag["b"]
    assert (round(first.unknown, 9), round(first.value, 9)) == (unknown, value)


def test_a_hazard_is_of_use_while_it_is_absent() -> None:
    program = analyse("VAR x : NUMBER\nONCE(x > 3, 1s) OR LATCH(x > 5, x < 2)", rate=10).program
    assert program is not None
    root = program.results[0].operation
    assert lags(program, root, -1)["x"].value == math.inf
    first = program.operations[root].args[0]
    assert lags(program, first, -1)["x"] == (0.0, 0.0)
    assert lags(program, first, 1)["x"] == (1.0, 1.0)
