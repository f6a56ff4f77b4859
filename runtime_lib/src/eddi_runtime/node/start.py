"""Everything before a node is seen by others: what cannot work ends here, with the reason."""

from __future__ import annotations

import math
import os
import signal
import sys
from contextlib import contextmanager, suppress
from typing import Any, Callable, Iterator, Mapping, NamedTuple, Sequence

from ..monitor import ModelError

__all__ = [
    "FREQUENCIES", "STARTUP_GRACE_S", "Settings", "StartError", "end_at_signals", "installed",
    "reported", "settings", "write_to_stderr",
]  # fmt: skip

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
    given: Mapping[str, object],
    frequency: float,
    startup_grace: float = STARTUP_GRACE_S,
    choices: Mapping[str, Sequence[str]] = {},
) -> Settings:
    """Return the settings, or raise StartError with all that is wrong with our own parameters.

    ``choices``: parameter that only the transport has -> its words, the default first.
    """
    default = Settings(frequency, startup_grace=startup_grace)
    values: dict[str, Any] = {name: given.get(name, getattr(default, name)) for name in _RULES}
    words: dict[str, Any] = {name: given.get(name, known[0]) for name, known in choices.items()}
    expected = {name: text for name, (text, fits) in _RULES.items() if not fits(values[name])}
    unknown = [name for name, word in words.items() if word not in choices[name]]
    expected.update((name, " or ".join(choices[name])) for name in unknown)
    both = {**values, **words}
    wrong = [f"parameter ~{n}: {text} expected, got {both[n]!r}" for n, text in expected.items()]
    if wrong:
        raise StartError("; ".join(wrong))
    for name in ("frequency", "watchdog_period", "startup_grace"):
        values[name] = float(values[name])
    return Settings(**values, words=words)
