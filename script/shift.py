"""Write the recording of examples/warehouse-robot: a bag in which sensors die.

    python script/shift.py          # needs the extra `bags`

Forty seconds at 10 Hz. From 12 s on the lidar is silent, at 18 s it is back; from 26 s on it is
dark in the aisle.
"""

from __future__ import annotations

import random
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
from rosbags.rosbag1 import Writer
from rosbags.typesys import Stores, get_typestore

ROBOT = Path(__file__).resolve().parents[1] / "examples" / "warehouse-robot"
SECONDS = 40
LIDAR_DIES, LIDAR_IS_BACK, DARK = 12.0, 18.0, 26.0
START_NS = 1_700_000_000 * 10**9
APPROVED, DARK_AISLE = (120.0, 40.0, 6.0), (60.0, 22.0, 4.5)
SPREAD = (12.0, 5.0, 0.7)


def frames(seed: int, means: Iterator[tuple[float, ...]]) -> Iterator[list[float]]:
    """Return brightness, contrast and sharpness of camera frames around their means."""
    chance, drift = random.Random(seed), [0.0, 0.0, 0.0]  # noqa: S311 - made-up frames
    for mean in means:
        drift = [0.2 * last + 0.98 * chance.gauss(0, 1) for last in drift]
        yield [round(m + s * d, 3) for m, s, d in zip(mean, SPREAD, drift, strict=True)]


def recording() -> Iterator[tuple[float, str, str, Any]]:
    """Return time in seconds, topic, message type and value of every message."""
    times = [step / 10 for step in range(SECONDS * 10)]
    means = iter([DARK_AISLE if t >= DARK else APPROVED for t in times])
    for t, frame in zip(times, frames(9, means), strict=True):
        if not LIDAR_DIES <= t < LIDAR_IS_BACK:
            yield t, "/lidar/nearest", "std_msgs/msg/Float32", 6.0
        yield t, "/localisation/match", "std_msgs/msg/Float32", 0.93
        yield t, "/wheels/slip", "std_msgs/msg/Float32", 0.01
        yield t, "/camera/features", "std_msgs/msg/Float32MultiArray", frame
        if t == int(t):
            yield t, "/battery/level", "std_msgs/msg/Float32", 80.0
            yield t, "/drives/available", "std_msgs/msg/Int32", 4


def write_bag(path: Path) -> None:
    """Write the recording."""
    store = get_typestore(Stores.ROS1_NOETIC)
    bag = Writer(path)
    bag.set_compression(Writer.CompressionFormat.BZ2)
    with bag:
        connections = {}
        for t, topic, name, value in recording():
            if topic not in connections:
                connections[topic] = bag.add_connection(topic, name, typestore=store)
            kind = store.types[name]
            if name.endswith("MultiArray"):
                layout = store.types["std_msgs/msg/MultiArrayLayout"](dim=[], data_offset=0)
                message = kind(layout=layout, data=np.array(value, dtype=np.float32))
            else:
                message = kind(data=value)
            data = store.serialize_ros1(message, name)
            bag.write(connections[topic], START_NS + round(t * 1e9), bytes(data))


def write_faults(path: Path) -> None:
    """Write what each topic says, good at first; then one after the other says what is bad."""
    good = {"nearest": 6.0, "matched": 0.93, "slip": 0.01, "battery_level": 80.0}
    good["drives_available"] = 4
    bad = {"nearest": 0.9, "matched": 0.4, "slip": 0.2, "battery_level": 5.0}
    bad["drives_available"] = 2
    lines = [",".join(["t", *good, "frame"])]
    for step, frame in enumerate(frames(9, iter([APPROVED] * 160))):
        turn, rest = divmod(step - 60, 20)  # two seconds for each, from the sixth on
        values = dict(good)
        if turn in range(len(good)) and rest < 5:
            values[list(good)[turn]] = bad[list(good)[turn]]
        lines.append(",".join(map(str, [step / 10, *values.values(), " ".join(map(str, frame))])))
    path.write_text("\n".join(lines) + "\n")


def write_reference(path: Path) -> None:
    """Write the frames of approved aisles."""
    rows = frames(7, iter([APPROVED] * 1000))
    text = "".join(",".join(map(str, row)) + "\n" for row in rows)
    path.write_text("# frames of approved aisles, 10 Hz: brightness, contrast, sharpness\n" + text)


if __name__ == "__main__":
    write_reference(ROBOT / "reference_sample.csv")
    write_faults(ROBOT / "faults.csv")
    (ROBOT / "shift.bag").unlink(missing_ok=True)
    write_bag(ROBOT / "shift.bag")
