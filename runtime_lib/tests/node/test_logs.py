"""The log of a process: written by a thread of its own, which nothing that it writes to can end."""

import threading

import pytest
from eddi_runtime.node.start import Log


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
    assert 99 <= dropped <= 100  # the thread may have taken the first one
    assert len(lines) == 600 - dropped
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
