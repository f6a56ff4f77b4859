"""The start of a mission, as the reports and the warnings take it: everything is in order."""

from types import SimpleNamespace

import pytest

from eddi_scaffold.kinds import Options
from eddi_scaffold.kinds.reliability.trial import at_start
from eddi_scaffold.kinds.reliability.write import to_yaml
from tests.kinds.reliability.monitors import compiled, read_text, sound

CPU = "c: {type: processor, mttf_ref: 400 h, t_ref: 51 degC, t_max: %s degC, u_max: %s}"
BATTERY = (
    "b: {type: battery, failure_rate: 1e-3 1/h, alpha: 1e-3 1/h, beta: 1e-3 1/h, degradation: "
    "1e-3 1/h, t_ref: 25 degC, t_max: %s degC, activation_energy: 0.5}"
)


@pytest.mark.parametrize("part", [CPU % (85, 0.5), CPU % (40, 2), BATTERY % 20, BATTERY % 60])
def test_what_is_in_order_is_within_its_range(part: str) -> None:
    model, problems = read_text(f"horizon: 1 h\nmodels: {{{part}}}\n")
    assert model is not None, problems
    start = at_start(model.data)
    assert start.valid
    assert 0.0 < start.p_fail < at_start(model.data, known=False).p_fail


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
