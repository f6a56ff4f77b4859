"""A system that uses every key of ``reliability_config.yml`` is exported as the same system."""

import json
import math
import re
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest
from eddi_runtime.reliability.component import hazard
from hypothesis import given
from hypothesis import strategies as st

from eddi_scaffold.common.problems import has_errors
from eddi_scaffold.kinds import Options
from eddi_scaffold.kinds.reliability.show import at_start as at_rest
from eddi_scaffold.kinds.reliability.show import outline, readme
from eddi_scaffold.kinds.reliability.system import TYPES, ReliabilitySystem
from eddi_scaffold.kinds.reliability.write import to_yaml
from tests.kinds.reliability.monitors import at_start, compiled, everything, read_text, sound

EVERY_KEY = (Path(__file__).parents[2] / "data/reliability/every_key.yml").read_text("utf-8")


def read(text: str) -> ReliabilitySystem:
    model, problems = read_text(text)
    assert [one for one in problems if one.level == "error"] == []
    assert model is not None
    system = model.data
    assert isinstance(system, ReliabilitySystem)
    return system


CHANGES = {
    "as it is": ("", ""),
    "a fixed horizon": ("horizon: mission_end\nmission_time: 3 h", "horizon: 30 min"),
    "nothing is accepted": ("on_unknown: worst_case\nmax_gap: 3 s\n", ""),
    "cut sets": ("    age: 100 h", "    approximation: cut_sets\n    node_limit: 5000"),
    "one rate": ("rates: [1e-5 1/h, 1e-5 1/h, 2e-5 1/h, 1e-5 1/h,\n    1e-5 1/h, 1e-5 1/h]",
                 "rate: 1e-5 1/h"),
}  # fmt: skip


@pytest.mark.parametrize("change", CHANGES)
def test_what_is_exported_reads_back_as_the_same(change: str) -> None:
    old, new = CHANGES[change]
    assert old in EVERY_KEY
    system = read(EVERY_KEY.replace(old, new, 1))
    text = to_yaml(system)
    assert read(text) == system, text
    assert to_yaml(read(text)) == text


def test_every_key_is_exported() -> None:
    keys = set(re.findall(r"\b([a-z][a-z_]*): ", EVERY_KEY))
    text = to_yaml(read(EVERY_KEY))
    assert {key for key in keys if not re.search(rf"\b{key}\b", text)} == set()


def test_every_key_is_shown() -> None:
    shown = "\n".join(outline(read(EVERY_KEY)))
    for line in (
        "threshold go: p_fail <= 0.0001, gone above 0.0002, after 1 s",
        "threshold stop: p_fail <= 0.001, gone above 0.001, after 0.25 s",
        "rates: 1e-05 1/h, 1e-05 1/h, 2e-05 1/h, 1e-05 1/h, 1e-05 1/h, 1e-05 1/h",
        "Fine (initial)\n    -> Blurred",
        "age 12 h",
        "2/3 Two",
        "PAND First",
        "Valve  1e-06 1/h, observed",
        "Pump  Weibull 900 h, shape 2, age 20 h",
        "Seal  p 0.001",
        "PowerFails  model Power",
        "2/3 Two (see above)",
    ):
        assert line in shown, shown


def test_the_readme_has_the_numbers_of_the_start() -> None:
    lines = readme(read(EVERY_KEY))
    assert lines[0].startswith("`Loss` fails within 3 h (the mission's end) with probability ")
    assert "| go | 0.0001 | 0.0002 | 1 s |" in lines
    assert "While an input is unknown, its worst case counts." in lines
    assert "- Seal, Valve" in lines


CPU = "c: {type: processor, mttf_ref: 400 h, t_ref: 51 degC, t_max: %s degC, u_max: %s}"
BATTERY = (
    "b: {type: battery, failure_rate: 1e-3 1/h, alpha: 1e-3 1/h, beta: 1e-3 1/h, degradation: "
    "1e-3 1/h, t_ref: 25 degC, t_max: %s degC, activation_energy: 0.5}"
)


