"""A node from its settings to its end: what cannot work ends before others see it.

Only the monotonic clock counts for steps: timers of ROS sleep for ever without ``/clock``.
"""

from __future__ import annotations

import collections
import contextlib
import math
import os
import signal
import sys
import threading
import time
from contextlib import contextmanager, suppress
from functools import partial
from typing import Any, Callable, Iterator, Mapping, NamedTuple, Sequence, Tuple

from ..monitor import ModelError

_ADVICE = "run `eddi-scaffold upgrade` or `copier recopy --trust --force` in the package"


class StartError(Exception):
    """The node must not start; the text gives the reason for the user."""


@contextmanager
def reported(package: str) -> Iterator[None]:
    """End with one line, not a traceback, when the compiled monitor cannot be imported."""
    try:
        yield
    except ModelError as error:
        reason = str(error)
    except SyntaxError as error:
        if not str(error.filename).endswith("compiled.py"):
            raise
        reason = f"{error.filename}: the file is damaged: {_ADVICE}"
    except ImportError as error:
        name = error.name or ""
        if name.partition(".")[0] != "eddi_runtime" and not name.endswith(".compiled"):
            raise
        reason = f"the package is not whole: {error}: {_ADVICE}"
    else:
        return
    write_to_stderr(package, f"error: {reason}")
    sys.exit(1)


@contextmanager
def installed(package: str, advice: str) -> Iterator[None]:
    """End with one line, not a traceback, when what comes with a robot's system is not there."""
    try:
        yield
    except ImportError as error:
        write_to_stderr(package, f"error: {error}: {advice}")
        sys.exit(1)


def end_at_signals() -> None:
    """End at once at a signal: a node that has said nothing yet leaves nothing behind."""
    for number in (signal.SIGINT, signal.SIGTERM):
        signal.signal(number, lambda *_: os._exit(0))


def write_to_stderr(node: str, text: str) -> None:
    """Write a line of a node whose transport has no log yet."""
    sys.stderr.write(f"{node}: {text}\n")
    sys.stderr.flush()


STARTUP_GRACE_S = 10.0
FREQUENCIES = (1e-6, 1e6)  # least and most steps per second: periods that every clock can count


class Settings(NamedTuple):
    """What a person may set per node."""

    frequency: float  # steps per second; fractions are common (0.2)
    diagnostics: bool = True  # publish a summary on ``/diagnostics``
    # seconds between two looks at the graph around the node, 0 for none
    watchdog_period: float = 2.0
    queue_size: int = 1  # messages that wait for a slow subscriber of the outputs
    # seconds from the start in which an input may wait for its first message
    startup_grace: float = STARTUP_GRACE_S
    words: Mapping[str, str] = {}  # parameters that only the transport has, by name
    robot: str = ""  # name of this robot among others, empty for the configured one


def _number(value: object) -> float:
    """Return a finite number, NaN of anything else: no comparison with that is true."""
    if isinstance(value, (int, float)) and not isinstance(value, bool):
        with suppress(OverflowError):  # a whole number may be too large for a float
            return float(value) if math.isfinite(value) else math.nan
    return math.nan


_SECONDS = ("seconds >= 0", lambda value: _number(value) >= 0.0)
_RULES: Mapping[str, tuple[str, Callable[[Any], bool]]] = {
    "frequency": (
        f"{FREQUENCIES[0]:f} to {FREQUENCIES[1]:.0f} Hz",
        lambda value: FREQUENCIES[0] <= _number(value) <= FREQUENCIES[1],
    ),
    "diagnostics": ("true or false", lambda value: isinstance(value, bool)),
    "watchdog_period": _SECONDS,
    "queue_size": ("a whole number >= 1", lambda value: type(value) is int and value >= 1),
    "startup_grace": _SECONDS,
    "robot": ("the name of this robot", lambda name: isinstance(name, str) and name.isprintable()),
}
"""Parameter -> what is expected, and whether a value is that."""


def settings(
    parameters: Mapping[str, object],
    frequency: float,
    startup_grace: float = STARTUP_GRACE_S,
    choices: Mapping[str, Sequence[str]] = {},
) -> Settings:
    """Return the settings, or raise StartError with all that is wrong with our own parameters.

    ``choices``: parameter that only the transport has -> its words, the default first.
    """
    rules = {**_RULES}
    defaults = Settings(frequency, startup_grace=startup_grace)._asdict()
    for name, words in choices.items():
        rules[name], defaults[name] = (" or ".join(words), words.__contains__), words[0]
    values: dict[str, Any] = {name: parameters.get(name, defaults[name]) for name in rules}
    wrong = [
        f"parameter ~{name}: {text} expected, got {values[name]!r}"
        for name, (text, fits) in rules.items()
        if not fits(values[name])
    ]
    if wrong:
        raise StartError("; ".join(wrong))
    for name in ("frequency", "watchdog_period", "startup_grace"):
        values[name] = float(values[name])
    return Settings(**{k: values[k] for k in _RULES}, words={k: values[k] for k in choices})


