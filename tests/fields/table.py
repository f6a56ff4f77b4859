"""Every type of a field with a value, and what a configuration reads of it: on each transport.

Each of them runs this with its own Python, and real messages: ``table.py ros1|ros2`` prints JSON.
"""

import json
import sys
from pathlib import Path

HERE = Path(__file__).parent
PACKAGE = HERE / "field_msgs"
"""The package of messages for ROS 2."""
ALL, INNER = ((PACKAGE / "msg" / f"{name}.msg").read_text("utf-8") for name in ("All", "Inner"))
ALL_OF_ROS1 = (HERE / "All.ros1.msg").read_text("utf-8")
VALUES = {
    "flag": True, "level": 2, "letter": 65, "tiny": -5, "small": 250, "shorter": -300,
    "word": 60000, "number": -70000, "count": 4000000000, "longer": -(2**40), "huge": 2**63,
    "half": 0.5, "tenth": 0.1, "text": "grün", "levels": [1, 2, 3], "more_levels": [4, 5],
    "letters": [66, 67], "more_letters": [68], "bytes_here": [255, 1], "bytes_there": [128, 7],
    "flags": [True, False], "triple": [1.5, 2.5, 3.5], "ranges": [0.25, 4.0],
    "names": ["left", "right"], "unbounded": [8, 9], "short_text": "abcde",
    "few_words": ["on", "off"],
}  # fmt: skip
TIMES = {"header.stamp": (12, 34), "at": (56, 78), "lasts": (9, 10)}
INNERS = {"inner": (11, "in"), "list": [(21, "a"), (22, "b")], "pair": [(31, "c"), (32, "d")]}
READS = {
    **{name: (name, value) for name, value in VALUES.items() if not isinstance(value, list)},
    **{
        f"{name}[{len(value) - 1}]": ([name, len(value) - 1], value[-1])
        for name, value in VALUES.items()
        if isinstance(value, list)
    },
    "inner.value": (["inner", "value"], 11),
    "list[1].name": (["list", 1, "name"], "b"),
    "pair[0].value": (["pair", 0, "value"], 31),
    "list[b].value": (["list", ["name", "b"], "value"], 22),
    "ranges[right]": ([["ranges", "names", "right"]], 4.0),
    "header.frame_id": (["header", "frame_id"], "map"),
    **{f"{entry}.sec": ([*entry.split("."), "sec"], TIMES[entry][0]) for entry in TIMES},
    **{f"{entry}.nanosec": ([*entry.split("."), "nanosec"], TIMES[entry][1]) for entry in TIMES},
    "preset": ("preset", 7),
    "header": ("header", None),
    "levels": ("levels", None),
    "names": ("names", None),
}
"""What a configuration writes -> (path, what it is), of a whole message or list: unknown."""


def fill(message, inner, *, seconds="sec", nanoseconds="nanosec", entry=int):
    """Set the fields; ``one`` makes a single byte of a number."""
    for name, value in VALUES.items():
        byte = name in ("level", "levels", "more_levels")
        made = [entry(x) for x in value] if byte and isinstance(value, list) else value
        setattr(message, name, entry(value) if name == "level" else made)
    message.header.frame_id = "map"
    for name, (s, ns) in TIMES.items():
        there = message
        for part in name.split("."):
            there = getattr(there, part)
        setattr(there, seconds, s)
        setattr(there, nanoseconds, ns)
    made = {
        k: [inner(*x) for x in v] if isinstance(v, list) else inner(*v) for k, v in INNERS.items()
    }
    for name, value in made.items():
        setattr(message, name, value)
    return message


def read(message, rename=lambda name: name):
    """Return what a configuration reads."""
    from eddi_runtime.plain_values import follow, plain

    result = {}
    for name, (path, _) in READS.items():
        steps = [path] if isinstance(path, str) else path
        result[name] = plain(
            follow(message, [rename(x) if isinstance(x, str) else x for x in steps])
        )
    return result


def on_ros1():
    from io import BytesIO

    from field_msgs.msg import All, Inner

    inner = lambda value, name: Inner(value=value, name=name)  # noqa: E731
    message = fill(All(preset=7), inner, seconds="secs", nanoseconds="nsecs")
    out = BytesIO()
    message.serialize(out)
    again = All().deserialize(out.getvalue())
    names = {"sec": "secs", "nanosec": "nsecs"}
    return {"values": read(again, lambda name: names.get(name, name)), "data": out.getvalue().hex()}


def on_ros2():
    from field_msgs.msg import All, Inner, Wide
    from rclpy.serialization import deserialize_message, serialize_message

    inner = lambda value, name: Inner(value=value, name=name)  # noqa: E731
    data = serialize_message(fill(All(), inner, entry=lambda x: bytes([x])))
    wide = deserialize_message(serialize_message(Wide(text="grün", level=b"\xc8")), Wide)
    values = read(deserialize_message(data, All))
    return {"values": values, "data": data.hex(), "wide": [wide.text, wide.level[0]]}


if __name__ == "__main__":
    print(json.dumps({"ros1": on_ros1, "ros2": on_ros2}[sys.argv[1]]()))
