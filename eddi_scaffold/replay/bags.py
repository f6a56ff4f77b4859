"""ROS 1 bags as inputs of a monitor: the messages that its node would have received.

Needs the extra ``bags`` (rosbags), and no ROS.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from eddi_scaffold.config.file import ConfigFile
from eddi_scaffold.config.schema import SimulatorOutput
from eddi_scaffold.monitors.binding import Monitor
from eddi_scaffold.problems import EddiError, Place, Problem, did_you_mean, error, warning
from eddi_scaffold.regions.files import NotRegularError, open_regular
from eddi_scaffold.replay.node import Node, Received
from eddi_scaffold.replay.recordings import Frame

if TYPE_CHECKING:
    from eddi_runtime import Monitor as RuntimeMonitor


@dataclass(frozen=True)
class Bag:
    """What a monitor's node would have received from a bag.

    Attributes:
        messages: their times are nanoseconds since the first message of the bag, of any topic.
        end: nanoseconds from the first to the last message of the bag, of any topic.
    """

    messages: tuple[Received, ...]
    end: int


def read_bag(path: Path, config: ConfigFile, wanted: Sequence[SimulatorOutput]) -> Bag:
    """Read the messages of some topics.

    Args:
        path: a ROS 1 bag.
        config: for places.
        wanted: the simulator outputs that inputs require.

    Raises:
        EddiError: rosbags is not installed (I010), the bag cannot be read (I011), or holds a topic
            with another type than the configuration says (I012).
    """
    try:
        from rosbags.highlevel import AnyReader  # noqa: PLC0415 - an extra
        from rosbags.typesys import Stores, get_typestore  # noqa: PLC0415 - an extra
    except ImportError:
        hint = "pip install 'eddi-scaffold[bags]'"
        raise EddiError(error("I010", "rosbags is not installed", hint=hint)) from None
    place = Place(str(path))
    _refuse_special(path, place)
    try:
        store = get_typestore(Stores.ROS1_NOETIC)
        with AnyReader([path], default_typestore=store) as reader:
            by_topic: dict[str, list[SimulatorOutput]] = defaultdict(list)
            for source in wanted:
                by_topic[absolute(source.topic)].append(source)
            found = [one for one in reader.connections if absolute(one.topic) in by_topic]
            _refuse(_wrong_types(found, by_topic, config))
            start = reader.start_time
            messages = tuple(
                Received(t - start, source.id, reader.deserialize(data, connection.msgtype))
                for connection, t, data in reader.messages(found)
                for source in by_topic[absolute(connection.topic)]
            )
            return Bag(messages, reader.end_time - start)
    except EddiError:
        raise
    except Exception as failed:  # noqa: BLE001 - a damaged bag makes rosbags raise anything
        reason = " ".join(str(failed).split()) or type(failed).__name__
        raise EddiError(error("I011", f"cannot read the bag: {reason}", place)) from None


def _refuse_special(path: Path, place: Place) -> None:
    """Refuse what would let rosbags wait or read for ever; what else is wrong, it says itself."""
    try:
        open_regular(path).close()
    except NotRegularError as special:
        raise EddiError(error("I011", f"cannot read the bag: {special.strerror}", place)) from None
    except OSError:
        pass


def _refuse(problems: Iterable[Problem]) -> None:
    found = list(problems)
    if found:
        raise EddiError(*found)


def absent(path: Path, bag: Bag, wanted: Sequence[SimulatorOutput]) -> Problem:
    """Return a warning for the topics without a message in the bag (I013); info when none lacks."""
    there = {one.source for one in bag.messages}
    lacking = [source.topic for source in wanted if source.id not in there]
    message = (
        f"no message of {', '.join(lacking)} in the bag" if lacking else "every topic is there"
    )
    level = warning if lacking else _quiet
    return level("I013", message, Place(str(path)))


def _quiet(code: str, message: str, place: Place) -> Problem:
    return Problem("info", code, message, place)


def absolute(topic: str) -> str:
    """Return a topic as it stands in a bag."""
    return topic if topic.startswith("/") else f"/{topic.lstrip('~/')}"


def _wrong_types(
    connections: Sequence[Any], by_topic: Mapping[str, list[SimulatorOutput]], config: ConfigFile
) -> Iterator[Problem]:
    for connection in connections:
        of = connection.msgtype.replace("/msg/", "/")
        for source in by_topic[absolute(connection.topic)]:
            if of != source.type:
                message = (
                    f"{source.topic} is a {of} in the bag, the configuration says {source.type}"
                )
                index = config.config.SimulatorOutputs.index(source)
                place = config.place("SimulatorOutputs", index, "type")
                yield error("I012", message, place, did_you_mean(of, [source.type]))


def written_by_hand(monitor: Monitor) -> list[str]:
    """Return the inputs whose values only code of a person gives: they stay unknown here."""
    return [one.model.id for one in monitor.inputs if one.requires and not one.is_given]


def frames_of(monitor: Monitor, running: RuntimeMonitor, bag: Bag) -> Iterator[Frame]:
    """Yield the steps of the node: one per period, or in mode ``on_change`` one per message, too.

    Messages that came at the same time count as one change.
    """
    assert monitor.config is not None
    section = monitor.config.config.Model
    running.reset()
    node = Node(monitor.inputs, running)
    for t, messages in _instants(bag, 1e9 / section.frequency, section.mode == "on_change"):
        yield node.step(t, messages)


def _instants(bag: Bag, period: float, on_change: bool) -> Iterator[tuple[int, Sequence[Received]]]:
    """Yield the times of steps with the messages since the last one."""
    waiting = 0
    step = 1
    due = period
    times = sorted({one.t for one in bag.messages}) if on_change else []
    position = 0
    while True:
        change = times[position] if position < len(times) else None
        t = round(due) if change is None or due <= change else change
        if t > bag.end:
            return
        if change is not None and t >= change:
            position += 1
        fresh = waiting
        while waiting < len(bag.messages) and bag.messages[waiting].t <= t:
            waiting += 1
        yield t, bag.messages[fresh:waiting]
        step += 1
        due = t + period if on_change else step * period
