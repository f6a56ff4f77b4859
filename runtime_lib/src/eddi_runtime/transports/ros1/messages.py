"""What is made of rospy's and genpy's classes: messages, their time, diagnostics, the log."""

import time
from io import BytesIO
from types import ModuleType
from typing import Any, Callable, Iterable, List, Tuple

import rospy
import rospy.impl.paramserver
from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus, KeyValue

from ...node.conversion import Converter, MessageClasses
from ...node.logs import LOG
from ...node.report import Report

_ROSOUT_SWITCH = "/rosout_disable_topics_generation"


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


def _fields(cls: Any) -> Iterable[Tuple[str, str]]:
    return zip(cls.__slots__, cls._slot_types)


def converter(messages: ModuleType) -> Converter:
    """Return what makes messages of a package; rospy itself counts ``header.seq``.

    Args:
        messages: module that holds the message classes by name (``eddi_messages.msg``).
    """
    return Converter(MessageClasses(messages, _fields, ros_type, stamp))


def check_serialises(message: object) -> None:
    """Raise what rospy would raise once somebody listens; for messages made by hand."""
    made: Any = message
    if made is not None:
        made.serialize(BytesIO())


def status_of(report: Report, name: str, hardware_id: str) -> object:
    """Return a report as a message.

    Args:
        report: of a monitor.
        name: of the status (``<node>: <model id>``).
        hardware_id: node name.
    """
    return DiagnosticStatus(
        level=report.level,
        name=name,
        message=report.message,
        hardware_id=hardware_id,
        values=[KeyValue(key=key, value=value) for key, value in report.values],
    )


def diagnostics_publisher() -> Callable[[List[Any]], None]:
    """Return what publishes statuses on ``/diagnostics``."""
    publisher: Any = rospy.Publisher("/diagnostics", DiagnosticArray, queue_size=5)

    def publish(statuses: List[Any]) -> None:
        array = DiagnosticArray(status=statuses)
        array.header.stamp = stamp()
        publisher.publish(array)

    return publish


def start_log() -> None:
    """Let the log of the process write by rospy; ``rospy.init_node`` has been called.

    Every ``rospy.log*`` asks the ROS master for a parameter before it writes (ros_comm 1.15.15,
    unless that parameter is set), and writes to a pipe that roslaunch has to read.
    """
    # With a value in rospy's cache the log works without the master, and is faster.
    cache: Any = rospy.impl.paramserver.get_param_server_cache()
    cache.set(_ROSOUT_SWITCH, bool(rospy.get_param(_ROSOUT_SWITCH, default=False)))
    LOG.start({"info": rospy.loginfo, "warn": rospy.logwarn, "error": rospy.logerr})
