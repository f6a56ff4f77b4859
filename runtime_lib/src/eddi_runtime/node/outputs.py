"""What a node publishes: which message of a monitor, or which value of it, goes to which topic."""

from typing import (
    Any,
    Callable,
    Dict,
    Iterable,
    Iterator,
    List,
    Mapping,
    NamedTuple,
    Optional,
    Tuple,
    Union,
)

from ..access import Step, follow
from .conversion import Converter, MessageError, Trees


class Output(NamedTuple):
    """One publication: an ``EDDIOutputs`` entry of eddi_config.yml.

    Attributes:
        id: name of the output, for people.
        topic: name of the message's topic.
        type: message class of the transport.
        status_topic: topic of the facts behind the result, ``None`` for none.
        status_type: its message class (with a header), ``None`` for none.
        field: place of the value that is published alone, as ``data`` of a message of
            std_msgs: names of fields, positions and ``("id", id)``; empty: the whole message.
        only: id of the one message, of several in a step, that goes here; ``None``: all.
        of: which message of the monitor: empty for the result, else the name of one beside it
            (``evidence``), which the monitor's ``evidence_message()`` gives.
        qos: as of an input.
    """

    id: str
    topic: str
    type: Any
    status_topic: Optional[str] = None
    status_type: Any = None
    field: Tuple[Step, ...] = ()
    only: Optional[str] = None
    of: str = ""
    qos: Mapping[str, Union[str, float]] = {}


Publish = Callable[[object], None]
"""Sends one message to one topic."""


class Publications:
    """The topics of one monitor.

    Args:
        outputs: what to publish.
        advertise: returns what sends to a topic.
    """

    def __init__(self, outputs: Iterable[Output], advertise: Callable[[Output], Publish]) -> None:
        self._topics: Dict[str, List[Tuple[Output, Publish]]] = {}
        for channel in channels(outputs):
            self._topics.setdefault(channel.of, []).append((channel, advertise(channel)))

    @property
    def beside(self) -> List[str]:
        """Names of the messages that somebody was promised beside the result."""
        return [name for name in self._topics if name]

    def publish(self, message: object, of: str = "") -> None:
        """Publish on every topic of the result, or of a message beside it.

        Args:
            message: a message, a list of them, or None.
            of: name of the message, empty for the result.
        """
        for channel, publish in self._topics.get(of, ()):
            for one in each(message):
                if channel.only in (None, getattr(one, "id", None)):
                    publish(picked(one, channel))


def channels(outputs: Iterable[Output]) -> Iterator[Output]:
    """Yield one output for each topic: its own, and that of the facts behind it."""
    for one in outputs:
        yield one
        if one.status_topic is not None:
            yield Output(one.id, one.status_topic, one.status_type, of="status", qos=one.qos)


def picked(message: object, channel: Output) -> object:
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
