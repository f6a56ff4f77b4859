"""How long a call takes, for the benchmarks whose calls last longer than calling does."""

from __future__ import annotations

import itertools
import time
from collections.abc import Callable


def per_call(call: Callable[[], object], seconds: float) -> float:
    """Return the seconds of one call, of a loop that takes about ``seconds``."""
    number, spent = 1, 0.0
    while True:
        repeat = itertools.repeat(None, number)
        start = time.process_time()  # of this process: others on the machine do not count
        for _ in repeat:
            call()
        spent = time.process_time() - start
        if spent >= seconds:
            return spent / number
        number = max(2 * number, int(number * seconds / max(spent, 1e-6)))
