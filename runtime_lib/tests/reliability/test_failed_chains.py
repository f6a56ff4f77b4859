"""A chain that was seen to have failed, and contradictions that are none of a failure."""

from runtime_lib.tests.reliability.reliability_models import chain, monitor
from runtime_lib.tests.reliability.test_reliability_monitor import step

STUCK = [[0, "a", False], [1, "a", True]]


def told(values, **more):
    model = chain([[0, 1, 1e-5]], 2, [1], observe=STUCK, **more)
    thresholds = [{"id": "go", "activate": 0.5, "release": 0.5, "hold": 0.0}]
    one = monitor([model], ["a"], thresholds=thresholds)
    return one, [step(one, i * 0.1, a=value) for i, value in enumerate(values)]


def test_a_chain_that_was_seen_to_fail_stays_failed():
    one, seen = told([True, False, True, True, None, False])
    assert [result.p_fail for result in seen[1:]] == [1.0] * 5
    assert [result.p_fail_low for result in seen[1:]] == [1.0] * 5
    assert [result.reason for result in seen] == ["", "", "inconsistent", "inconsistent", "", ""]
    assert [result.evidence["go"] for result in seen] == [True] + [False] * 5
    assert (seen[1].valid, seen[2].valid, seen[4].valid) == (True, False, True)
    assert (seen[3].reliability, seen[3].mttf) == (0.0, 0.0)
    assert one.latched() == {"chain": 2}
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