class Waker:
    """Lets the loop sleep until a deadline or until somebody wakes it."""

    def __init__(self) -> None:
        # A signal handler may wake its own thread, where ``threading.Event.set`` may deadlock.
        self._signal = threading.Lock()
        self._signal.acquire()

    def wake(self) -> None:
        """End the present (or the next) wait; any number of calls count as one."""
        # Released already: woken, but not yet noticed, and one step takes it all.
        with contextlib.suppress(RuntimeError):
            self._signal.release()

    def wait(self, seconds: float) -> bool:
        """Sleep for at most ``seconds``; ``True`` when woken before."""
        if seconds <= 0.0:
            return self._signal.acquire(blocking=False)
        return self._signal.acquire(timeout=min(seconds, threading.TIMEOUT_MAX))


class Schedule:
    """The grid of steps: one per period, late ones are counted and not made up."""

    def __init__(self, period: float, on_change: bool) -> None:
        self.period = period
        self.overruns = 0
        self._on_change = on_change
        self._due = 0.0

    def start(self, now: float) -> None:
        """Begin the grid: the next step is due one period after ``now``."""
        self._due = now + self.period

    def wait_s(self, now: float) -> float:
        """Return the seconds until the next step, never negative."""
        return max(0.0, self._due - now)

    def stepped(self, started: float, now: float) -> None:
        """Note a finished step that began at ``started`` (monotonic seconds)."""
        # where steps may come early, the period counts from the last one
        following = started + self.period if self._on_change else self._due + self.period
        if following <= now:
            missed = int((now - following) / self.period) + 1
            self.overruns += missed
            following += missed * self.period
        self._due = following


_KEPT = 500
_Line = Tuple[str, str, Tuple[object, ...]]
LEVELS = ("info", "warn", "error")
"""For the record; something needs attention; something is broken."""
Writers = Mapping[str, Callable[..., None]]
"""Level -> writes a text with its values, as ``logging`` does."""


class Log:
    """Keeps lines until its own thread has written them, so that no transport stops a monitor."""

    def __init__(self) -> None:
        self.named = False  # lines begin with the name of their thread: it is that of a monitor
        # Appending to a deque takes no lock, so a signal handler may log as well.
        self._lines: collections.deque[_Line] = collections.deque(maxlen=_KEPT)
        self._waker = Waker()
        self._busy = False
        self._dropped = 0
        self.info, self.warn, self.error = (partial(self._put, level) for level in LEVELS)

    def start(self, write: Writers) -> None:
        """Begin to write; what was said before is written now."""
        threading.Thread(target=self._run, args=[write], name="log", daemon=True).start()

    def flush(self, seconds: float) -> None:
        """Wait until everything is written, but not longer than this."""
        end = time.monotonic() + seconds
        while (self._lines or self._busy) and time.monotonic() < end:
            time.sleep(0.005)

    def _put(self, level: str, text: str, *values: object) -> None:
        if self.named:
            text = f"{threading.current_thread().name}: {text}"
        self._dropped += len(self._lines) == _KEPT  # one too many where a line is taken just now
        self._lines.append((level, text, values))
        self._waker.wake()

    def _run(self, write: Writers) -> None:
        while True:
            self._waker.wait(threading.TIMEOUT_MAX)
            self._busy = True
            while self._lines:
                level, text, values = self._lines.popleft()
                with contextlib.suppress(Exception):  # a broken pipe ends this line, not the log
                    write[level](text, *values)
            if self._dropped:
                dropped, self._dropped = self._dropped, 0
                write["warn"]("%d log lines were dropped", dropped)
            self._busy = False


LOG = Log()  # one per process


GRACE_S = 1.5
_FLUSH_S = 0.3


class Ending:
    """The end of the process: once, soon, with a status; a guard limits what talks meanwhile."""

    def __init__(self) -> None:
        self.begun = False  # the node must publish nothing more
        self.status = 0  # exit status
        self._stops: list[Callable[[], None]] = []
        self._waker = Waker()

    def on_end(self, stop: Callable[[], None]) -> None:
        """Have something stopped first; it may run in a signal handler and must return at once."""
        self._stops.append(stop)
        if self.begun:  # already, or between the two lines
            stop()

    def install(self) -> None:
        """Guard the end: when it takes too long, the process ends without it."""
        threading.Thread(target=self._guard, name="end guard", daemon=True).start()

    def begin(self) -> None:
        self.begun = True
        self._waker.wake()
        for stop in self._stops:
            stop()

    def wait(self) -> None:
        LOG.flush(_FLUSH_S)

    def _guard(self) -> None:
        while not self._waker.wait(threading.TIMEOUT_MAX):
            pass
        time.sleep(GRACE_S)
        with contextlib.suppress(Exception):
            sys.stdout.flush()
        os._exit(self.status)