@pytest.mark.parametrize("part", [CPU % (85, 0.5), CPU % (40, 2), BATTERY % 20, BATTERY % 60])
def test_what_is_in_order_is_within_its_range(part: str) -> None:
    model, problems = read_text(f"horizon: 1 h\nmodels: {{{part}}}\n")
    assert model is not None, problems
    start = at_rest(model.data)
    assert start.valid
    assert 0.0 < start.p_fail < at_rest(model.data, known=False).p_fail


MOTORS = "models: {m: {type: propulsion, configuration: PNPN, rate: 0.01 1/h}}\n"


@pytest.mark.parametrize(
    ("frequency", "given", "expected"),
    [(10.0, "", 1.0), (0.2, "", 12.5), (0.2, "max_gap: 6 s\n", 6.0), (0.2, "max_gap: 1 s\n", 1.0)],
)
def test_a_gap_is_longer_than_a_step_that_is_left_out(
    frequency: float, given: str, expected: float
) -> None:
    model, problems = read_text(MOTORS + given)
    assert model is not None, problems
    configured, problems = model.configure(Options(frequency=frequency))
    assert configured is not None, problems
    assert configured.data.usual_gap == expected
    late = [str(one.message) for one in problems if one.code == "R014"]
    if expected * frequency >= 1.0:
        assert late == []
    else:
        assert late == ["no step is ever valid: max_gap is 1 s, and a step comes each 5 s"]


def test_a_chain_may_be_repaired_when_its_file_says_so() -> None:
    text = (
        "models: {c: {type: markov, initial: ok, fail: stuck, arcs: [{from: ok, to: stuck, rate: "
        "1e-5 1/h}], observe: {ok: a, stuck: not a}, repair: true}}\n"
    )
    for words, p_fail in ((text, 1e-5), (text.replace(", repair: true", ""), 1.0)):
        model = sound(words)
        again, _ = read_text(to_yaml(model.data))
        assert again is not None
        assert again.data == model.data
        one = compiled(model)
        for i, value in enumerate((True, False, True)):
            result = one.execute_step(SimpleNamespace(a=value), i * 10**8)
        assert result.p_fail == pytest.approx(p_fail, rel=1e-3)


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


RATES = st.floats(1e-9, 1e3)


def chain(a: float, b: float, c: float, horizon: float) -> str:
    return (
        f"horizon: {horizon!r} h\nmodels: {{c: {{type: markov, initial: up, fail: down, arcs: ["
        f"{{from: up, to: half, rate: {a!r} 1/h}}, {{from: half, to: down, rate: {b!r} 1/h}}, "
        f"{{from: up, to: down, rate: {c!r} 1/h}}]}}}}\n"
    )


@given(RATES, RATES, RATES, st.floats(1e-6, 1e4), st.floats(1.0, 100.0))
def test_p_fail_grows_with_horizon_and_rates(
    a: float, b: float, c: float, horizon: float, factor: float
) -> None:
    base = at_start(sound(chain(a, b, c, horizon))).p_fail
    slack = 1.0 + 1e-10
    assert base <= at_start(sound(chain(a, b, c, horizon * factor))).p_fail * slack
    assert base <= at_start(sound(chain(a, b * factor, c, horizon))).p_fail * slack
    assert base <= at_start(sound(chain(a, b, c * factor, horizon))).p_fail * slack


KEYS = "type of rate k gates events arcs model p observe initial fail models a top thresholds"
STRUCTURES = st.recursive(
    st.none() | st.booleans() | st.integers() | st.text("ab:{}[], ", max_size=5),
    lambda inner: (
        st.lists(inner, max_size=3)
        | st.dictionaries(st.sampled_from(KEYS.split()), inner, max_size=4)
    ),
    max_leaves=12,
)


@given(STRUCTURES, st.sampled_from(TYPES))
def test_any_structure_is_read_or_refused(data: object, kind: str) -> None:

    units = {"m": {"type": "k_out_of_n", "k": 1, "rate": "1 1/h"}}
    entry = {**(data if isinstance(data, dict) else {}), "type": kind}
    for content in (
        {"models": {"m": data}},
        {"models": {"m": entry}},
        {"models": units, "thresholds": data, "top": data},
    ):
        text = json.dumps(content)
        assert read_text(text)[0] is not None or has_errors(everything(text))
