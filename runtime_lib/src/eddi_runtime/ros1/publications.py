"""The topics of one monitor: which message, or which value of it, goes where."""

from io import BytesIO
from typing import Any, Dict, Iterable, Iterator, List, NamedTuple, Optional, Tuple

import rospy

from ..access import follow
from .conversion import Converter, MessageError, Trees
from .topics import Output, ros_type


class _Channel(NamedTuple):
    """One topic.

    Attributes:
        of: which message of the monitor, as in ``Output``.
        topic: ROS name.
        type: ROS message class.
        field: as in ``Output``.
        only: as in ``Output``.
    """

    of: str
    topic: str
    type: Any
    field: Tuple[Any, ...] = ()
    only: Optional[str] = None


def _channels(outputs: Iterable[Output]) -> Iterator[_Channel]:
    for output in outputs:
        yield _Channel(output.of, output.topic, output.type, output.field, output.only)
        if output.status_topic is not None:
            yield _Channel("status", output.status_topic, output.status_type)


def picked(message: Any, channel: _Channel) -> Any:
    """Return what goes to a topic: the message, or the one value of it that is asked for.

    Raises:
        MessageError: there is no such value in the message.
    """
    if not channel.field:
        return message
    try:
        value = follow(message, channel.field)
    except (AttributeError, LookupError) as problem:
        raise MessageError(f"{channel.topic}: {problem}") from None
    return channel.type(data=value)


def beside(monitor: Any, name: str) -> Trees:
    """Return the message of that name that a monitor gives beside the result of a step.

    Raises:
        MessageError: it gives none of that name.
    """
    make = getattr(monitor, f"{name}_message", None)
    if make is None:
        raise MessageError(f"the monitor gives no message {name!r} in addition to its result")
    trees: Trees = make()
    return trees


def check_outputs(
    converter: Converter, result: Trees, monitor: Any, outputs: Iterable[Output]
) -> None:
    """Check that the messages of the workspace can carry what the monitor publishes.

    Args:
        converter: of the node.
        result: message tree of the result.
        monitor: gives the messages beside it.
        outputs: what the node publishes.

    Raises:
        MessageError: a message is unknown, has other fields, or is not the declared one.
    """
    for channel in _channels(outputs):
        built = converter.messages(beside(monitor, channel.of) if channel.of else result)
        for one in _each(built):
            sent = picked(one, channel)
            if not isinstance(sent, channel.type):
                declared, made = ros_type(channel.type), ros_type(sent)
                raise MessageError(f"{channel.topic} carries {declared}, the monitor makes {made}")


def _each(messages: Any) -> List[Any]:
    if messages is None:
        return []
    return messages if isinstance(messages, list) else [messages]


def check_serialises(message: Any) -> None:
    """Raise what rospy would raise once somebody listens; for messages made by hand."""
    if message is not None:
        message.serialize(BytesIO())


class Publications:
    """The publishers of one monitor: latched, with a queue, so that no subscriber can block.

    Args:
        outputs: what to publish.
        queue_size: messages that wait for a slow subscriber before old ones are dropped.
    """

    def __init__(self, outputs: Iterable[Output], queue_size: int) -> None:
        self._publishers: Dict[str, List[Tuple[_Channel, Any]]] = {}
        for channel in _channels(outputs):
            publisher = rospy.Publisher(
                channel.topic, channel.type, queue_size=queue_size, latch=True
            )
            self._publishers.setdefault(channel.of, []).append((channel, publisher))

    @property
    def beside(self) -> List[str]:
        """Names of the messages that somebody was promised beside the result."""
        return [name for name in self._publishers if name]

    def publish(self, message: Any, of: str = "") -> None:
        """Publish on every topic of the result, or of a message beside it.

        Args:
            message: a message, a list of them, or None.
            of: name of the message, empty for the result.
        """
        for channel, publisher in self._publishers.get(of, ()):
            for one in _each(message):
                if channel.only in (None, getattr(one, "id", None)):
                    publisher.publish(picked(one, channel))
