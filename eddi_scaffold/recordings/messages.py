"""What a monitor publishes in each step, and messages of ours without ROS.

They are checked field by field: a tree that does not fit its ``.msg`` file is refused, as a node
would refuse it.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from types import SimpleNamespace
from typing import TYPE_CHECKING, Any

from eddi_runtime.monitor import Tree
from eddi_runtime.plain_values import follow

from eddi_scaffold.config.field_paths import PlainStep, plain_step
from eddi_scaffold.config.message_types import Fields, element, is_primitive, known_messages
from eddi_scaffold.monitors.binding import BoundMonitor
from eddi_scaffold.monitors.publications import publications

if TYPE_CHECKING:
    from eddi_runtime import Monitor as RuntimeMonitor


Message = SimpleNamespace
"""One attribute for each field, and ``message_type``."""

_RANGES = {
    f"{sign}int{bits}": range(2**bits) if sign else range(-(2 ** (bits - 1)), 2 ** (bits - 1))
    for sign in ("", "u")
    for bits in (8, 16, 32, 64)
}
_HEADER = "std_msgs/Header"
_PLAIN_DEFAULTS: Mapping[str, Any] = {"bool": False, "string": "", "float32": 0.0, "float64": 0.0}


def message_of(tree: Tree) -> Message:
    """Return a message of the product's own package.

    Raises:
        TypeError: a field is missing, surplus, or of a wrong type.
    """
    name, fields = tree
    return _built(f"eddi_messages/{name}")(fields)


def blank(message_type: str) -> Message:
    """Return a message in which every field has the default of its type."""
    of = known_messages()[message_type]
    return Message(message_type=message_type, **{name: _blank(kind) for name, kind in of.items()})


def _blank(kind: str) -> Any:
    if kind.endswith("]"):
        return []
    if is_primitive(kind):
        return _PLAIN_DEFAULTS.get(kind, 0)
    return blank(kind)


@cache
def _built(message_type: str) -> Callable[[Mapping[str, Any]], Message]:
    of: Fields = known_messages()[message_type]
    checks = {
        name: _check(f"{message_type}.{name}", kind) for name, kind in of.items() if kind != _HEADER
    }
    rest: dict[str, Any] = {name: blank(_HEADER) for name, kind in of.items() if kind == _HEADER}
    rest["message_type"] = message_type

    def build(fields: Mapping[str, Any]) -> Message:
        if fields.keys() != checks.keys():
            raise TypeError(f"{message_type} has {sorted(checks)}, not {sorted(fields)}")
        checked = {name: check(fields[name]) for name, check in checks.items()}
        return Message(**checked, **rest)

    return build


def _check(where: str, kind: str) -> Callable[[Any], Any]:
    """Return what checks a value of a field and returns it as the message holds it."""
    inner = element(kind)
    if inner is not None:
        one = _check(where, inner)
        return lambda value: [
            one(item) for item in _fitting(isinstance(value, list | tuple), where, value)
        ]
    if kind == "bool":
        return lambda value: _fitting(type(value) is bool, where, value)
    if kind == "string":
        return lambda value: _fitting(type(value) is str, where, value)
    if kind in _RANGES:
        return lambda value: _fitting(type(value) is int and value in _RANGES[kind], where, value)
    if kind in _PLAIN_DEFAULTS:
        return lambda value: float(_fitting(type(value) in (int, float), where, value))
    return lambda value: _nested(where, kind, value)


def _fitting(fits: bool, where: str, value: Any) -> Any:
    if not fits:
        raise TypeError(f"{where} cannot be {value!r}")
    return value


def _nested(where: str, kind: str, value: Any) -> Message:
    _fitting(isinstance(value, tuple) and f"eddi_messages/{value[0]}" == kind, where, value)
    return message_of(value)


@dataclass(frozen=True)
class Channel:
    """One topic of a monitor.

    Attributes:
        topic: its full name.
        of: which message of the monitor: empty for the result, else an additional one.
        only: id of the one message of several that goes here.
        path: to the one value of the message that goes here, empty for all of it.
        type: of the message.
    """

    topic: str
    of: str
    only: str | None
    path: Sequence[PlainStep]
    type: str


class Publications:
    """The topics of one monitor.

    Attributes:
        channels: its topics.

    Args:
        monitor: it has a configuration, without errors.
        full_name: topic as in the configuration -> its full name.
    """

    def __init__(self, monitor: BoundMonitor, full_name: Callable[[str], str]) -> None:
        assert monitor.config is not None
        found, problems = publications(monitor, monitor.config)
        assert not problems, problems
        self.channels = [
            Channel(
                full_name(one.output.topic),
                one.of,
                one.output.event,
                [plain_step(step) for step in one.path],
                one.type,
            )
            for one in found
        ]

    @property
    def topics(self) -> frozenset[str]:
        """The full names of its topics."""
        return frozenset(channel.topic for channel in self.channels)

    def messages(
        self, running: RuntimeMonitor[Any], output: Any, wanted: Collection[str]
    ) -> list[tuple[str, Message]]:
        """Return topic and message of all that a step publishes on the wanted topics."""
        made: dict[str, Sequence[Message]] = {}
        published: list[tuple[str, Message]] = []
        for channel in self.channels:
            if channel.topic not in wanted:
                continue
            if channel.of not in made:
                made[channel.of] = _make_messages(running, output, channel.of)
            fitting = [
                m for m in made[channel.of] if channel.only in (None, getattr(m, "id", None))
            ]
            published += [
                (channel.topic, picked) for m in fitting for picked in _picked(m, channel)
            ]
        return published


def _make_messages(running: RuntimeMonitor[Any], output: Any, of: str) -> Sequence[Message]:
    """Return the result of a step, or one of its additional messages, as messages."""
    trees = getattr(running, f"{of}_message")() if of else running.message(output)
    listed = trees if isinstance(trees, list) else [] if trees is None else [trees]
    return [message_of(tree) for tree in listed]


def _picked(message: Message, channel: Channel) -> list[Message]:
    """Return what goes to a topic; nothing where the message does not have the value."""
    if not channel.path:
        return [message]
    try:
        value = follow(message, channel.path)
    except (AttributeError, LookupError):
        return []
    return [Message(message_type=channel.type, data=value)]
