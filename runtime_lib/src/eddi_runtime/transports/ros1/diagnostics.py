"""Publishes the report of one monitor on ``/diagnostics``: 1 Hz, and at once on a new level."""

import threading
import time
from typing import Any, Callable

import rospy
from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus, KeyValue

from ...node.logs import LOG
from ...node.report import Report
from ...node.schedule import Waker
from .conversion import stamp

PERIOD_S = 1.0
_CALM_S = 0.1  # between two reports, so that a level that flaps does not flood the topic


class Diagnostics:
    """A thread of its own, so that a monitor slower than 1 Hz, or one that hangs, is reported.

    Args:
        name: of the status (``<node>: <model id>``).
        hardware_id: node name.
        collect: returns the present report; ``True`` as argument for the periodic one.
    """

    def __init__(self, name: str, hardware_id: str, collect: Callable[[bool], Report]) -> None:
        self._name = name
        self._hardware_id = hardware_id
        self._collect = collect
        self._waker = Waker()
        self._stopped = False
        self._publisher: Any = rospy.Publisher("/diagnostics", DiagnosticArray, queue_size=5)

    def start(self) -> None:
        """Begin to report."""
        threading.Thread(target=self._run, name="diagnostics", daemon=True).start()

    def stop(self) -> None:
        """Report no more; returns at once and may be called in a signal handler."""
        self._stopped = True
        self._waker.wake()

    def level_changed(self) -> None:
        """Report at once."""
        self._waker.wake()

    def _run(self) -> None:
        periodic = True
        while not self._stopped:
            try:
                self._publish(self._collect(periodic))
            except Exception as error:  # noqa: BLE001 - a report must never end the reporting
                if not self._stopped and not rospy.is_shutdown():
                    LOG.error("diagnostics: %s: %s", type(error).__name__, error)
            time.sleep(_CALM_S)
            periodic = not self._waker.wait(PERIOD_S - _CALM_S)

    def _publish(self, report: Report) -> None:
        status = DiagnosticStatus(
            level=report.level,
            name=self._name,
            message=report.message,
            hardware_id=self._hardware_id,
            values=[KeyValue(key=key, value=value) for key, value in report.values],
        )
        array = DiagnosticArray(status=[status])
        array.header.stamp = stamp()
        self._publisher.publish(array)
