"""End of a node: once, soon, and with a status that gives the reason.

rospy's own shutdown talks to the ROS master without a time limit; a master that hangs, or a host
that vanished, would keep the process (and roslaunch) waiting.
"""

import contextlib
import os
import sys
import threading
import time
from typing import Callable, List

import rospy
import rospy.core

from ...node.logs import LOG
from ...node.schedule import Waker

GRACE_S = 1.5
_FLUSH_S = 0.3
TAKEN_OVER, MASTER_LOST = 1, 3
_REASON_OF_MASTER = "new node registered with same name"


class Ending:
    """The end of the process.

    Attributes:
        begun: the node must publish nothing more.
        status: exit status: 0, ``TAKEN_OVER`` or ``MASTER_LOST``.
    """

    def __init__(self) -> None:
        self.begun = False
        self.status = 0
        self._stops: List[Callable[[], None]] = []
        self._waker = Waker()

    def on_end(self, stop: Callable[[], None]) -> None:
        """Have something stopped first; it may run in a signal handler and must return at once."""
        self._stops.append(stop)

    def install(self) -> None:
        """Hear of every end that rospy knows; ``rospy.init_node`` has been called."""
        rospy.on_shutdown(self._begin)
        rospy.core.add_preshutdown_hook(self._explain)
        threading.Thread(target=self._guard, name="end guard", daemon=True).start()

    def end(self, status: int, reason: str) -> None:
        """End the process with a status."""
        LOG.error("ending with status %d: %s", status, reason)
        self.status = status
        rospy.signal_shutdown(reason)

    def wait(self) -> None:
        """Wait until the node is unregistered and all is logged; the guard limits the wait."""
        while self.begun and not rospy.is_shutdown():
            time.sleep(0.01)
        LOG.flush(_FLUSH_S)

    def _begin(self) -> None:
        self.begun = True
        self._waker.wake()
        for stop in self._stops:
            stop()

    def _explain(self, reason: str) -> None:
        if _REASON_OF_MASTER in reason:
            self.status = TAKEN_OVER
            LOG.error("the ROS master ended this node: another one has its name (%s)", reason)

    def _guard(self) -> None:
        while not self._waker.wait(threading.TIMEOUT_MAX):
            pass
        time.sleep(GRACE_S)
        with contextlib.suppress(Exception):
            sys.stdout.flush()
        os._exit(self.status)
