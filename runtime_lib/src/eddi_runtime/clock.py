"""When a step is: what a caller gives as its time, judged before anything is computed of it."""

from __future__ import annotations

import time

from .plain_values import plain

NO_TIME = "the time of the step is no whole number of nanoseconds"
_LARGEST = 2**63


def step_time(given: object) -> int | None:
    """Return the time of a step in nanoseconds; None: what was given is no time. Never raises.

    Given is a whole number of 64 bits; None: the machine's monotonic clock.
    """
    if given is None:
        return time.monotonic_ns()
    given = given if type(given) is int else plain(given)
    if type(given) is not int:
        return None
    return given if -_LARGEST <= given < _LARGEST else None
