"""The log of this process, written by a thread of its own so that no line can stop a monitor.

Every ``rospy.log*`` asks the ROS master for a parameter before it writes (ros_comm 1.15.15, unless
that parameter is set), and writes to a pipe that roslaunch has to read. A master or a roslaunch
that hangs would otherwise end the loop of the monitor at its next line.
"""

import collections
import threading
import time
from typing import Any, Callable, Deque, Dict, Tuple

import rospy
import rospy.impl.paramserver

from .schedule import Waker

_KEPT = 500
_ROSOUT_SWITCH = "/rosout_disable_topics_generation"
_Line = Tuple[str, str, Tuple[object, ...]]


class Log:
    """Keeps lines until the thread has written them; the oldest are dropped when it hangs."""

    def __init__(self) -> None:
        # Appending to a deque takes no lock, so a signal handler may log as well.
        self._lines: Deque[_Line] = collections.deque(maxlen=_KEPT)
        self._waker = Waker()
        self._busy = False
        self._dropped = 0

    def start(self) -> None:
        """Begin to write; ``rospy.init_node`` has been called."""
        # With a value in rospy's cache the log works without the master, and is faster.
        cache: Any = rospy.impl.paramserver.get_param_server_cache()
        cache.set(_ROSOUT_SWITCH, bool(rospy.get_param(_ROSOUT_SWITCH, default=False)))
        threading.Thread(target=self._run, name="log", daemon=True).start()

    def info(self, text: str, *values: object) -> None:
        """Write a line for the record."""
        self._put("info", text, values)

    def warn(self, text: str, *values: object) -> None:
        """Write that something needs attention."""
        self._put("warn", text, values)

    def error(self, text: str, *values: object) -> None:
        """Write that something is broken."""
        self._put("error", text, values)

    def flush(self, seconds: float) -> None:
        """Wait until everything is written, but not longer than this."""
        end = time.monotonic() + seconds
        while (self._lines or self._busy) and time.monotonic() < end:
            time.sleep(0.005)

    def _put(self, level: str, text: str, values: Tuple[object, ...]) -> None:
        self._dropped += len(self._lines) == _KEPT
        self._lines.append((level, text, values))
        self._waker.wake()

    def _run(self) -> None:
        write: Dict[str, Callable[..., None]] = {
            "info": rospy.loginfo,
            "warn": rospy.logwarn,
            "error": rospy.logerr,
        }
        while True:
            self._waker.wait(threading.TIMEOUT_MAX)
            self._busy = True
            while self._lines:
                level, text, values = self._lines.popleft()
                write[level](text, *values)
            if self._dropped:
                dropped, self._dropped = self._dropped, 0
                rospy.logwarn("%d log lines were dropped", dropped)
            self._busy = False


LOG = Log()
"""One per process, as rospy's own log."""
