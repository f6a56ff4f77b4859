"""An input that is lost, or beyond its range, never makes a result better."""

import math

import pytest

from eddi_scaffold.kinds.reliability.fault_tree import Gate
from runtime_lib.tests.reliability.reliability_models import (
    battery,
    but,
    chain,
    event,
    heat,
    monitor,
    processor,
    quad,
    rotors,
    tree,
    units,
)
from runtime_lib.tests.reliability.test_reliability_monitor import (
    WORKING,
    step,
)

BATTERY = battery(1e-2, **heat(0.5, 25.0, 60.0))
CPU = processor(400.0, 1.0, 1.0, **heat(0.3, 51.0, 85.0))
UNITS = units(2, 0.1, 4)
LEVEL, WARMTH, HEAT, LOAD = (
    *("battery_level", "battery_temperature"),
    *("cpu_temperature", "cpu_utilisation"),
)
STATES = chain(
    [[0, 1, 0.5], [1, 2, 0.25], [0, 2, 0.125]], 3, [2],
    observe=[[0, "a", False], [1, "b", False], [2, "c", True]],
)  # fmt: skip
EVENTS = [event("exponential", 0.1, input="a"), event("weibull", 9.0, 2.0, input="b")]


def gates(kind):
    return tree(EVENTS, [Gate(kind, (0, 1))])


NOT_OR = tree(EVENTS, [Gate("OR", (0, 1)), Gate("NOT", (2,))])
TRUTHS = (True, False)
ROTORS = {f"rotors_motor_{i}": TRUTHS for i in range(4)}
TOLD = {"tree_a": TRUTHS, "tree_b": TRUTHS}
KINDS = {
    "battery": (BATTERY, {LEVEL: (90.0, 60.0, 30.0, 10.0), WARMTH: (-150.0, 25.0, 60.0)}),
    "charged battery": (but(BATTERY, repair=True), {LEVEL: (90.0, 10.0), WARMTH: (5.0, 60.0)}),
    "processor": (CPU, {HEAT: (-150.0, 51.0, 85.0), LOAD: (0.0, 0.5, 1.0)}),
    "worn processor": (but(CPU, shape=3.0), {HEAT: (51.0, 85.0), LOAD: (0.0, 0.5, 1.0)}),
    "new processor": (but(CPU, shape=0.5), {HEAT: (51.0, 85.0), LOAD: (0.0, 0.5, 1.0)}),
    "units": (UNITS, {"units_available": (0, 1, 2, 3, 4)}),
    "rotors": (quad(0.01), ROTORS),
    "repaired rotors": (quad(0.01, repair=True), ROTORS),
    "hexacopter": (rotors("PNPNPN", 0.1), {f"rotors_motor_{i}": TRUTHS for i in range(6)}),
    "chain": (STATES, {"a": TRUTHS, "b": TRUTHS, "c": TRUTHS}),
    "OR": (gates("OR"), TOLD),
    "AND": (gates("AND"), TOLD),
    "XOR": (gates("XOR"), TOLD),
    "NOT": (NOT_OR, TOLD),
}
PARTS = [BATTERY, CPU, UNITS, quad(0.01)]
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
    part = but(CPU, u_max=3.0)
    names = [HEAT, LOAD]
    worst = last([part], names, [{HEAT: 85.0, LOAD: 3.0}]).p_fail
    idle = last([part], names, [{HEAT: 85.0, LOAD: 0.25}]).p_fail
    for load, expected in ((3.0, worst), (0.25, idle), (None, worst)):
        lost = last([part], names, [{HEAT: None, LOAD: load}])
        assert lost.p_fail_high == pytest.approx(expected, rel=1e-14)
        assert (lost.p_fail_low, lost.valid) == (0.0, False)
    cool = last([part], names, [{HEAT: 51.0, LOAD: 3.0}]).p_fail
    assert last([part], names, [{HEAT: 51.0, LOAD: None}]).p_fail == pytest.approx(cool, rel=1e-14)


