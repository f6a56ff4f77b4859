"""Bags of ROS 1 and ROS 2 as inputs of monitors: the messages that their nodes would have received.

Needs the extra ``bags`` (rosbags), and no ROS.
"""

from __future__ import annotations

import itertools
from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from contextlib import closing, contextmanager
from dataclasses import dataclass
from functools import partial
from operator import attrgetter
from pathlib import Path
from typing import Any

from eddi_scaffold.common.files import NotRegularError, note_input, open_regular
from eddi_scaffold.common.identifiers import full_topic, is_ros_name
from eddi_scaffold.common.problems import (
    EddiError,
    Place,
    Problem,
    has_errors,
    most_similar,
    problem,
)
from eddi_scaffold.config.message_types import MessageFields, ros2_fields
from eddi_scaffold.config.schema import SimulatorOutput
from eddi_scaffold.kinds import kinds
from eddi_scaffold.monitors.binding import BoundMonitor, known_types
from eddi_scaffold.monitors.publications import MESSAGE_PACKAGE
from eddi_scaffold.recordings.bag_files import check_fields, tables
from eddi_scaffold.recordings.csv_recording import Sample, Tape

_absolute = partial(full_topic, namespace="", package="")
"""A bag has no private names."""

_NO_SENSORS = (MESSAGE_PACKAGE, "rosgraph_msgs", "rcl_interfaces")
"""Packages of the messages that monitors publish, and those of ROS about itself."""
_MOST_HINTS = 20
"""Topics that near ones are looked for: to compare texts is slow."""


@dataclass(frozen=True)
class _Wanted:
    """A topic that a monitor listens to."""

    monitor: BoundMonitor
    source: SimulatorOutput


def read_bag(
    path: Path, monitors: Sequence[BoundMonitor], own: Collection[str] = ()
) -> tuple[Tape, list[Problem]]:
    """Read the messages that monitors listen to.

    Times are nanoseconds since the first message of the bag, of any topic.

    Args:
        path: a ROS 1 bag, or the folder (or single `.mcap` file) of a ROS 2 bag.
        monitors: they have configurations.
        own: topics that one of the monitors publishes itself: what was recorded of them is not
            played.

    Returns:
        The messages, and warnings.

    Raises:
        EddiError: rosbags is not installed (I010), the bag cannot be read (I011), holds a topic
            with another type than in a configuration (I012), or messages without a field that
            an input needs (I012).
    """
    place = Place(str(path))
    wanted = _wanted(monitors)
    outside = {topic: of for topic, of in wanted.items() if topic not in own}
    with opened(path, monitors) as reader:
        found = [
            connection
            for connection in reader.connections
            if _absolute(connection.topic) in outside
        ]
        _refuse(_wrong_types(found, outside))
        known = _tables(reader, found)
        there = {_absolute(one.topic) for one in found}
        _refuse(p for monitor in monitors for p in check_fields(monitor, known, there))
        for one in found:
            _name_times_as_rospy(reader.types(one).types)
        start = _start(reader)
        samples = tuple(
            Sample(t - start, _absolute(one.topic), reader.deserialize(one, data))
            for one, t, data in reader.messages(found)
            if t >= start
        )
        strange = _strange_times(place, samples, is_cut=start != reader.start_time)
        twice = {_absolute(connection.topic) for connection in reader.connections} & (
            wanted.keys() - outside
        )
        end = max(0, reader.end_time - start - 1)  # rosbags ends behind the last message
        tape = Tape(0, end, samples)
        topics = {
            _absolute(connection.topic): connection.msgtype.replace("/msg/", "/")
            for connection in reader.connections
            if connection.msgcount
        }
        return tape, [*_absent(place, topics, outside), *_computed(place, twice), *strange]


_SET_CLOCK_NS = 10**18
"""Since 2001 the clock of a computer that has been set is beyond this."""
_BACK_NS = 10**9
"""Stamps of several publishers of a topic may be out of order by less."""


