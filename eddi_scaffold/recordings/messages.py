"""What a monitor publishes in each step, and messages of ours without ROS.

They are checked field by field: a tree that does not fit its ``.msg`` file is refused, as a node
would refuse it.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass
from functools import cache
from types import SimpleNamespace
from typing import Any

from eddi_runtime import Monitor as RuntimeMonitor
from eddi_runtime.monitor import Tree
from eddi_runtime.plain_values import follow

from eddi_scaffold.config.field_paths import PlainStep, plain_step
from eddi_scaffold.config.field_types import element, is_primitive
from eddi_scaffold.monitors.binding import BoundMonitor
from eddi_scaffold.monitors.message_types import known_messages
from eddi_scaffold.monitors.publications import publications

Message = SimpleNamespace  # one attribute for each field, and `message_type`

_RANGES = {
    f"{sign}int{bits}": range(2**bits) if sign else range(-(2 ** (bits - 1)), 2 ** (bits - 1))
    for sign in ("", "u")
    for bits in (8, 16, 32, 64)
}
_HEADER = "std_msgs/Header"
_PLAIN_DEFAULTS: Mapping[str, Any] = {"bool": False, "string": "", "float32": 0.0, "float64": 0.0}


def blank(message_type: str) -> Message:
    """Return a message in which every field has the default of its type."""
    fields = known_messages()[message_type].items()
    return Message(message_type=message_type, **{name: _default(type_) for name, type_ in fields})


def _default(type_: str) -> Any:
    if type_.endswith("]"):
        return []
    return _PLAIN_DEFAULTS.get(type_, 0) if is_primitive(type_) else blank(type_)


@cache
def _fields(message_type: str) -> tuple[Mapping[str, str], Mapping[str, Message]]:
    """Return the types of the fields that a monitor fills, and its headers, which are empty."""
    types = known_messages()[message_type]
    headers = {name: blank(_HEADER) for name, type_ in types.items() if type_ == _HEADER}
    return {name: types[name] for name in types if name not in headers}, headers


def message_of(tree: Tree) -> Message:
    """Return a message of the product's own package.

    Raises:
        TypeError: a field is missing, surplus, or of a wrong type.
    """
    name, fields = tree
    message_type = f"eddi_messages/{name}"
    types, headers = _fields(message_type)
    if fields.keys() != types.keys():
        raise TypeError(f"{message_type} has {sorted(types)}, not {sorted(fields)}")
    content = {name: _checked(type_, fields[name]) for name, type_ in types.items()}
    return Message(**content, **headers, message_type=message_type)


def _checked(type_: str, value: Any) -> Any:
    """Return a value of a field as the message holds it."""
    if type_ in ("bool", "string"):
        fits = type(value) is (bool if type_ == "bool" else str)
    elif type_ in _RANGES:
        fits = type(value) is int and value in _RANGES[type_]
    elif type_ in _PLAIN_DEFAULTS:
        fits, value = type(value) in (int, float), float(value)
    elif (inner := element(type_)) is not None:
        fits = isinstance(value, list | tuple)
        value = [_checked(inner, item) for item in value]
    else:
        fits = isinstance(value, tuple) and f"eddi_messages/{value[0]}" == type_
        value = message_of(value)
    if not fits:
        raise TypeError(f"a field of type {type_} cannot be {value!r}")
    return value


@dataclass(frozen=True)
class Channel:
    """One topic of a monitor."""

    topic: str  # its full name
    of: str  # which message of the monitor: empty for the result, else an additional one
    only: str | None  # id of the one message of several that goes here
    path: Sequence[PlainStep]  # to the one value of the message that goes here, empty for all of it
    type: str  # of the message

    def picked(self, message: Message) -> Iterator[Message]:
        """Yield what goes to the topic; nothing where the message does not have the value."""
        if self.only not in (None, getattr(message, "id", None)):
            return
        if not self.path:
            yield message
            return
        with suppress(AttributeError, LookupError):
            yield Message(message_type=self.type, data=follow(message, self.path))


class Publications:
    """The topics of one monitor, which has a configuration without errors.

    Args:
        monitor: the monitor.
        full_name: topic as in the configuration -> its full name, if not that of the monitor.
    """

    def __init__(
        self, monitor: BoundMonitor, full_name: Callable[[str], str] | None = None
    ) -> None:
        assert monitor.config is not None
        full_name = full_name or monitor.topic
        outputs, problems = publications(monitor, monitor.config)
        assert not problems, problems
        self.channels = [
            Channel(
                full_name(publication.output.topic),
                publication.of,
                publication.output.event,
                [plain_step(step) for step in publication.path],
                publication.type,
            )
            for publication in outputs
        ]
        self.topics = frozenset(channel.topic for channel in self.channels)

    def messages(
        self, running: RuntimeMonitor[Any], output: Any, topics: Collection[str]
    ) -> list[tuple[str, Message]]:
        """Return topic and message of what a step publishes, on some topics."""
        by_message: dict[str, Sequence[Message]] = {}
        published: list[tuple[str, Message]] = []
        for channel in self.channels:
            if channel.topic not in topics:
                continue
            of = channel.of
            if of not in by_message:
                trees = getattr(running, f"{of}_message")() if of else running.message(output)
                trees = trees if isinstance(trees, list) else [] if trees is None else [trees]
                by_message[of] = [message_of(tree) for tree in trees]
            for message in by_message[of]:
                published += [(channel.topic, picked) for picked in channel.picked(message)]
        return published
