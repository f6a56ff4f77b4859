"""Messages of rospy and genpy: made, received with their age, reported, logged."""

from __future__ import annotations

import threading
import time
from types import ModuleType
from typing import Any, Callable, Iterable

import rospy
import rospy.impl.paramserver
from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus, KeyValue

from ...inputs import UNKNOWN_AGE
from ...node.health import Status
from ...node.loop import LOG
from ...node.outputs import Converter, MessageClasses
from ...node.receipts import Receipts

_ROSOUT_SWITCH = "/rosout_disable_topics_generation"
_MAX_PUBLISHERS = 32


def stamp() -> object:
    """Return the time for a header: ROS time, wall time while there is none (no /clock yet)."""
    if rospy.rostime.is_rostime_initialized():
        now = rospy.Time.now()
        if now.to_nsec():
            return now
    return rospy.Time.from_sec(time.time())


def ros_type(message: object) -> str:
    """Return ``package/Name`` of a ROS message or of its class."""
    known: Any = message
    return str(known._type)  # noqa: SLF001 - genpy's interface, in spite of its name


def _fields(cls: Any) -> Iterable[tuple[str, str]]:
    return zip(cls.__slots__, cls._slot_types)


def converter(messages: ModuleType) -> Converter:
    """Return what makes messages of a package; rospy itself counts ``header.seq``."""
    return Converter(MessageClasses(messages, _fields, ros_type, stamp))


class Callback:
    """Takes the messages of one input; rospy calls it in a thread of each publisher."""

    def __init__(self, source: str, receipts: Receipts) -> None:
        self._source, self._receipts = source, receipts
        self._greeted: dict[str, object] = {}
        self._lock = threading.Lock()

    def __call__(self, message: object) -> None:
        """Store one message."""
        header = getattr(message, "_connection_header", None) or {}
        # rospy keeps one header object per connection: a new object means a first message.
        publisher = str(header.get("callerid", ""))
        latched = header.get("latching") == "1"
        with self._lock:
            first = self._greeted.get(publisher) is not header
            if len(self._greeted) >= _MAX_PUBLISHERS:
                self._greeted.clear()  # every rostopic pub has a name of its own
            self._greeted[publisher] = header
            age = _stamped_age(message) if latched and first else 0.0
            self._receipts.receive(self._source, message, age)


def _stamped_age(message: object) -> float:
    """Return how old a message is by its header; one from the future may be of any age, too."""
    made = getattr(getattr(message, "header", None), "stamp", None)
    if not made or not rospy.rostime.is_rostime_initialized():  # a stamp of zero is no time
        return UNKNOWN_AGE
    age = float((rospy.Time.now() - made).to_sec())
    return age if age >= 0.0 else UNKNOWN_AGE


def diagnostics_publisher() -> Callable[[list[Status]], None]:
    """Return what publishes statuses on ``/diagnostics``."""
    publisher: Any = rospy.Publisher("/diagnostics", DiagnosticArray, queue_size=5)

    def publish(statuses: list[Status]) -> None:
        array = DiagnosticArray(status=[_status(status) for status in statuses])
        array.header.stamp = stamp()
        publisher.publish(array)

    return publish


def _status(status: Status) -> object:
    report = status.report
    return DiagnosticStatus(
        level=report.level,
        name=status.name,
        message=report.message,
        hardware_id=status.node,
        values=[KeyValue(key=key, value=value) for key, value in report.values],
    )


def start_log() -> None:
    """Let the log of the process write by rospy; ``rospy.init_node`` has been called.

    Every ``rospy.log*`` asks the ROS master for a parameter before it writes (ros_comm 1.15.15,
    unless that parameter is set), and writes to a pipe that roslaunch has to read.
    """
    # With a value in rospy's cache the log works without the master, and is faster.
    cache: Any = rospy.impl.paramserver.get_param_server_cache()
    cache.set(_ROSOUT_SWITCH, bool(rospy.get_param(_ROSOUT_SWITCH, default=False)))
    LOG.start({"info": rospy.loginfo, "warn": rospy.logwarn, "error": rospy.logerr})
