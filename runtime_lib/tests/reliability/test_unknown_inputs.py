"""An input that is lost, or beyond its range, never makes a result better."""

import itertools
import math
import random

import pytest

np = pytest.importorskip("numpy", reason="reliability needs numpy")

from runtime_lib.tests.reliability.reliability_models import (  # noqa: E402 - numpy comes first
    chain,
    event,
    monitor,
    quad,
    tree,
)
from runtime_lib.tests.reliability.test_reliability_monitor import step  # noqa: E402 - as above

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
KINDS_OF_TOPS = {
    "series": {"name": "all", "type": "series", "of": NAMES},
    "2 of 4": tree(MODELS, [{"type": "VOTE", "of": [0, 1, 2, 3], "k": 2}]),
    "odd": tree(MODELS, [{"type": "XOR", "of": [0, 1, 2, 3]}]),
}
LEVELS = [10.0 ** (-k / 8.0) for k in range(64)]
THRESHOLDS = [
    {"id": f"p{k}", "activate": p, "release": p, "hold": 0.0} for k, p in enumerate(LEVELS)
]
MORE = {"on_unknown": "worst_case", "horizon": 1.0, "thresholds": THRESHOLDS}


@pytest.mark.slow
@pytest.mark.parametrize("kind", KINDS)
def test_evidence_with_an_unknown_input_holds_for_every_value_that_it_may_have(kind):
    part, ranges = KINDS[kind]
    chance = random.Random(kind)
    names = list(ranges)
    for _ in range(60):
        history = [
            {name: chance.choice((*values, None)) for name, values in ranges.items()}
            for _ in range(chance.randrange(3))
        ]
        given = {name: chance.choice((*values, None)) for name, values in ranges.items()}
        bounded = last([part], names, [*history, given])
        lost = [name for name in names if given[name] is None]
        for guess in itertools.product(*(ranges[name] for name in lost)):
            whole = {**given, **dict(zip(lost, guess))}
            exact = last([part], names, [*history, whole])
            slack = 1.0 + 1e-12
            assert exact.p_fail_high <= bounded.p_fail_high * slack, (history, given, whole)
            assert bounded.p_fail_low <= exact.p_fail_low * slack, (history, given, whole)
            if exact.reason:  # the model says that this cannot be
                continue
            for one, active in bounded.evidence.items():
                assert exact.evidence[one] or not active


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


@pytest.mark.parametrize("top", KINDS_OF_TOPS)
def test_what_is_made_of_unknown_parts_is_bounded_too(top):
    parts = [*PARTS, KINDS_OF_TOPS[top]]
    ranges = {"level": (90.0, 40.0), "t": (-150.0, 60.0), "u": (0.0, 1.0), "n": (1, 4), **ROTORS}
    chance = random.Random(top)
    for _ in range(12):
        given = {name: chance.choice(values) for name, values in ranges.items()}
        lost = chance.sample(sorted(given), 3)
        bounded = last(parts, list(ranges), [{**given, **dict.fromkeys(lost)}])
        for guess in itertools.product(*(ranges[name] for name in lost)):
            exact = last(parts, list(ranges), [{**given, **dict(zip(lost, guess))}])
            assert exact.p_fail_high <= bounded.p_fail_high * (1 + 1e-12)
            assert bounded.p_fail_low <= exact.p_fail_low * (1 + 1e-12)
            assert all(exact.evidence[one] or not on for one, on in bounded.evidence.items())


@pytest.mark.parametrize("shape", [0.5, 1.0, 3.0])
def test_what_was_unknown_for_a_while_counts_as_the_worst_later(shape):
    part, names = {**CPU, "shape": shape, "mttf_ref": 0.01}, ["t", "u"]
    now = [{"t": 60.0, "u": 0.5}]
    for lost in (["t"], ["u"], ["t", "u"]):
        gone = {**now[0], **dict.fromkeys(lost)}
        later = last([part], names, [gone] * 9 + now)
        assert later.valid
        for t, u in itertools.product((-199.0, 85.0), (0.0, 1.0)):
            then = {**now[0], **{name: {"t": t, "u": u}[name] for name in lost}}
            assert last([part], names, [then] * 9 + now).p_fail <= later.p_fail * (1 + 1e-12)


def test_a_young_processor_is_the_worse_the_less_it_has_aged():
    part = {**CPU, "shape": 0.5}
    lost = last([part], ["t", "u"], [{"t": None, "u": 1.0}] * 50 + [{"t": 60.0, "u": 1.0}])
    cold = last([part], ["t", "u"], [{"t": -199.0, "u": 1.0}] * 50 + [{"t": 60.0, "u": 1.0}])
    assert cold.p_fail <= lost.p_fail * (1 + 1e-12)


def test_nothing_is_minus_zero():
    parts = [{**CPU, "name": f"c{i}"} for i in range(2)]
    parts.append({"name": "all", "type": "series", "of": ["c0", "c1"]})
    for values in ({"t": None, "u": 0.5}, {"t": 51.0, "u": 0.0}, {}):
        result = last(parts, ["t", "u"], [values])
        for number in (result.p_fail_low, result.p_fail, *result.contributions.values()):
            assert math.copysign(1.0, number) == 1.0
    for part, ranges in KINDS.values():
        parts = [part, {"name": "all", "type": "series", "of": [part["name"]]}]
        one = monitor(parts, ranges, horizon=0.0)
        result = step(one, **{name: values[0] for name, values in ranges.items()})
        assert math.copysign(1.0, result.p_fail_low) == 1.0
        assert math.copysign(1.0, result.p_fail_high) == 1.0


@pytest.mark.parametrize(
    ("given", "told"),
    [(0.8, None), (80.0, "a number from 0 to 1 is expected, not 80.0"), (1e308, "not 1e+308")],
)
def test_a_value_that_is_given_in_another_unit_is_told_in_that(given, told):
    one = monitor([BATTERY], ["level", "t"], factors={"level": [100, 1]}, **MORE)
    seen = step(one, level=given, t=25.0)
    assert seen.valid is (told is None)
    assert told is None or told in one.faults()["level"]
