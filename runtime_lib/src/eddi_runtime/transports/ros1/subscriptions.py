"""Latest message of every input. Callbacks only store; all conversion happens in the loop."""

import threading
import time
from collections import deque
from typing import Any, Callable, Deque, Dict, Iterable, List, Optional, Tuple

import rospy

from ...inputs import UNKNOWN_AGE
from ...node.receipts import Receipt
from ...node.topics import DEFAULT_BUFFER_BYTES, Input

_MAX_PUBLISHERS = 32
_MAX_QUEUED = 1000
"""Messages between two steps; older ones are dropped and counted."""


class _Slot:
    """Receives the messages of one input."""

    def __init__(self, source: Input, lock: threading.Lock, arrived: Callable[[], None]) -> None:
        self.source = source
        self.receipt: Optional[Receipt] = None
        self._lock = lock
        self._arrived = arrived
        self._greeted: Dict[str, object] = {}
        self._queue: Deque[object] = deque(maxlen=_MAX_QUEUED)
        self.dropped = 0

    def receive(self, message: object) -> None:
        """Store one message; runs in a thread of rospy."""
        now = time.monotonic()
        header = getattr(message, "_connection_header", None) or {}
        # rospy keeps one header object per connection: a new object means a first message.
        publisher = str(header.get("callerid", ""))
        latched = header.get("latching") == "1" and self._greeted.get(publisher) is not header
        with self._lock:
            if len(self._greeted) >= _MAX_PUBLISHERS:
                self._greeted.clear()  # every rostopic pub has a name of its own
            self._greeted[publisher] = header
            number = 1 if self.receipt is None else self.receipt.received + 1
            self.receipt = Receipt(message, now, number, _stamped_age(message) if latched else 0.0)
            if self.source.every_message:
                self.dropped += len(self._queue) == _MAX_QUEUED
                self._queue.append(message)
        self._arrived()

    def taken(self) -> List[object]:
        """Return the queued messages, oldest first, and forget them; the caller has the lock."""
        messages = list(self._queue)
        self._queue.clear()
        return messages


def _stamped_age(message: object) -> float:
    """Return how old a message is by its header; one from the future may be of any age, too."""
    made = getattr(getattr(message, "header", None), "stamp", None)
    if not made or not rospy.rostime.is_rostime_initialized():  # a stamp of zero is no time
        return UNKNOWN_AGE
    age = float((rospy.Time.now() - made).to_sec())
    return age if age >= 0.0 else UNKNOWN_AGE


class Subscriptions:
    """The subscriptions of one monitor.

    Args:
        arrived: called after every stored message (``on_change`` wakes the loop here).
    """

    def __init__(self, arrived: Callable[[], None]) -> None:
        self._lock = threading.Lock()
        self._arrived = arrived
        self._slots: Dict[str, _Slot] = {}
        self._subscribers: Dict[str, Any] = {}

    def subscribe(self, sources: Iterable[Input]) -> None:
        """Subscribe to every input; blocks while the ROS master does not answer."""
        for source in sources:
            slot = _Slot(source, self._lock, self._arrived)
            self._slots[source.id] = slot
            more = {}
            if source.buffer_bytes != DEFAULT_BUFFER_BYTES:
                more["buff_size"] = source.buffer_bytes
            self._subscribers[source.id] = rospy.Subscriber(
                source.topic,
                source.type,
                slot.receive,
                queue_size=_MAX_QUEUED if source.every_message else 1,
                tcp_nodelay=True,
                **more,
            )

    def receipts(self) -> Dict[str, Receipt]:
        """Return the last message of every input that has one, at one instant."""
        with self._lock:
            return self._receipts()

    def taken(self) -> Tuple[Dict[str, Receipt], Dict[str, List[object]]]:
        """Return the last messages, and those since the last call of inputs that take each of them.

        At one instant: one that came between the two would be new without having been received.
        """
        with self._lock:
            each = {n: slot.taken() for n, slot in self._slots.items() if slot.source.every_message}
            return self._receipts(), each

    def _receipts(self) -> Dict[str, Receipt]:
        return {
            name: slot.receipt for name, slot in self._slots.items() if slot.receipt is not None
        }

    def dropped(self) -> Dict[str, int]:
        """Return input id -> messages that were dropped because too many came in one period."""
        with self._lock:
            return {name: slot.dropped for name, slot in self._slots.items() if slot.dropped}

    def topics(self) -> Dict[str, str]:
        """Return input id -> resolved topic of every subscription."""
        return {name: one.resolved_name for name, one in dict(self._subscribers).items()}

    def expected_types(self) -> Dict[str, Tuple[str, str]]:
        """Return resolved topic -> (input id, ROS type name) of every subscription."""
        return {
            subscriber.resolved_name: (name, str(subscriber.type))
            for name, subscriber in self._subscribers.items()
        }
