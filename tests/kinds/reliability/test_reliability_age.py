"""What had run before the mission: the same numbers as after that many hours of mission."""

import math
from typing import Any

import pytest
from eddi_runtime.reliability.component import hazard
from hypothesis import given
from hypothesis import strategies as st

from tests.kinds.reliability.monitors import at_start, compiled, sound

TREE = (
    "horizon: 2 h\nmodels: {{t: {{type: fault_tree{age}, gates: {{T: {{type: OR, of: [A, B, C]}}"
    "}}, events: {{A: {{rate: 1e-3 1/h{own}}}, B: {{scale: 900 h, shape: 2, observed: true}}, "
    "C: {{p: 0.001}}}}}}}}\n"
)


def p_fail(text: str, **values: Any) -> float:
    found = at_start(sound(text), **values)
    assert found.valid
    return float(found.p_fail)


def test_a_tree_that_has_run_500_hours() -> None:
    a, b = 1e-3 * 502, (502 / 900) ** 2 - (500 / 900) ** 2
    expected = 1 - 0.999 * math.exp(-a - b)
    text = TREE.format(age=", age: 500 h", own="")
    assert p_fail(text, t_B=False) == pytest.approx(expected, rel=1e-12)
    own = TREE.format(age=", age: 500 h", own=", age: 2 day")
    expected = 1 - 0.999 * math.exp(-1e-3 * 50 - b)
    assert p_fail(own, t_B=False) == pytest.approx(expected, rel=1e-12)
    new = 1 - 0.999 * math.exp(-1e-3 * 2 - (2 / 900) ** 2)
    assert p_fail(TREE.format(age="", own=""), t_B=False) == pytest.approx(new, rel=1e-12)


def test_ages_add_up_with_the_mission() -> None:
    aged = compiled(sound(TREE.format(age=", age: 500 h", own="") + "max_gap: 1000 h\n"))
    new = compiled(sound(TREE.format(age="", own="") + "max_gap: 1000 h\n"))
    hour = 3600 * 10**9
    values = type("Values", (), {"t_B": False})()
    aged.execute_step(values, 0)
    new.execute_step(values, 0)
    ours = aged.execute_step(values, 100 * hour)
    assert ours.valid
    assert ours.p_fail == pytest.approx(new.execute_step(values, 600 * hour).p_fail, rel=1e-12)
    aged.reset()
    again = aged.execute_step(values, 7)
    assert again.p_fail == pytest.approx(new_at(500), rel=1e-12)


def new_at(hours: float) -> float:
    a, b = 1e-3 * (hours + 2), ((hours + 2) / 900) ** 2 - (hours / 900) ** 2
    return 1 - 0.999 * math.exp(-a - b)


A, B, ETA = 0.02, 0.05, 400 / math.gamma(1.5)
RUN = {
    "{c: {type: markov, initial: up, fail: down, age: 30 h, arcs: [{from: up, to: half, rate: "
    "0.02 1/h}, {from: half, to: down, rate: 0.05 1/h}]}}": (
        1 - (B * math.exp(-A * 32) - A * math.exp(-B * 32)) / (B - A)
    ),
    "{c: {type: processor, mttf_ref: 400 h, t_ref: 51 degC, t_max: 90 degC, u_max: 1, shape: 2, "
    "age: 300 h}}": -math.expm1((300 / ETA) ** 2 - (302 / ETA) ** 2),
    "{t: {type: fault_tree, age: 30 h, gates: {G: {type: PAND, of: [A, B]}}, events: {A: {rate: "
    "0.02 1/h}, B: {rate: 0.05 1/h}}}}": (
        1 - math.exp(-B * 32) + B / (A + B) * math.expm1(-(A + B) * 32)
    ),
}


@pytest.mark.parametrize(("models", "expected"), RUN.items())
def test_what_has_run_for_hours(models: str, expected: float) -> None:
    values = {"c_temperature": 51.0, "c_utilisation": 1.0} if "processor" in models else {}
    found = p_fail(f"horizon: 2 h\nmodels: {models}\n", **values)
    assert found == pytest.approx(expected, rel=1e-11)


@given(
    st.floats(0.0, 1e9) | st.just(0.0),
    st.floats(0.0, 1e6),
    st.floats(1e-3, 1e9),
    st.floats(1e-6, 1e6),
)
def test_no_hazard_stops_a_step(age: float, ahead: float, scale: float, shape: float) -> None:
    assert 0.0 <= hazard(age, ahead, scale, shape) <= math.inf


@pytest.mark.parametrize("age", [0.0, 1e-12, 1e-3, 1.0, 1e3, 1e8])
@pytest.mark.parametrize("shape", [1e-3, 0.5, 1.0, 2.5, 80.0])
def test_hazards_keep_their_digits(age: float, shape: float) -> None:
    mpmath = pytest.importorskip("mpmath", reason="mpmath is a peer, not a dependency")
    for ahead in (1e-6, 0.5, 100.0):
        with mpmath.workdps(80):
            whole, start = mpmath.mpf(age) + mpmath.mpf(ahead), mpmath.mpf(age)
            expected = (whole / 5000) ** shape - (start / 5000) ** shape
            exact = float(expected)
        assert hazard(age, ahead, 5000.0, shape) == pytest.approx(exact, rel=2e-12, abs=1e-300)