def _start(bag: Any) -> int:
    """Return when a recording begins: not at a time stamp 0 from before a clock was set."""
    if bag.start_time == 0 and bag.end_time > _SET_CLOCK_NS:
        return next((t for _, t, _ in bag.messages(bag.connections) if t), 0)
    return int(bag.start_time)


def _strange_times(place: Place, samples: Sequence[Sample], *, is_cut: bool) -> Iterator[Problem]:
    """Warn of a first message without a time, and of topics whose stamps jump back."""
    if is_cut:
        yield problem("I011.first_stamp", place)
    latest: dict[str, int] = {}
    back: dict[str, None] = {}
    for sample in samples:
        made = _stamp(sample.message)
        if made:
            if made < latest.get(sample.topic, made) - _BACK_NS:
                back[sample.topic] = None
            latest[sample.topic] = made
    if back:
        yield problem("I011.jump", place, topic=", ".join(back))


def _stamp(message: Any) -> int:
    """Return when a message says that it was made, 0 where it does not."""
    stamp: Any = getattr(getattr(message, "header", message), "stamp", None)
    stamp = getattr(message, "clock", stamp)
    return int(stamp.sec) * 10**9 + int(stamp.nanosec) if hasattr(stamp, "nanosec") else 0


def _tables(bag: Any, connections: Iterable[Any]) -> MessageFields:
    """Return message type -> its fields, of the definitions of some channels."""
    return tables(
        {k: v for connection in connections for k, v in bag.types(connection).fielddefs.items()}
    )


@dataclass(frozen=True)
class Contents:
    """What a bag tells of a robot.

    Attributes:
        topics: full name -> type, of those that are not the monitors' own.
        types: message type -> fields.
        times: full name of a topic -> when its messages were recorded, in nanoseconds, ascending.
    """

    topics: Mapping[str, str]
    types: MessageFields
    times: Mapping[str, Sequence[int]]


def read_contents(path: Path) -> Contents:
    """Return topics, types and times of a bag.

    Raises:
        EddiError: rosbags is not installed (I010), or the bag cannot be read (I011).
    """
    times: dict[str, list[int]] = {}
    topics: dict[str, str] = {}
    with opened(path) as reader:
        known = [
            one
            for one in reader.connections
            if is_ros_name(_absolute(one.topic)) and _is_known(reader, one)
        ]
        for connection, t, _ in reader.messages(known):
            topic, of = _absolute(connection.topic), connection.msgtype.replace("/msg/", "/")
            times.setdefault(topic, []).append(t)
            if of.partition("/")[0] not in _NO_SENSORS:
                topics[topic] = of
        types = _tables(reader, known)
    return Contents(topics, types, {topic: sorted(time) for topic, time in times.items()})


def _is_known(bag: Any, connection: Any) -> bool:
    """Return whether the messages of a channel can be read: one that cannot fills no input."""
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
    _refuse_special(path, place)
    advice: str | None = f"was the recording cut off? {_repair(path)} saves what is there"
    try:
        with closing(Bag(path, _own_messages(monitors))) as bag:
            advice = None
            yield bag
    except EddiError:
        raise
    except Exception as failed:  # noqa: BLE001 - a damaged bag makes rosbags raise anything
        reason = " ".join(str(failed).split()) or type(failed).__name__
        if isinstance(failed, UnicodeDecodeError):
            reason = "it is damaged, or something else under the name of one"
        raise EddiError(problem("I011.content", place, hint=advice, reason=reason)) from None


def _repair(path: Path) -> str:
    """Return the command that makes a bag of one that was cut off."""
    if path.suffix == ".bag":
        return f"`rosbag reindex {path}`"
    inside = path.glob("*.mcap") if path.is_dir() else [path]
    file = next((one for one in inside if one.suffix == ".mcap"), None)
    return f"`mcap recover {file} -o saved.mcap`" if file else f"`ros2 bag reindex {path}`"


