"""The monitor: time, observations, latches, intervals, evidence, and damaged models."""

import json
import math
from types import SimpleNamespace

import pytest

from eddi_scaffold.kinds.reliability.fault_tree import Gate
from runtime_lib.tests.reliability.reliability_models import (
    NS,
    battery,
    but,
    chain,
    event,
    heat,
    monitor,
    processor,
    quad,
    series,
    tree,
    units,
)

WORKING = {f"rotors_motor_{i}": True for i in range(4)}
BATTERY = battery(1e-3)
PROCESSOR = processor(400.0, 2.0, 2.0, **heat(0.3, 51.0, 90.0))
UNITS = units(2, 1e-3, 4)


def step(one, at=0.0, **values):
    return one.execute_step(SimpleNamespace(**values), round(at * NS))


def rotors(**model):
    return monitor([quad(0.01)], WORKING, **model)


def test_what_failed_does_not_work_again():
    one = rotors()
    step(one, **{**WORKING, "rotors_motor_2": False})
    assert step(one, 0.1, **WORKING).p_fail == 1.0
    assert "ignored without" in one.faults()["rotors_motor_2"]
    one.reset()
    assert step(one, **WORKING).p_fail < 1.0
    repaired = monitor([quad(0.01, repair=True)], WORKING)
    step(repaired, **{**WORKING, "rotors_motor_2": False})
    assert step(repaired, 0.1, **WORKING).p_fail < 0.05


@pytest.mark.parametrize("nothing", [None, math.nan, object(), [], "yes", 3, b"1", {}, 1.5])
def test_what_is_no_status_is_unknown(nothing):
    one = rotors()
    absent = step(
        one, **dict.fromkeys(("rotors_motor_0", "rotors_motor_1", "rotors_motor_2"), True)
    )
    assert one.message(step(one, **{**WORKING, "rotors_motor_3": nothing})) == one.message(absent)


def test_time_goes_in_whole_quanta_rounded_up():
    """36,000 steps of 0.1 s equal the one-shot value at 1 h."""
    rate = 0.37
    one = monitor([chain([[0, 1, rate], [1, 2, 2 * rate]], 3, [2])], horizon=0.0)
    for i in range(36_001):
        last = step(one, i * 0.1)
    expected = 1.0 - 2.0 * math.exp(-rate) + math.exp(-2.0 * rate)
    assert last.p_fail == pytest.approx(expected, rel=1e-10)
    other = monitor([chain([[0, 1, rate], [1, 2, 2 * rate]], 3, [2])], horizon=0.0, max_gap=1e9)
    step(other)
    assert step(other, 3600.0).p_fail == pytest.approx(expected, rel=1e-12)
    late = monitor([chain([[0, 1, rate], [1, 2, 2 * rate]], 3, [2])], horizon=0.0)
    step(late)
    assert step(late, 0.01).p_fail == pytest.approx(
        (1.0 - math.exp(-rate * 0.1 / 3600)) ** 2, rel=1e-6
    )


def test_gaps_and_clocks_that_go_back_are_said():
    one = monitor([chain([[0, 1, 1.0]], 2, [1])])
    assert step(one, 100.0).valid
    gap = step(one, 110.0)
    assert (gap.valid, gap.reason) == (False, "gap")
    back = step(one, 50.0)
    assert (back.valid, back.reason) == (False, "the clock went back")
    assert back.p_fail == gap.p_fail
    assert step(one, 50.1).valid
    assert step(one, 50.1).p_fail >= back.p_fail


def test_the_worst_case_may_count_while_inputs_are_unknown():
    thresholds = [{"id": "go", "activate": 0.999, "release": 0.999, "hold": 0.0}]
    events = [event("exponential", 0.1, input="a"), event("fixed", 0.01)]
    model = [tree(events, [Gate("AND", (0, 1))])]
    for rule, expected in (("inactive", False), ("worst_case", True)):
        one = monitor(model, ["tree_a"], thresholds=thresholds, on_unknown=rule)
        result = step(one)
        assert result.evidence == {"go": expected}
        assert result.p_fail_high == pytest.approx(0.01)


