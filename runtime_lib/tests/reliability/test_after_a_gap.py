"""How soon, and how tightly, a result that missed observations is bounded again."""

import math

import pytest

from runtime_lib.tests.reliability.reliability_models import (
    chain,
    monitor,
)
from runtime_lib.tests.reliability.test_reliability_monitor import step
from runtime_lib.tests.reliability.test_unknown_inputs import BATTERY

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
    part = {**BATTERY, "temperature": None}
    results = told([part], "level", [60.0, 90.0, None, 90.0, 60.0])
    assert [one.valid for one in results] == [True, True, False, False, True]
    assert [one.p_fail_high for one in results[2:4]] == [1.0, 1.0]
    assert results[3].unknown == ("level",)
    assert results[4].p_fail == results[0].p_fail
    empty = told([part], "level", [10.0, None, 90.0])
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
    assert one.explain().text().startswith(f"p_fail 1 (5e-09 to 1) within 1 h, valid: {why}\n")
    assert one.standings()[0].reason == f"p_fail is 1, the threshold is 0.001; {why}"
    assert one.doubts() == (why,)
    assert dict(one.message(found)[1])["reason"] == why
    for at, ok in ((1.5, False), (2.0, None), (2.5, False)):
        assert step(one, at, ok=ok).p_fail == 1.0
    one.reset()
    assert (step(one, ok=True).reason, one.doubts()) == ("", ())

    whole = [*unseen, [2, "ok", True]]
    one = monitor([chain(arcs, 3, [2], observe=whole)], ["ok"], thresholds=limits)
    for at, ok in ((0.0, True), (0.5, None), (1.0, True)):
        found = step(one, at, ok=ok)
    assert (found.reason, found.evidence, one.doubts()) == ("", {"T": True}, ())
