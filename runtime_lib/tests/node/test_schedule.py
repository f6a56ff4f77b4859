"""When steps are due, and how a loop that sleeps is woken."""

import threading
import time

import pytest
from eddi_runtime.node.start import Schedule, Waker


def test_late_steps_are_counted_and_not_made_up():
    grid = Schedule(0.1, on_change=False)
    grid.start(0.0)
    grid.stepped(0.1, 0.12)
    assert grid.wait_s(0.12) == pytest.approx(0.08)
    grid.stepped(0.2, 0.55)
    assert grid.overruns == 3  # 0.3, 0.4 and 0.5 have passed
    assert grid.wait_s(0.55) == pytest.approx(0.05)
    assert grid.wait_s(0.7) == 0.0


def test_the_grid_does_not_drift_by_what_each_step_takes():
    grid = Schedule(0.1, on_change=False)
    now = 0.0
    grid.start(now)
    for _ in range(1000):
        started = now + grid.wait_s(now) + 0.001
        now = started + 0.03
        grid.stepped(started, now)
    assert now + grid.wait_s(now) == pytest.approx(100.1)
    assert grid.overruns == 0


def test_a_step_on_a_message_begins_a_new_period():
    early = Schedule(2.0, on_change=True)
    early.start(0.0)
    early.stepped(0.5, 0.6)
    assert early.wait_s(0.6) == pytest.approx(1.9)
    assert early.overruns == 0
    early.stepped(2.5, 7.0)
    assert early.overruns == 2  # 4.5 and 6.5
    assert early.wait_s(7.0) == pytest.approx(1.5)


def test_many_wakes_are_one():
    waker = Waker()
    assert not waker.wait(0.01)
    for _ in range(3):
        waker.wake()
    assert waker.wait(0.0)
    assert not waker.wait(0.0)
    assert not waker.wait(-1.0)


def test_a_wait_ends_when_somebody_wakes_it():
    waker = Waker()
    threading.Timer(0.05, waker.wake).start()
    started = time.monotonic()
    assert waker.wait(float("inf"))  # a period may be longer than a lock can wait
    assert time.monotonic() - started < 5.0