def test_the_end_of_the_mission_is_an_input():
    model = [chain([[0, 1, 0.5]], 2, [1])]
    one = monitor(model, ["mission_end"], mission_end=True, horizon=2.0)
    assert step(one, mission_end=3600.0).p_fail == pytest.approx(-math.expm1(-0.5), rel=1e-12)
    past = step(one, mission_end=-5.0)
    assert (past.p_fail, past.horizon, past.valid) == (0.0, 0.0, True)
    longest = step(one)
    assert (longest.valid, longest.horizon) == (False, 2.0)
    assert longest.p_fail == pytest.approx(-math.expm1(-1.0), rel=1e-12)
    assert longest.p_fail_low == 0.0
    assert step(one, mission_end=7200.0).p_fail == longest.p_fail


@pytest.mark.parametrize("rule", ["inactive", "worst_case"])
def test_a_mission_that_is_longer_than_the_longest_is_unknown(rule):
    thresholds = [{"id": "go", "activate": 1.0, "release": 1.0, "hold": 0.0}]
    more = {"mission_end": True, "horizon": 2.0, "on_unknown": rule, "thresholds": thresholds}
    one = monitor([chain([[0, 1, 0.5]], 2, [1])], ["mission_end"], **more)
    assert step(one, mission_end=7200.0).evidence == {"go": True}
    for left in (7201.0, 1e9, 1e11):
        beyond = step(one, mission_end=left)
        assert (beyond.valid, beyond.horizon, beyond.unknown) == (False, 2.0, ("mission_end",))
        assert beyond.reason == "mission_end is above mission_time"
        assert beyond.evidence == {"go": False}
        assert beyond.p_fail == pytest.approx(-math.expm1(-1.0), rel=1e-12)
        assert "is above mission_time (7200 s)" in one.faults()["mission_end"]


def test_the_longest_mission_is_not_the_worst_of_a_tree_with_not():
    events = [event("exponential", 0.5)]
    one = monitor(
        [tree(events, [Gate("NOT", (0,))])],
        ["mission_end"],
        mission_end=True,
        horizon=2.0,
    )
    assert step(one, mission_end=0.0).p_fail == 1.0
    assert (step(one).p_fail_low, step(one).p_fail_high, step(one).reliability) == (0.0, 1.0, 0.0)


def test_battery_processor_units_and_series():
    good = {"battery_level": 80, "cpu_temperature": 60.0, "cpu_utilisation": 1.0}
    good["units_available"] = 4
    one = monitor([BATTERY, PROCESSOR, UNITS, series("battery", "cpu", "units")], good)
    result = step(one, **good)
    parts = [result.contributions[name] for name in ("battery", "cpu", "units")]
    assert result.p_fail == pytest.approx(1 - math.prod(1 - p for p in parts), rel=1e-12)
    assert result.reliability == pytest.approx(1 - result.p_fail, rel=1e-12)
    assert step(one, 0.1, **{**good, "battery_level": 20}).p_fail == 1.0
    assert step(one, 0.2, **good).p_fail == 1.0
    assert "ignored without" in one.faults()["battery_level"]
    assert step(one, 0.3, **{**good, "units_available": 1}).contributions["units"] == 1.0
    for name, bad in (
        ("battery_level", 101),
        ("units_available", 2.5),
        ("units_available", 5),
        ("cpu_temperature", math.inf),
        ("cpu_utilisation", -1),
    ):
        assert name in step(one, 0.4, **{**good, name: bad}).unknown
        assert name in one.faults()
    assert step(one, 0.5, **{**good, "battery_level": 100.3}).unknown == ()
    before = step(one, 0.6, **good).contributions["cpu"]
    assert step(one, 0.7, **{**good, "cpu_temperature": None}).contributions["cpu"] > before
    idle = step(one, 0.8, **{**good, "cpu_utilisation": 0.0})
    assert idle.contributions["cpu"] == 0.0


