"""The log of a process: written by a thread of its own, which nothing that it writes to can end."""

import threading
import time

import pytest
from eddi_runtime.node.start import Log, Schedule, Settings, StartError, Waker, settings


class Written:
    """Keeps lines as a transport would write them, and hangs or fails while it is told to."""

    def __init__(self):
        self.lines = []
        self.free = threading.Event()
        self.free.set()
        self.broken = False

    def writers(self):
        def write(level):
            def one(text, *values):
                assert self.free.wait(10.0)
                if self.broken:
                    raise BrokenPipeError
                self.lines.append((level, text % values))

            return one

        return {level: write(level) for level in ("info", "warn", "error")}


@pytest.fixture
def written():
    return Written()


@pytest.fixture
def process(written):
    return Log()


def test_what_was_said_before_the_start_is_written(process, written):
    process.info("%d inputs", 3)
    process.warn("late")
    process.start(written.writers())
    process.error("broken: %s", "why")
    process.flush(10.0)
    assert written.lines == [("info", "3 inputs"), ("warn", "late"), ("error", "broken: why")]


def test_a_writer_that_hangs_stops_nobody_and_the_oldest_lines_go(process, written):
    process.start(written.writers())
    written.free.clear()
    for number in range(600):
        process.info("%d", number)
    process.flush(0.02)
    assert written.lines == []
    written.free.set()
    process.flush(10.0)
    *lines, (level, text) = written.lines
    assert (level, text.split()[1:]) == ("warn", ["log", "lines", "were", "dropped"])
    dropped = int(text.split()[0])
    # The thread may have taken the first one, and just then that one may be counted as well.
    assert (dropped, len(lines)) in {(100, 500), (99, 501), (100, 501)}
    assert [text for _, text in lines][-500:] == [str(number) for number in range(100, 600)]


def test_a_writer_that_fails_ends_no_log(process, written):
    """A pipe that nobody reads any more: what comes later may go elsewhere as well."""
    process.start(written.writers())
    written.broken = True
    process.error("lost")
    process.flush(10.0)
    written.broken = False
    process.error("kept")
    process.flush(10.0)
    assert written.lines == [("error", "kept")]


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


CHOICES = {"on_loss": ("wait", "exit")}


def test_what_is_not_given_is_that_of_the_generated_node():
    good = settings({"frequency": 2, "other": object()}, 10.0, choices=CHOICES)
    assert good == Settings(2.0, words={"on_loss": "wait"})
    assert settings({}, 10.0, 3.0) == Settings(10.0, startup_grace=3.0)
    assert settings({"startup_grace": 0}, 10.0, 3.0) == Settings(10.0, startup_grace=0.0)


def test_all_that_is_wrong_is_told_at_once():
    bad = {"frequency": float("nan"), "diagnostics": 1, "watchdog_period": -1, "queue_size": 0}
    bad.update(startup_grace=-1, on_loss=[])
    with pytest.raises(StartError) as caught:
        settings({**bad, "frequency": "fast"}, 10.0, choices=CHOICES)
    wrong = str(caught.value).split("; p")
    wrong[1:] = [f"p{text}" for text in wrong[1:]]
    assert wrong[0] == "parameter ~frequency: 0.000001 to 1000000 Hz expected, got 'fast'"
    assert [text.split(":")[0] for text in wrong] == [f"parameter ~{name}" for name in bad]


@pytest.mark.parametrize("name", ["frequency", "watchdog_period", "startup_grace", "queue_size"])
@pytest.mark.parametrize("value", [True, None, "1", float("nan"), float("inf"), -1, [1]])
def test_what_is_no_number_is_refused(name, value):
    with pytest.raises(StartError, match=f"^parameter ~{name}: [^;]*$"):
        settings({name: value}, 10.0)


@pytest.mark.parametrize("value", [0, 0.0, 1e-7, 1e7, 1e300, 5e-324, 10**400])
def test_a_frequency_is_one_that_a_configuration_may_have(value):
    """At 1e300 Hz the first late step would end the loop: its overruns are no number."""
    with pytest.raises(StartError, match=r"^parameter ~frequency: [^;]*$"):
        settings({"frequency": value}, 10.0)
