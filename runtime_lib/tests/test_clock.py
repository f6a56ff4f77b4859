"""What is no time makes a step not valid, in each kind that knows time, and never raises."""

from types import SimpleNamespace

import pytest
from eddi_runtime.inputs import NO_TIME

from runtime_lib.tests.bayesian_network import networks
from runtime_lib.tests.event import event_models

NO_TIMES = (1.5, 2e9, float("nan"), "3", True, 2**63, -(10**400), [1], object(), type)
SECOND = 1_000_000_000


@pytest.mark.parametrize("nothing", NO_TIMES)
def test_events_are_unknown_without_time(nothing):
    monitor = event_models.monitor(("gt", "x", 5), ("gt", "x", 5))
    given = SimpleNamespace(x=6.0)
    assert [row["verdict"] for row in monitor.execute_step(given, nothing)] == [None, None]
    assert [row["verdict"] for row in monitor.execute_step(given, SECOND)] == [True, True]
    rows = monitor.execute_step(given, nothing)
    assert [(row["verdict"], row["cleared"]) for row in rows] == [(None, True), (None, True)]
    assert [row["verdict"] for row in monitor.execute_step(given, 2 * SECOND)] == [True, True]


@pytest.mark.parametrize("nothing", NO_TIMES)
def test_nothing_is_held_without_time(nothing):
    bins = {"Gap": {"input": "d", "bins": [2.0], "missing": "hold"}}
    one = networks.monitor(bins=bins, specs={"d": {"max_age": 1.0}})
    near, none = networks.give(d=1.0), networks.give(d=None)
    prior = one.execute_step(none, 0)
    seen = one.execute_step(near, 0)
    assert seen != prior
    assert one.execute_step(none, SECOND // 2) == seen
    assert one.execute_step(none, nothing) == prior
    assert one.execute_step(none, -SECOND) == prior  # the clock went back
    assert one.execute_step(near, nothing) == seen
    for later in (nothing, SECOND // 2, None):
        assert one.execute_step(none, later) == prior


@pytest.mark.parametrize("nothing", NO_TIMES)
def test_a_window_has_no_age_without_time(nothing):
    from runtime_lib.tests.safeml import monitors

    rows = [[float(i)] for i in range(20)]
    one = monitors.monitor(rows, max_age=1.0)
    for i in range(4):
        result = one.execute_step(SimpleNamespace(sample=[float(i)]), 0)
    assert not result.omission
    result = one.execute_step(SimpleNamespace(sample=[5.0]), nothing)
    assert (result.omission, result.reason) == (True, "stale")
    assert one.omission()[1] == NO_TIME
    assert not one.execute_step(SimpleNamespace(sample=[5.0]), SECOND // 2).omission
    ageless = monitors.monitor(rows)
    for i in range(4):
        result = ageless.execute_step(SimpleNamespace(sample=[float(i)]), nothing)
    assert not result.omission


@pytest.mark.parametrize("nothing", NO_TIMES)
def test_a_reliability_is_not_valid_without_time(nothing):
    from runtime_lib.tests.reliability.reliability_models import chain, monitor

    thresholds = [{"id": "go", "activate": 0.9, "release": 0.9, "hold": 0.0}]
    given = SimpleNamespace()
    one = monitor([chain([[0, 1, 0.1]], 2, [1])], thresholds=thresholds)
    first = one.execute_step(given, nothing)
    assert (first.valid, first.reason, first.evidence) == (False, NO_TIME, {"go": False})
    assert one.execute_step(given, 0).evidence == {"go": True}
    before = one.execute_step(given, SECOND // 2)
    assert before.valid
    lost = one.execute_step(given, nothing)
    assert (lost.valid, lost.reason, lost.evidence) == (False, NO_TIME, {"go": False})
    assert lost.p_fail == before.p_fail
    after = one.execute_step(given, SECOND)
    assert after.valid
    steady = monitor([chain([[0, 1, 0.1]], 2, [1])])
    steady.execute_step(given, 0)
    assert after.p_fail == pytest.approx(steady.execute_step(given, SECOND).p_fail, rel=1e-12)