@pytest.mark.parametrize(
    ("part", "good", "name", "limit", "shown"),
    [
        (
            CPU,
            {HEAT: 85.0, LOAD: 1.0},
            HEAT,
            85.0,
            "is above t_max (85 degC); it counts as unknown",
        ),
        (CPU, {HEAT: 85.0, LOAD: 1.0}, LOAD, 1.0, "is above u_max (1); it counts as unknown"),
        (
            BATTERY,
            {WARMTH: 60.0, LEVEL: 80.0},
            WARMTH,
            60.0,
            "is above t_max (60 degC); it counts as",
        ),
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
    one = monitor([BATTERY], [LEVEL, WARMTH], factors={LEVEL: factor}, **MORE)
    result = step(one, **{LEVEL: value, WARMTH: 25.0})
    assert result.valid is (fault is None)
    assert fault is None or fault in one.faults()[LEVEL]


ARCS = [[0, 1, 1e-3], [1, 2, 0.5]]
NAMED = chain(ARCS, 3, [2], observe=[[0, "ok", False], [1, "ok", True], [2, "ok", True]])
GO = {"id": "go", "activate": 0.5, "release": 0.5, "hold": 0.0}


def told(parts, name, values, **more):
    one = monitor(parts, [name], thresholds=[GO], **more)
    return [step(one, 0.1 * i, **{name: value}) for i, value in enumerate(values)]


@pytest.mark.parametrize("rule", ["inactive", "worst_case"])
def test_a_state_that_is_seen_ends_a_gap(rule):
    *_, before = told([NAMED], "ok", [True] * 9, on_unknown=rule)
    *_, gap, after = told([NAMED], "ok", [True] * 3 + [None] * 5 + [True], on_unknown=rule)
    assert (gap.valid, gap.evidence) == (False, {"go": False})
    assert (after.valid, after.evidence) == (True, {"go": True})
    for name in ("p_fail_low", "p_fail_high", "reliability", "mttf"):
        assert getattr(after, name) == pytest.approx(getattr(before, name), rel=1e-13)


def test_a_large_chain_is_bounded_by_every_state_until_it_is_known():
    arcs = [[k, k + 1, 1e-3] for k in range(99)]
    observe = [[k, "new", True] for k in range(1, 100)] + [[99, "works", True]]
    model = chain(arcs, 100, [99], observe=observe)
    one = monitor([model], ["new", "works"])
    assert step(one, new=True, works=True).valid
    assert not step(one, 0.1, works=True).valid
    for t in (0.2, 0.3):
        after = step(one, t, new=False, works=True)
        assert after.valid
        assert after.p_fail_high == pytest.approx(-math.expm1(-1e-3), rel=1e-12)  # of the last one
    known = step(one, 0.4, new=True, works=True)
    assert known.valid
    assert known.p_fail_low == known.p_fail_high < 1e-99


def test_a_level_that_is_ignored_ends_no_gap():
    part = battery(1e-2)
    results = told([part], LEVEL, [60.0, 90.0, None, 90.0, 60.0])
    assert [one.valid for one in results] == [True, True, False, False, True]
    assert [one.p_fail_high for one in results[2:4]] == [1.0, 1.0]
    assert results[3].unknown == (LEVEL,)
    assert results[4].p_fail == results[0].p_fail
    empty = told([part], LEVEL, [10.0, None, 90.0])
    assert [one.valid for one in empty] == [True, False, True]
    assert empty[2].p_fail == 1.0


def test_a_chain_that_may_have_failed_unseen_says_since_when_and_why():
    arcs = [[0, 1, 1e-5], [1, 2, 1e-3]]
    limits = [{"id": "T", "activate": 1e-3, "release": 2e-3, "hold": 0.0}]
    unseen = [[0, "ok", False], [1, "ok", True]]  # no entry excludes state 2, the fail state
    one = monitor([chain(arcs, 3, [2], observe=unseen)], ["ok"], thresholds=limits)
    for at, ok in ((0.0, True), (0.5, None), (1.0, True)):
        found = step(one, at, ok=ok)
    why = (
        "chain: ok was missing 0.5 s after the start, and no input shows that it has not failed "
        "since"
    )
    assert (found.valid, found.p_fail, found.reason) == (True, 1.0, why)
    assert one.why()["T"].sentence.startswith("T: ")
    assert dict(one.message(found)[1])["reason"] == why
    for at, ok in ((1.5, False), (2.0, None), (2.5, False)):
        assert step(one, at, ok=ok).p_fail == 1.0
    one.reset()
    assert step(one, ok=True).reason == ""

    whole = [*unseen, [2, "ok", True]]
    one = monitor([chain(arcs, 3, [2], observe=whole)], ["ok"], thresholds=limits)
    for at, ok in ((0.0, True), (0.5, None), (1.0, True)):
        found = step(one, at, ok=ok)
    assert (found.reason, found.evidence) == ("", {"T": True})


STUCK = [[0, "a", False], [1, "a", True]]


def observed(values, **more):
    model = chain([[0, 1, 1e-5]], 2, [1], observe=STUCK, **more)
    thresholds = [{"id": "go", "activate": 0.5, "release": 0.5, "hold": 0.0}]
    one = monitor([model], ["a"], thresholds=thresholds)
    return one, [step(one, i * 0.1, a=value) for i, value in enumerate(values)]


def test_a_chain_that_was_seen_to_fail_stays_failed():
    one, seen = observed([True, False, True, True, None, False])
    assert [result.p_fail for result in seen[1:]] == [1.0] * 5
    assert [result.p_fail_low for result in seen[1:]] == [1.0] * 5
    assert [result.reason for result in seen] == ["", "", "inconsistent", "inconsistent", "", ""]
    assert [result.evidence["go"] for result in seen] == [True] + [False] * 5
    assert (seen[1].valid, seen[2].valid, seen[4].valid) == (True, False, True)
    assert (seen[3].reliability, seen[3].mttf) == (0.0, 0.0)
    step(one, 0.6, a=True)
    assert "works again; ignored without `repair: true`" in one.faults()["a"]
    one.reset()
    assert step(one, a=True).valid


def test_a_contradiction_that_no_failure_explains_passes():
    """Ok and not ok at once is no observation of a failure."""
    model = chain([[0, 1, 1e-5]], 2, [1], observe=[[0, "a", False], [1, "b", True]])
    one = monitor([model], ["a", "b"])
    assert step(one, a=True, b=True).p_fail < 1e-4
    nothing = step(one, 0.1, a=False, b=True)
    assert (nothing.p_fail, nothing.reason) == (1.0, "inconsistent")
    assert step(one, 0.2, a=True, b=True).reason == "inconsistent"
    assert step(one, 0.3, a=True, b=True).valid


def test_many_unknown_inputs_are_bounded_at_once():
    observe = [[k, f"i{k}", False] for k in range(11)] + [[11, "ok", True]]
    model = chain([[k, k + 1, 1e-5] for k in range(11)], 12, [11], observe=observe)
    one = monitor([model], [*(f"i{k}" for k in range(11)), "ok"])
    assert step(one, ok=True).p_fail_high == 1.0


def drone():
    events = [
        event("model", model="rotors"),
        event("model", model="cpu"),
        event("exponential", 1e-3, name="link", input="lost"),
    ]
    go = [{**GO, "activate": 0.1, "release": 0.2}]
    parts = [quad(0.001), CPU, tree(events, [Gate("OR", (0, 1, 2))])]
    return monitor(parts, [*WORKING, HEAT, LOAD, "tree_lost"], thresholds=go)
