"""The battery: charge, temperature, and horizons that are known only in the step."""

import math

import numpy as np
import pytest
from eddi_runtime.reliability.battery import FreeHorizon

from eddi_scaffold.kinds.reliability.chains import Chain, propagator, rates_of
from runtime_lib.tests.reliability.reliability_models import monitor
from runtime_lib.tests.reliability.test_reliability_monitor import step

COLD = {
    "name": "battery", "type": "battery", "failure_rate": 1e-3, "alpha": 8e-3, "beta": 7e-3,
    "degradation": 6.4e-3, "level": "level", "repair": False,
}  # fmt: skip
WARM = {**COLD, "t_ref": 25.0, "t_max": 60.0, "activation_energy": 0.5, "temperature": "t"}


def factor(celsius):
    return math.exp(0.5 / 8.617333262e-5 * (1 / 298.15 - 1 / (celsius + 273.15)))


def p_fail(part, horizon=1.0, **values):
    inputs = ["level", "t"] if "temperature" in part else ["level"]
    return step(monitor([part], inputs, horizon=horizon), **values)


@pytest.mark.parametrize("level", [90, 60, 30])
@pytest.mark.parametrize("celsius", [-20.0, 25.0, 45.0, 60.0, 75.0])
def test_heat_makes_time_pass_faster(level, celsius):
    for horizon in (0.01, 1.0, 100.0):
        warm = p_fail({**WARM, "t_max": 80.0}, horizon, level=level, t=celsius)
        cold = p_fail(COLD, horizon * factor(celsius), level=level)
        assert warm.valid
        assert warm.p_fail == pytest.approx(cold.p_fail, rel=1e-12, abs=0.0)
        assert warm.mttf == pytest.approx(cold.mttf / factor(celsius), rel=1e-12)
        assert warm.horizon == horizon


def test_an_unknown_temperature_counts_as_the_hottest():
    hottest = p_fail(WARM, level=80, t=60.0)
    for value in (None, math.nan, math.inf, "hot"):
        result = p_fail(WARM, level=80, t=value)
        assert not result.valid
        assert result.unknown == ("t",)
        assert (result.p_fail_low, result.p_fail_high) == (0.0, hottest.p_fail)
    assert p_fail(WARM, level=20, t=None).p_fail_low == 1.0
    both = p_fail(WARM, level=None, t=None)
    assert both.unknown == ("level", "t")
    assert (both.p_fail_low, both.p_fail_high) == (0.0, 1.0)
    only_level = p_fail(WARM, level=None, t=60.0)
    assert 0.0 < only_level.p_fail_low < hottest.p_fail  # a recovering battery


def test_no_temperature_stops_a_step():
    hot = {**WARM, "t_ref": -200.0, "t_max": -200.0, "activation_energy": 10.0}
    result = p_fail(hot, level=80, t=999.0)
    assert result.p_fail == 1.0
    assert p_fail(hot, level=80, t=-200.0).p_fail < 0.01


def test_any_horizon_agrees_with_the_propagator():
    random = np.random.default_rng(7)
    for _ in range(10):
        arcs = [
            (int(a), int(b), float(10.0 ** random.uniform(-6, 1)))
            for a, b in random.integers(0, 8, (24, 2))
            if a != b and a < 6
        ]
        ahead = FreeHorizon(arcs, 20.0)
        rates = rates_of(Chain(("",) * 8, 0, (6, 7), tuple(arcs)))
        for hours in (0.0, 1e-12, 1e-3, 1.0, 19.0, 500.0):
            expected = np.array(propagator(rates, hours))
            found = np.array([ahead.of(state, hours) for state in range(8)])
            failed, alive = expected[:, 6:].sum(axis=1), expected[:, :6].sum(axis=1)
            assert found[:, 0] == pytest.approx(failed, rel=1e-11, abs=0.0)
            assert found[:, 1] == pytest.approx(alive, rel=1e-11, abs=1e-300)
