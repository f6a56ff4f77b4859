"""Private parameters of the node, checked all at once."""

import contextlib
import math
from typing import List, Mapping, NamedTuple, Optional, Sequence, Tuple

STARTUP_GRACE_S = 10.0
FREQUENCIES = (1e-6, 1e6)
"""Least and most steps per second: periods that every clock can count."""


class Settings(NamedTuple):
    """What a person may set per node.

    Attributes:
        frequency: steps per second; fractions are common (0.2).
        diagnostics: publish a summary on ``/diagnostics``.
        watchdog_period: seconds between two looks at the graph around the node, 0 for none.
        queue_size: messages that wait for a slow subscriber of the outputs.
        startup_grace: seconds from the start in which an input may wait for its first message.
        words: parameters that only the transport has, by name.
        robot: name of this robot among others, empty for the configured one.
    """

    frequency: float
    diagnostics: bool = True
    watchdog_period: float = 2.0
    queue_size: int = 1
    startup_grace: float = STARTUP_GRACE_S
    words: Mapping[str, str] = {}
    robot: str = ""


def _number(value: object) -> Optional[float]:
    if isinstance(value, (int, float)) and not isinstance(value, bool):
        with contextlib.suppress(OverflowError):  # a whole number may be too large for a float
            return float(value) if math.isfinite(value) else None
    return None


def settings(
    given: Mapping[str, object],
    frequency: float,
    startup_grace: float = STARTUP_GRACE_S,
    choices: Mapping[str, Sequence[str]] = {},
) -> Tuple[Settings, List[str]]:
    """Return the settings and what is wrong with the given private parameters.

    Args:
        given: private parameters by name; others than ours are left alone.
        frequency: steps per second of the generated node.
        startup_grace: of the generated node.
        choices: parameter that only the transport has -> its words, the default first.
    """
    wrong: List[str] = []

    def check(name: str, expected: str, value: object, fits: bool) -> None:
        if not fits:
            wrong.append(f"parameter ~{name}: {expected} expected, got {value!r}")

    rate = given.get("frequency", frequency)
    hertz = _number(rate)
    low, high = FREQUENCIES
    fits = hertz is not None and low <= hertz <= high
    check("frequency", f"{low:f} to {high:.0f} Hz", rate, fits)
    if given.get("model"):
        wrong.append(
            "parameter ~model: the model is compiled into the package; take the parameter out of"
            " the launch file, and run `eddi-scaffold upgrade -m MODEL` for another model"
        )
    diagnostics = given.get("diagnostics", True)
    check("diagnostics", "true or false", diagnostics, isinstance(diagnostics, bool))
    period = given.get("watchdog_period", 2.0)
    seconds = _number(period)
    check("watchdog_period", "seconds >= 0", period, seconds is not None and seconds >= 0.0)
    words = {name: given.get(name, known[0]) for name, known in choices.items()}
    for name, word in words.items():
        check(name, " or ".join(choices[name]), word, word in choices[name])
    size = given.get("queue_size", 1)
    count = size if isinstance(size, int) and not isinstance(size, bool) else 0
    check("queue_size", "a whole number >= 1", size, count >= 1)
    grace = given.get("startup_grace", startup_grace)
    wait = _number(grace)
    check("startup_grace", "seconds >= 0", grace, wait is not None and wait >= 0.0)
    robot = given.get("robot", "")
    named = isinstance(robot, str) and robot.isprintable()
    check("robot", "the name of this robot", robot, named)
    if wrong or hertz is None or seconds is None or wait is None:
        return Settings(frequency), wrong
    chosen = {name: str(word) for name, word in words.items()}
    return Settings(hertz, bool(diagnostics), seconds, count, wait, chosen, str(robot)), wrong
