"""What stands behind a result, for programs and for people."""

from runtime_lib.tests.reliability.reliability_models import (
    event,
    monitor,
    quad,
    tree,
)
from runtime_lib.tests.reliability.test_reliability_monitor import (
    WORKING,
    step,
)
from runtime_lib.tests.reliability.test_unknown_inputs import CPU

GO = [{"id": "go", "activate": 0.1, "release": 0.2, "hold": 0.0}]


def drone():
    events = [
        event("model", model="rotors"),
        event("model", model="cpu"),
        {**event("exponential", 1e-3, input="lost"), "name": "link"},
    ]
    parts = [quad(0.001), CPU, tree(events, [{"type": "OR", "of": [0, 1, 2]}])]
    return monitor(parts, [*WORKING, "t", "u", "lost"], thresholds=GO)


def test_what_is_lost_ignored_or_beyond_its_range_is_said():
    one = drone()
    step(one, **{**WORKING, "t": 50.0, "u": 0.5, "lost": True})
    step(one, 0.1, **{**WORKING, "t": 120.0, "lost": False})
    found = one.explain()
    assert set(found.known) == {*WORKING, "lost"}
    assert found.ignored == {"tree": 1}
    lines = found.text().split("\n")
    assert lines[:6] == [
        "p_fail 1 within 1 h, not valid: unknown inputs",
        "  go is not active",
        "  t is unknown: 120 is above t_max (85 degC); it counts as unknown",
        "  u is unknown",
        "  lost: it reports that a failed part works again; ignored without `repair: true`",
        "  model cpu: p_fail 0.0163",
    ]
    assert lines[-1] == "  model tree: ignored once that something failed works again"
