"""The subscriptions of one monitor: rospy's threads hand over messages, and how old they are."""

import threading
from typing import Any, Dict

import rospy

from ...inputs import UNKNOWN_AGE
from ...node.receipts import DEFAULT_BUFFER_BYTES, MAX_QUEUED, Input, Receipts

_MAX_PUBLISHERS = 32


class Callback:
    """Takes the messages of one input; rospy calls it in a thread of each publisher.

    Args:
        source: id of the input.
        receipts: where they are stored.
    """

    def __init__(self, source: str, receipts: Receipts) -> None:
        self._source, self._receipts = source, receipts
        self._greeted: Dict[str, object] = {}
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


def subscribe(source: Input, receipts: Receipts) -> Any:
    """Return the subscriber of an input; blocks while the ROS master does not answer."""
    large = source.buffer_bytes != DEFAULT_BUFFER_BYTES
    return rospy.Subscriber(
        source.topic,
        source.type,
        Callback(source.id, receipts),
        queue_size=MAX_QUEUED if source.every_message else 1,
        tcp_nodelay=True,
        **({"buff_size": source.buffer_bytes} if large else {}),
    )
