"""When the next step is due, on the monotonic clock only.

``rospy.Rate`` is not used: without ``/clock`` under simulated time it sleeps forever, and a clock
that jumps back makes it raise.
"""

import contextlib
import threading


class Waker:
    """Lets the loop sleep until a deadline or until somebody wakes it.

    A plain lock used as a binary semaphore, because a signal handler must be able to wake a loop
    that runs in the same thread: ``threading.Event.set`` may deadlock there.
    """

    def __init__(self) -> None:
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
    """The grid of steps: one per period, late ones are counted and not made up.

    ``on_change``: steps may also come early; then the period counts from the last step.
    """

    def __init__(self, period: float, on_change: bool) -> None:
        self.period = period
        self.overruns = 0
        self._on_change = on_change
        self._due = 0.0

    def start(self, now: float) -> None:
        """Begin the grid: the next step is due one period after ``now``."""
        self._due = now + self.period

    def wait_s(self, now: float) -> float:
        """Seconds until the next step, never negative."""
        return max(0.0, self._due - now)

    def stepped(self, started: float, now: float) -> None:
        """Note a finished step that began at ``started`` (monotonic seconds)."""
        following = started + self.period if self._on_change else self._due + self.period
        if following <= now:
            missed = int((now - following) / self.period) + 1
            self.overruns += missed
            following += missed * self.period
        self._due = following