def everything():
    """Return every type of component, and inputs that say that all is in order."""
    worn = chain([[0, 1, 0.1], [1, 2, 0.2]], 3, [2], observe=[[0, "new", False]])
    names = ("battery", "cpu", "units", "rotors", "chain")
    events = [event("model", model=name) for name in names]
    events += [event("exponential", 0.01), event("weibull", 50.0, 2.0, input="w")]
    events += [event("PAND", 0.1, 0.2)]
    top = tree(events, [Gate("OR", tuple(range(len(events))))])
    values = {**WORKING, "battery_level": 80.0, "cpu_temperature": 60.0, "units_available": 4}
    values |= {"cpu_utilisation": 1.0, "new": True, "tree_w": False}
    parts = [BATTERY, PROCESSOR, but(UNITS, max=None), quad(0.01), worn, top]
    return parts, values


def test_the_end_of_a_mission_is_as_good_as_a_horizon():
    parts, values = everything()
    for horizon in (0.0, 1.0, 3.0, 4.0):
        ends = {**values, "mission_end": horizon * 3600.0}
        one = monitor(parts, ends, mission_end=True, horizon=4.0)
        other = monitor(parts, values, horizon=horizon)
        for i in range(40):
            unknown = {} if i % 20 < 17 else {"rotors_motor_1": None, "new": None}
            mine = step(one, i * 0.1, **{**ends, **unknown})
            expected = step(other, i * 0.1, **{**values, **unknown})
            assert mine.horizon == horizon
            assert (mine.unknown, mine.reason) == (expected.unknown, expected.reason)
            for name in ("p_fail_low", "p_fail_high", "reliability"):
                assert getattr(mine, name) == pytest.approx(getattr(expected, name), rel=1e-12)
            assert mine.contributions == pytest.approx(expected.contributions, rel=1e-12)


def test_statuses_may_come_as_a_list():
    model = but(quad(0.01), status="list")
    one = monitor([model], ["rotors_status"])
    assert step(one, rotors_status=[True] * 4).valid
    assert step(one, rotors_status=[True] * 3).unknown == ("rotors_status",)
    assert "4 statuses are expected, not 3" in one.faults()["rotors_status"]
    assert step(one, rotors_status=[True, False, True, True]).p_fail == 1.0


def test_messages_and_json():
    thresholds = [{"id": "go", "activate": 0.1, "release": 0.2, "hold": 0.0}]
    one = rotors(thresholds=thresholds)
    result = step(one, **WORKING)
    name, fields = one.message(result)
    assert name == "ReliabilityOutput"
    assert fields["evidence"] == [("ReliabilityEvidence", {"id": "go", "active": True})]
    assert fields["horizon_seconds"] == 3600.0
    assert one.message("nonsense")[1]["p_fail"] == 1.0
    shown = one.as_json(result._replace(mttf=math.inf))
    assert list(shown) == list(result._fields)
    assert (shown["mttf"], shown["p_fail"], shown["evidence"]) == (
        None,
        result.p_fail,
        {"go": True},
    )
    assert json.loads(json.dumps(shown)) == shown
    assert one.series(result)["go"] is True
    assert one.status_message() is None


def test_a_threshold_says_what_it_lacks():
    one = rotors(thresholds=[{"id": "go", "activate": 0.1, "release": 0.2, "hold": 0.2}])

    def told():
        return one.why()["go"].sentence

    step(one, 0.0, **WORKING)
    assert told() == "go: good for 0.0 s of 0.2 s"
    step(one, 0.2, **WORKING)
    assert told() == ""
    step(one, 0.4, **{**WORKING, "rotors_motor_1": None})
    assert told() == "go <- rotors_motor_1: no value (p_fail 0.0392 .. 1, limit 0.1)"
    step(one, 0.6, **{**WORKING, "rotors_motor_1": "x"})
    assert told().startswith("go <- rotors_motor_1: ")
    step(one, 0.8, **{**WORKING, "rotors_motor_1": False})
    assert told() == "go: p_fail 1 for 0.0 s, limit 0.1"
