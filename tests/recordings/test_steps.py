"""When the node of a recording steps: by its period, at changes, and when an age ends."""

import pytest

from eddi_scaffold.recordings.playing import StepRule, Steps

SECOND = 1_000_000_000


def times(rule, rows, limits=None, start=0, end=None):
    """Return the times of the steps on rows of (t, source), in nanoseconds."""
    waiting = list(rows)
    steps = Steps(rule, limits or {}, start, rows[-1][0] if end is None else end)
    found = []
    while True:
        due = [t for t in (steps.due(), waiting[0][0] if waiting else None) if t is not None]
        if not due:
            return found
        t = min(due)
        while waiting and waiting[0][0] <= t:
            at, source = waiting.pop(0)
            steps.received(at, source)
            steps.changed(at)
        due_now = steps.due()
        if due_now is not None and due_now <= t:
            found.append(t)
            steps.stepped(t)


def test_a_rate_is_a_grid_from_the_start_that_does_not_drift() -> None:
    found = times(
        StepRule(SECOND / 3, on_change=False),
        [(7, "a"), (SECOND, "a"), (2 * SECOND + 7, "a")],
        start=7,
    )
    assert found == [7, 333333340, 666666674, SECOND + 7, 1333333340, 1666666674, 2 * SECOND + 7]


def test_what_came_between_two_steps_at_the_end_is_still_seen() -> None:
    rate = StepRule(100, on_change=False)
    assert times(rate, [(0, "a"), (150, "a")]) == [0, 100, 200]
    assert times(rate, [(0, "a"), (200, "a")]) == [0, 100, 200]
    assert times(rate, [(5, "a")], start=5) == [5]


def test_on_change_steps_at_rows_by_period_and_when_an_age_ends() -> None:
    rule = StepRule(100, on_change=True)
    assert times(rule, [(0, "a"), (30, "a"), (250, "a")]) == [0, 30, 130, 230, 250]
    slow = StepRule(1000, on_change=True)
    rows = [(0, "a"), (10, "b"), (30, "a"), (250, "b")]
    assert times(slow, rows, {"a": [40], "b": [200, 500]}) == [0, 10, 30, 71, 211, 250]


@pytest.mark.parametrize("mode", ["rate", "on_change"])
def test_the_grid_is_exact_also_where_a_float_is_not(mode: str) -> None:
    start = 1_700_000_000_070_000_001
    wanted = [start + k * 100_000_000 for k in range(30)]
    assert (
        times(
            StepRule(SECOND / 10, mode == "on_change"),
            [(start, "a"), (wanted[-1], "a")],
            start=start,
        )
        == wanted
    )
