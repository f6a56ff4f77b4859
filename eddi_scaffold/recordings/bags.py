"""Bags of ROS 1 and ROS 2 as inputs of monitors: the messages that their nodes would have received.

Needs the extra ``bags`` (rosbags), and no ROS.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import closing, contextmanager
from dataclasses import dataclass
from operator import attrgetter
from pathlib import Path
from typing import Any

from eddi_scaffold.common.files import NotRegularError, note_input, open_regular
from eddi_scaffold.common.identifiers import full_topic, is_ros_name
from eddi_scaffold.common.problems import (
    EddiError,
    Place,
    Problem,
    problem,
)
from eddi_scaffold.config.field_types import EITHER_TIMES, TIMES, Fields, MessageFields
from eddi_scaffold.config.schema import SimulatorOutput
from eddi_scaffold.kinds import texts_of_messages
from eddi_scaffold.monitors.binding import BoundMonitor, bound_to, known_types
from eddi_scaffold.monitors.message_types import known_messages, ros2_fields
from eddi_scaffold.monitors.publications import MESSAGE_PACKAGE
from eddi_scaffold.recordings.csv_recording import Recording, Sample
from eddi_scaffold.recordings.members import Member, published

_NO_SENSORS = (MESSAGE_PACKAGE, "rosgraph_msgs", "rcl_interfaces")
"""Packages of the messages that monitors publish, and those of ROS about itself."""
_SET_CLOCK_NS = 10**18  # since 2001 the clock of a computer that has been set is beyond this
_TIMES = {"builtin_interfaces/Time": "time", "builtin_interfaces/Duration": "duration"}


def topic_of(connection: Any) -> str:
    """Return the full name of a topic: a bag has no private names."""
    return full_topic(connection.topic, namespace="", package="")


def type_of(connection: Any) -> str:
    """Return the type of the messages of a connection as ``package/Name``."""
    return str(connection.msgtype).replace("/msg/", "/")


def read_bag(path: Path, members: Sequence[Member]) -> tuple[Recording, list[Problem]]:
    """Read the messages that monitors listen to; not those that one of them publishes itself.

    Times are nanoseconds since the first message of the bag, of any topic.

    Args:
        path: a ROS 1 bag, or the folder (or single `.mcap` file) of a ROS 2 bag.
        members: they have configurations.

    Returns:
        The messages, and warnings.

    Raises:
        EddiError: rosbags is not installed (I010), the bag cannot be read (I011), holds a topic
            with another type than in a configuration (I012), or messages without a field that
            an input needs (I012).
    """
    place = Place(str(path))
    listeners: dict[str, list[tuple[BoundMonitor, SimulatorOutput]]] = {}
    for member in members:
        requirements = (r for binding in member.monitor.inputs for r in binding.requires)
        for source in {requirement.id: requirement for requirement in requirements}.values():
            listeners.setdefault(member.topic(source.topic), []).append((member.monitor, source))
    own = published(members)
    outside = {topic: who for topic, who in listeners.items() if topic not in own}
    with opened(path, [member.monitor for member in members]) as bag:
        connections = [c for c in bag.connections if topic_of(c) in outside]
        types = _types_of(bag, connections)
        errors = []
        for connection in connections:
            type_ = type_of(connection)
            for monitor, source in outside[topic_of(connection)]:
                if type_ != source.type and monitor.config is not None:
                    index = monitor.config.config.SimulatorOutputs.index(source)
                    at = monitor.config.place("SimulatorOutputs", index, "type")
                    fields = {"topic": source.topic, "type": type_, "declared": source.type}
                    errors.append(problem("I012.type", at, **fields))
        for member in members:
            if member.code is None:  # which tells itself what it lacks
                errors += _misfits(member.monitor, types)
        if errors:
            raise EddiError(*errors)
        for connection in connections:
            _name_times_as_rospy(bag.types(connection).types)
        start = int(bag.start_time)
        if start == 0 and bag.end_time > _SET_CLOCK_NS:  # from before a clock was set
            start = next((t for _, t, _ in bag.messages(bag.connections) if t), 0)
        samples = tuple(
            Sample(t - start, topic_of(connection), bag.deserialize(connection, data))
            for connection, t, data in bag.messages(connections)
            if t >= start
        )
        recorded = {topic_of(c) for c in bag.connections if c.msgcount}
        lacking = ", ".join(topic for topic in outside if topic not in recorded)
        warnings = [problem("I004.no_message", place, lacking=lacking)] if lacking else []
        computed = {topic_of(c) for c in bag.connections} & own & listeners.keys()
        if computed:
            warnings.append(problem("I003.published", place, topics=", ".join(sorted(computed))))
        if start != bag.start_time:
            warnings.append(problem("I011.first_stamp", place))
        end = max(0, bag.end_time - start - 1)  # rosbags ends behind the last message
        return Recording(0, end, samples), warnings


@dataclass(frozen=True)
class Contents:
    """What a bag tells of a robot."""

    topics: Mapping[str, str]  # full name -> type, of those that are not the monitors' own
    types: MessageFields  # message type -> fields
    # full name of a topic -> when its messages were recorded, in nanoseconds, ascending
    times: Mapping[str, Sequence[int]]


def read_contents(path: Path) -> Contents:
    """Return topics, types and times of a bag.

    Raises:
        EddiError: rosbags is not installed (I010), or the bag cannot be read (I011).
    """
    times: dict[str, list[int]] = {}
    topics: dict[str, str] = {}
    with opened(path) as bag:
        readable = [c for c in bag.connections if is_ros_name(topic_of(c)) and _is_readable(bag, c)]
        for connection, t, _ in bag.messages(readable):
            topic, type_ = topic_of(connection), type_of(connection)
            times.setdefault(topic, []).append(t)
            if type_.partition("/")[0] not in _NO_SENSORS:
                topics[topic] = type_
        types = _types_of(bag, readable)
    return Contents(topics, types, {topic: sorted(time) for topic, time in times.items()})


def _is_readable(bag: Any, connection: Any) -> bool:
    try:
        bag.types(connection)
    except Exception:  # noqa: BLE001 - a damaged definition makes rosbags raise anything
        return False
    return True


@contextmanager
def opened(path: Path, monitors: Sequence[BoundMonitor] = ()) -> Iterator[Any]:
    """Open a bag; whatever is wrong with it while it is read is a problem.

    Up to Humble, bags in SQLite have no definitions of messages: the configurations have them.

    Raises:
        EddiError: rosbags is not installed (I010), or the bag cannot be read (I011).
    """
    try:
        from eddi_scaffold.recordings.bag_files import Bag  # noqa: PLC0415 - an extra
    except ImportError:
        raise EddiError(problem("I010.rosbags")) from None
    place = Place(str(path))
    try:  # refuse what would let rosbags wait or read for ever; it reports all other faults
        for file in path.iterdir() if path.is_dir() else [path]:
            with open_regular(file) as stream:
                note_input(stream.fileno())
    except (NotRegularError, FileNotFoundError) as special:
        raise EddiError(problem("I011.system", place, reason=special.strerror)) from None
    except OSError:
        pass
    try:
        with closing(Bag(path, own_messages(monitors))) as bag:
            yield bag
    except EddiError:
        raise
    except Exception as failed:  # noqa: BLE001 - a damaged bag makes rosbags raise anything
        reason = " ".join(str(failed).split()) or type(failed).__name__
        raise EddiError(problem("I011.content", place, reason=reason)) from None


def own_messages(monitors: Sequence[BoundMonitor]) -> Mapping[str, str]:
    """Return the texts of our messages, and of those that configurations define."""
    texts = {f"{MESSAGE_PACKAGE}/{name}": text for name, text in texts_of_messages().items()}
    for monitor in monitors:
        for name, fields in known_types(monitor.config, {}).items():
            texts[name] = "\n".join(f"{of} {field}" for field, of in ros2_fields(fields).items())
    return texts


def _types_of(bag: Any, connections: Iterable[Any]) -> MessageFields:
    """Return message type -> its fields, of the definitions of some channels."""
    types: dict[str, Fields] = {}
    for connection in connections:
        for name, (_, fields) in bag.types(connection).fielddefs.items():
            types[name.replace("/msg/", "/")] = {field: _type(*of) for field, of in fields}
    return {**types, **TIMES}


def _type(node: Any, content: Any) -> str:
    """Return a type in the words of ``.msg`` files."""
    if node.name == "BASE":
        return str(content[0])
    if node.name == "NAME":
        name = str(content).replace("/msg/", "/")
        return _TIMES.get(name, name)
    inner, size = content  # an array or a sequence
    return f"{_type(*inner)}[{size if node.name == 'ARRAY' else ''}]"


def _misfits(monitor: BoundMonitor, types: MessageFields) -> Iterator[Problem]:
    """Report fields that messages in the bag do not have, or not of that type (I012)."""
    assert monitor.config is not None
    known = known_types(monitor.config, {**known_messages(), **EITHER_TIMES})
    rebound, errors = bound_to(monitor, {**known, **types, **EITHER_TIMES})
    for error in errors:
        yield problem("I012.value", error.place, hint=error.hint, problem=error.message)
    ids = [entry.id for entry in monitor.config.config.EDDIInputs]
    for binding, other in zip(monitor.inputs, rebound.inputs, strict=True):
        if binding.expression != other.expression and not errors:
            place = monitor.config.place("EDDIInputs", ids.index(binding.model.id))
            reason = f"the messages have no such field for the input {binding.model.id}"
            yield problem("I012.value", place, problem=reason)


def _name_times_as_rospy(types: Mapping[str, Any]) -> None:
    """Let the parts of a time be called as a node knows them, besides what rosbags calls them."""
    for name in ("Time", "Duration"):
        time = types.get(f"builtin_interfaces/msg/{name}")
        if time is not None:
            time.secs, time.nsecs = property(attrgetter("sec")), property(attrgetter("nanosec"))