def _own_messages(monitors: Sequence[BoundMonitor]) -> Mapping[str, str]:
    """Return the texts of our messages, and of those that configurations define."""
    own = (item for kind in kinds().values() for item in kind.all_messages.items())
    texts = {f"{MESSAGE_PACKAGE}/{name}": text for name, text in own}
    for monitor in monitors:
        for name, fields in known_types(monitor.config, {}).items():
            texts[name] = "\n".join(f"{of} {field}" for field, of in ros2_fields(fields).items())
    return texts


def _wanted(monitors: Sequence[BoundMonitor]) -> Mapping[str, Sequence[_Wanted]]:
    """Return full name of a topic -> who listens to it."""
    found: dict[str, list[_Wanted]] = {}
    for monitor in monitors:
        sources = {
            requirement.id: requirement
            for binding in monitor.inputs
            for requirement in binding.requires
        }
        for source in sources.values():
            found.setdefault(monitor.topic(source.topic), []).append(_Wanted(monitor, source))
    return found


def _refuse_special(path: Path, place: Place) -> None:
    """Refuse what would let rosbags wait or read for ever; it reports all other faults."""
    try:
        for one in path.iterdir() if path.is_dir() else [path]:
            with open_regular(one) as stream:
                note_input(stream.fileno())
    except (NotRegularError, FileNotFoundError) as special:
        raise EddiError(problem("I011.system", place, reason=special.strerror)) from None
    except OSError:
        pass


def _refuse(problems: Iterable[Problem]) -> None:
    found = list(problems)
    if has_errors(found):
        raise EddiError(*found)


def _name_times_as_rospy(types: Mapping[str, Any]) -> None:
    """Let the parts of a time be called as a node knows them, beside what rosbags calls them."""
    for name in ("Time", "Duration"):
        of = types.get(f"builtin_interfaces/msg/{name}")
        if of is not None:
            of.secs, of.nsecs = property(attrgetter("sec")), property(attrgetter("nanosec"))


def _absent(
    place: Place, topics: Mapping[str, str], wanted: Mapping[str, Sequence[_Wanted]]
) -> list[Problem]:
    """Warn of topics without a message (I004), with the near ones, of the same type if there are.

    Args:
        place: of the bag.
        topics: full name -> type, of those with messages.
        wanted: full name -> who listens.
    """
    lacking = {topic: of[0].source for topic, of in wanted.items() if topic not in topics}
    if not lacking:
        return [problem("I004.all_topics", place)]
    hints = []
    for topic, source in itertools.islice(lacking.items(), _MOST_HINTS):
        alike = [name for name, of in topics.items() if of == source.type]
        near = most_similar(topic, alike) or most_similar(topic, topics)
        hints += [f"the bag has {near} ({topics[near]})"] if near else []
    return [
        problem(
            "I004.no_message",
            place,
            hint=", ".join(dict.fromkeys(hints)) or None,
            lacking=", ".join(one.topic for one in lacking.values()),
        )
    ]


def _computed(place: Place, topics: Collection[str]) -> list[Problem]:
    """Report which topics are not taken from the bag (I003)."""
    if not topics:
        return []
    return [problem("I003.published", place, topics=", ".join(sorted(topics)))]


def _wrong_types(
    connections: Sequence[Any], wanted: Mapping[str, Sequence[_Wanted]]
) -> Iterator[Problem]:
    for connection in connections:
        of = connection.msgtype.replace("/msg/", "/")
        for one in wanted[_absolute(connection.topic)]:
            source, config = one.source, one.monitor.config
            if of != source.type and config is not None:
                index = config.config.SimulatorOutputs.index(source)
                place = config.place("SimulatorOutputs", index, "type")
                yield problem("I012.type", place, topic=source.topic, type=of, declared=source.type)


def written_by_hand(monitor: BoundMonitor) -> list[str]:
    """Return the inputs whose values only code of a person gives: they stay unknown here."""
    return [input_.model.id for input_ in monitor.inputs if input_.requires and not input_.is_given]
