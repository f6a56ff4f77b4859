"""An input that is lost, or beyond its range, never makes a result better."""

import math

import pytest

from runtime_lib.tests.reliability.reliability_models import (
    chain,
    event,
    monitor,
    quad,
    tree,
)
from runtime_lib.tests.reliability.test_reliability_monitor import step

BATTERY = {
    "name": "battery", "type": "battery", "failure_rate": 1e-2, "alpha": 8e-3, "beta": 7e-3,
    "degradation": 6.4e-3, "level": "level", "repair": False, "t_ref": 25.0, "t_max": 60.0,
    "activation_energy": 0.5, "temperature": "t",
}  # fmt: skip
CPU = {
    "name": "cpu", "type": "processor", "mttf_ref": 400.0, "t_ref": 51.0, "t_max": 85.0,
    "u_max": 1.0, "activation_energy": 0.3, "shape": 1.0, "temperature": "t", "utilisation": "u",
}  # fmt: skip
UNITS = {"name": "units", "type": "k_out_of_n", "k": 2, "rate": 0.1, "max": 4, "available": "n"}
STATES = chain(
    [[0, 1, 0.5], [1, 2, 0.25], [0, 2, 0.125]], 3, [2],
    observe=[[0, "a", False], [1, "b", False], [2, "c", True]],
)  # fmt: skip
EVENTS = [event("exponential", 0.1, input="a"), event("weibull", 9.0, 2.0, input="b")]


def gates(kind):
    return tree(EVENTS, [{"type": kind, "of": [0, 1]}])


NOT_OR = tree(EVENTS, [{"type": "OR", "of": [0, 1]}, {"type": "NOT", "of": [2]}])
TRUTHS = (True, False)
ROTORS = dict.fromkeys(("m0", "m1", "m2", "m3"), TRUTHS)
HEXA = {**quad(0.1), "configuration": "PNPNPN", "rates": [0.1] * 6}
HEXA["inputs"] = [[f"m{i}", None] for i in range(6)]
KINDS = {
    "battery": (BATTERY, {"level": (90.0, 60.0, 30.0, 10.0), "t": (-150.0, 25.0, 60.0)}),
    "charged battery": ({**BATTERY, "repair": True}, {"level": (90.0, 10.0), "t": (5.0, 60.0)}),
    "processor": (CPU, {"t": (-150.0, 51.0, 85.0), "u": (0.0, 0.5, 1.0)}),
    "worn processor": ({**CPU, "shape": 3.0}, {"t": (51.0, 85.0), "u": (0.0, 0.5, 1.0)}),
    "new processor": ({**CPU, "shape": 0.5}, {"t": (51.0, 85.0), "u": (0.0, 0.5, 1.0)}),
    "units": (UNITS, {"n": (0, 1, 2, 3, 4)}),
    "rotors": (quad(0.01), ROTORS),
    "repaired rotors": (quad(0.01, repair=True), ROTORS),
    "hexacopter": (HEXA, {f"m{i}": TRUTHS for i in range(6)}),
    "chain": (STATES, {"a": TRUTHS, "b": TRUTHS, "c": TRUTHS}),
    "OR": (gates("OR"), {"a": TRUTHS, "b": TRUTHS}),
    "AND": (gates("AND"), {"a": TRUTHS, "b": TRUTHS}),
    "XOR": (gates("XOR"), {"a": TRUTHS, "b": TRUTHS}),
    "NOT": (NOT_OR, {"a": TRUTHS, "b": TRUTHS}),
}
PARTS = [BATTERY, CPU, UNITS, quad(0.01)]
NAMES = [part["name"] for part in PARTS]
MODELS = [event("model", model=name) for name in NAMES]
LEVELS = [10.0 ** (-k / 8.0) for k in range(64)]
THRESHOLDS = [
    {"id": f"p{k}", "activate": p, "release": p, "hold": 0.0} for k, p in enumerate(LEVELS)
]
MORE = {"on_unknown": "worst_case", "horizon": 1.0, "thresholds": THRESHOLDS}


def last(parts, names, steps):
    one = monitor(parts, names, **MORE)
    for i, values in enumerate(steps):
        result = step(one, 0.1 * i, **values)
    return result


def test_a_known_load_counts_while_the_temperature_is_unknown():
    part = {**CPU, "u_max": 3.0}
    names = ["t", "u"]
    worst = last([part], names, [{"t": 85.0, "u": 3.0}]).p_fail
    idle = last([part], names, [{"t": 85.0, "u": 0.25}]).p_fail
    for load, expected in ((3.0, worst), (0.25, idle), (None, worst)):
        lost = last([part], names, [{"t": None, "u": load}])
        assert lost.p_fail_high == pytest.approx(expected, rel=1e-14)
        assert (lost.p_fail_low, lost.valid) == (0.0, False)
    cool = last([part], names, [{"t": 51.0, "u": 3.0}]).p_fail
    assert last([part], names, [{"t": 51.0, "u": None}]).p_fail == pytest.approx(cool, rel=1e-14)


@pytest.mark.parametrize(
    ("part", "good", "name", "limit", "shown"),
    [
        (CPU, {"t": 85.0, "u": 1.0}, "t", 85.0, "is above t_max (85 degC); it counts as unknown"),
        (CPU, {"t": 85.0, "u": 1.0}, "u", 1.0, "is above u_max (1); it counts as unknown"),
        (BATTERY, {"t": 60.0, "level": 80.0}, "t", 60.0, "is above t_max (60 degC); it counts as"),
    ],
)
def test_what_is_above_its_limit_is_unknown_and_as_bad_as_it_says(part, good, name, limit, shown):
    p = last([part], list(good), [good]).p_fail
    for value in (limit * 1.01, limit * 80.0, 5000.0, 1e30, 1e308, 10**300):
        one = monitor([part], good, **MORE)
        above = step(one, **{**good, name: value})
        assert (above.valid, above.unknown) == (False, (name,))
        assert p < above.p_fail_high <= 1.0
        assert above.p_fail_low == 0.0
        assert shown in one.faults()[name]
        lost = step(one, 0.1, **{**good, name: None})
        assert lost.p_fail_high >= above.p_fail_high  # losing the sensor does not help
        assert one.faults() == {}
        back = step(one, 0.2, **good)
        assert back.valid
        after = step(one, 0.3, **{**good, name: None})
        assert after.p_fail_high == pytest.approx(back.p_fail, rel=1e-3)  # a spike is no fate
        p = above.p_fail_high * (1 - 1e-12)
    for value in (math.inf, 10**400, "hot"):
        one = monitor([part], good, **MORE)
        assert step(one, **{**good, name: value}).unknown == (name,)
        assert name in one.faults()
    one.reset()
    assert step(one, **good).p_fail == last([part], list(good), [good]).p_fail


@pytest.mark.parametrize(
    ("factor", "value", "fault"),
    [
        ([100, 1], 0.8, None),
        ([1, 10], 800.0, None),  # beyond the range of the model, in the unit of the robot
        ([100, 1], 80.0, "a number from 0 to 1 is expected, not 80.0"),
        ([100, 1], 1e308, "not 1e+308"),
    ],
)
def test_a_value_that_is_given_in_another_unit_is_judged_in_that(factor, value, fault):
    one = monitor([BATTERY], ["level", "t"], factors={"level": factor}, **MORE)
    result = step(one, level=value, t=25.0)
    assert result.valid is (fault is None)
    assert fault is None or fault in one.faults()["level"]
