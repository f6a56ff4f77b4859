"""The topics of one monitor: which message, or which value of it, goes where."""

from typing import Any, Iterable, Iterator, List, NamedTuple, Optional, Tuple

from ..access import Step, follow
from .conversion import Converter, MessageError, Trees
from .topics import Output


class Channel(NamedTuple):
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
    field: Tuple[Step, ...] = ()
    only: Optional[str] = None


def channels(outputs: Iterable[Output]) -> Iterator[Channel]:
    """Yield the topics of outputs: each its own, and that of the facts behind it."""
    for output in outputs:
        yield Channel(output.of, output.topic, output.type, output.field, output.only)
        if output.status_topic is not None:
            yield Channel("status", output.status_topic, output.status_type)


def picked(message: object, channel: Channel) -> object:
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


def beside(monitor: object, name: str) -> Trees:
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
    converter: Converter, result: Trees, monitor: object, outputs: Iterable[Output]
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
    for channel in channels(outputs):
        built = converter.messages(beside(monitor, channel.of) if channel.of else result)
        for one in each(built):
            sent = picked(one, channel)
            if not isinstance(sent, channel.type):
                declared, made = converter.type_name(channel.type), converter.type_name(sent)
                raise MessageError(f"{channel.topic} carries {declared}, the monitor makes {made}")


def each(messages: object) -> List[object]:
    """Return what one step gives as a list."""
    if messages is None:
        return []
    return messages if isinstance(messages, list) else [messages]
