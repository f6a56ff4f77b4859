"""The publishers of one monitor."""

from io import BytesIO
from typing import Any, Dict, Iterable, List, Tuple

import rospy

from ...node.outputs import Channel, channels, each, picked
from ...node.topics import Output


def check_serialises(message: object) -> None:
    """Raise what rospy would raise once somebody listens; for messages made by hand."""
    made: Any = message
    if made is not None:
        made.serialize(BytesIO())


class Publications:
    """The publishers of one monitor: latched, with a queue, so that no subscriber can block.

    Args:
        outputs: what to publish.
        queue_size: messages that wait for a slow subscriber before old ones are dropped.
    """

    def __init__(self, outputs: Iterable[Output], queue_size: int) -> None:
        self._publishers: Dict[str, List[Tuple[Channel, Any]]] = {}
        for channel in channels(outputs):
            publisher = rospy.Publisher(
                channel.topic, channel.type, queue_size=queue_size, latch=True
            )
            self._publishers.setdefault(channel.of, []).append((channel, publisher))

    @property
    def beside(self) -> List[str]:
        """Names of the messages that somebody was promised beside the result."""
        return [name for name in self._publishers if name]

    def publish(self, message: object, of: str = "") -> None:
        """Publish on every topic of the result, or of a message beside it.

        Args:
            message: a message, a list of them, or None.
            of: name of the message, empty for the result.
        """
        for channel, publisher in self._publishers.get(of, ()):
            for one in each(message):
                if channel.only in (None, getattr(one, "id", None)):
                    publisher.publish(picked(one, channel))
