"""What the monitors of the warehouse robot publish: messages, and a bag of two robots."""

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any

from eddi_scaffold.kinds import kinds
from eddi_scaffold.monitors.message_types import known_messages
from eddi_scaffold.packages.assembly import monitors_of
from eddi_scaffold.platforms import chosen  # noqa: F401 - loads what commands load
from eddi_scaffold.recordings.bags import read_bag
from eddi_scaffold.recordings.members import Member
from eddi_scaffold.recordings.playing import play, played
from tests.cli.command import ROOT

ROBOT = ROOT / "examples" / "warehouse-robot"
SECOND = 1_000_000_000


@dataclass(frozen=True)
class Published:
    """One message: seconds, topic below the robot, node, type, fields as attributes."""

    t: float
    topic: str
    node: str
    type: str
    content: Any


@cache
def warehouse() -> tuple[Published, ...]:
    """Return all that the monitors publish while the bag of the example is played."""
    return tuple(_warehouse())


def _warehouse() -> Iterator[Published]:
    monitors, _ = monitors_of(None, [ROBOT / "robot.yml"])
    members = [Member(monitor) for monitor in monitors]
    recording, _ = read_bag(ROBOT / "shift.bag", members)
    for part, frame in play(played(members), recording):
        assert part.publisher is not None
        types = {one.topic: one.publication.type for one in part.publisher.channels}
        for topic, content in part.publisher.messages(part.running, frame.output, types):
            yield Published(frame.t, topic, part.name, types[topic], content)


def store_of_ros1() -> Any:
    """Return the types of ROS 1 with ours."""
    from rosbags.typesys import Stores, get_types_from_msg, get_typestore

    store = get_typestore(Stores.ROS1_NOETIC)
    for kind in kinds().values():
        for name, text in kind.messages.items():
            store.register(get_types_from_msg(text, f"eddi_messages/msg/{name}"))
    return store


def bag_of_two(path: Path) -> Path:
    """Write a bag of ROS 1 with two robots; the second one ends after ten seconds."""
    from rosbags.rosbag1 import Writer

    store = store_of_ros1()
    with Writer(path) as writer:
        connections: dict[str, Any] = {}
        for one in warehouse():
            for robot in ("/robot1", "/robot2") if one.t < 10.0 else ("/robot1",):
                topic, of = f"{robot}{one.topic}", one.type.replace("/", "/msg/")
                if topic not in connections:
                    connections[topic] = writer.add_connection(
                        topic, of, typestore=store, callerid=f"{robot}/{one.node}", latching=1
                    )
                data = store.serialize_ros1(built(store, one.type, one.content), of)
                writer.write(connections[topic], round((100 + one.t) * SECOND), bytes(data))
    return path


def built(store: Any, of: str, content: Any) -> Any:
    values = {}
    for field, kind in known_messages()[of].items():
        values[field] = _value(store, kind, getattr(content, field))
    if of == "std_msgs/Header":
        values = {"seq": 0, "stamp": store.types["builtin_interfaces/msg/Time"](1, 2)}
        values["frame_id"] = ""
    return store.types[of.replace("/", "/msg/")](**values)


def _value(store: Any, kind: str, value: Any) -> Any:
    inner = kind.partition("[")[0]
    if "/" not in inner:
        if kind.endswith("]") and inner.startswith("float"):
            import numpy as np

            return np.array(value, inner)
        return value
    if kind.endswith("]"):
        return [built(store, inner, one) for one in value]
    return built(store, inner, value)
