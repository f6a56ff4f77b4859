"""Messages as genpy makes their classes, and the time that stands in their headers."""

import time
from types import ModuleType
from typing import Any, Iterable, Tuple

import rospy

from ...node.conversion import Converter, MessageClasses


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
