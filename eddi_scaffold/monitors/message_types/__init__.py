"""The message types that are known: names of fields with their types.

The common messages travel with eddi-scaffold, so that the same configuration gives the same package
on a machine with ROS and on one without.
"""

from __future__ import annotations

from functools import cache
from importlib.resources import files

from eddi_scaffold.config.field_types import TIMES, Fields, MessageFields, element, fields_of
from eddi_scaffold.kinds import kinds


@cache
def common_messages() -> MessageFields:
    """Return message type -> fields of std_msgs, common_msgs and geometry2 of ROS 1."""
    lines = (files(__package__) / "common.txt").read_text("utf-8").splitlines()
    messages: dict[str, Fields] = {}
    for line in lines:
        if line and not line.startswith("#"):
            name, _, text = line.partition(":")
            pairs = (part.split() for part in text.split(",") if part.strip())
            messages[name] = {field: of for of, field in pairs}
    return messages


@cache
def known_messages() -> MessageFields:
    """Return the fields of the common messages of ROS 1 and of our own ``eddi_messages``."""
    own = {
        f"eddi_messages/{name}": fields_of(text, "eddi_messages")
        for kind in kinds().values()
        for name, text in kind.all_messages.items()
    }
    return {**TIMES, **common_messages(), **own}


_WORDS = {"time": "builtin_interfaces/Time", "duration": "builtin_interfaces/Duration"}
_CHANGED: dict[str, Fields] = {
    "builtin_interfaces/Time": {"sec": "int32", "nanosec": "uint32"},
    "builtin_interfaces/Duration": {"sec": "int32", "nanosec": "uint32"},
    "std_msgs/Header": {"stamp": "builtin_interfaces/Time", "frame_id": "string"},
}
_LOWER_CASE = ("sensor_msgs/CameraInfo", "stereo_msgs/DisparityImage")
_OTHER = (
    "shape_msgs/SolidPrimitive",
    "visualization_msgs/Marker",
    "visualization_msgs/MarkerArray",
)
"""Not the same in all releases."""
_GONE = ("rosgraph_msgs/Log", "rosgraph_msgs/TopicStatistics", "std_msgs/Duration", "std_msgs/Time")
_ACTIONS = tuple(
    f"{package}/{action}"
    for package in ("nav_msgs", "tf2_msgs")
    for action in ("GetMap", "LookupTransform")
)


def ros2_messages(known: dict[str, Fields]) -> dict[str, Fields]:
    """Return message types as ROS 2 has them, of those of ROS 1; some it does not have."""
    messages = dict(_CHANGED)
    for name, fields in known.items():
        if name not in (*_CHANGED, *_GONE, *_OTHER, *TIMES) and not name.startswith(_ACTIONS):
            is_lower = name in _LOWER_CASE
            renamed = {f.lower() if is_lower else f: of for f, of in fields.items()}
            messages[name] = ros2_fields(renamed)
    return messages


def ros2_fields(fields: Fields) -> dict[str, str]:
    """Return fields with the times of ROS 2."""
    items = {name: element(of) or of for name, of in fields.items()}
    return {
        name: _WORDS.get(items[name], items[name]) + of[len(items[name]) :]
        for name, of in fields.items()
    }
