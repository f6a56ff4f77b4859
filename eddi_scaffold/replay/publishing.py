"""What a monitor publishes in each step, without ROS: its messages and their topics."""

from __future__ import annotations

from collections.abc import Callable, Collection, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from eddi_runtime.access import follow

from eddi_scaffold.config.fields import PlainStep, plain_step
from eddi_scaffold.monitors.binding import BoundMonitor
from eddi_scaffold.monitors.publications import publications
from eddi_scaffold.replay.message_trees import Message, message_of

if TYPE_CHECKING:
    from eddi_runtime import Monitor as RuntimeMonitor


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
        return frozenset(one.topic for one in self.channels)

    def messages(
        self, running: RuntimeMonitor[Any], output: Any, wanted: Collection[str]
    ) -> list[tuple[str, Message]]:
        """Return topic and message of all that a step publishes on the wanted topics."""
        made: dict[str, Sequence[Message]] = {}
        published: list[tuple[str, Message]] = []
        for one in self.channels:
            if one.topic not in wanted:
                continue
            if one.of not in made:
                made[one.of] = _make_messages(running, output, one.of)
            fitting = [m for m in made[one.of] if one.only in (None, getattr(m, "id", None))]
            published += [(one.topic, picked) for m in fitting for picked in _picked(m, one)]
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
