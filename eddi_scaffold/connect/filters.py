"""What cannot fill an input, and why: rules without a score."""

from __future__ import annotations

import re

from eddi_scaffold import units
from eddi_scaffold.connect.access import units_of
from eddi_scaffold.connect.needs import Need
from eddi_scaffold.connect.topics import Leaf
from eddi_scaffold.connect.words import words

_NO_MEASUREMENTS = (
    *("dynamic_reconfigure", "rcl_interfaces", "bond", "lifecycle_msgs", "rosgraph_msgs"),
    *("visualization_msgs", "tf2_msgs"),
)
_FOR_DEMANDS = ("eddi_messages/ConSertOutput", "eddi_messages/BayesianNetworkOutput")
_SETTING = re.compile(
    r"angle_.*|range_m(?:in|ax)|m(?:in|ax)_range|field_of_view|time_increment|scan_time|"
    r"intensities|origin|significance_level|time_from_start"
)
_PICTURES = ("Image", "CameraInfo", "PointCloud2", "OccupancyGrid")
_SIZES = (
    "width",
    "height",
    "resolution",
    "step",
    "point_step",
    "row_step",
    "binning_x",
    "binning_y",
)
_NEVER = ("header", "layout")
_ABOUT_UNCERTAINTY = ("uncertainty", "covariance", "deviation", "std", "variance", "accuracy")
_COMPARED = ("diagnostic_msgs/", "vision_msgs/")
_TIMES = ("secs", "nsecs")


def objection(need: Need, message: str, leaf: Leaf) -> str | None:
    """Return why a value of a message type cannot fill an input, ``None`` where it might."""
    names = [name.partition("[")[0] for name in leaf.path] or [""]
    if message.partition("/")[0] in _NO_MEASUREMENTS:
        return "it is not a measurement"
    if need.is_demand != (message == _FOR_DEMANDS[0]):
        return "a demand needs the guarantee of another ConSert"
    if message == _FOR_DEMANDS[1]:
        return "posteriors are not evidence"
    if names[0] in _NEVER or names[-1] in _TIMES:
        return "it is about the message"
    is_size = message.rpartition("/")[2] in _PICTURES and names[-1] in _SIZES
    if is_size or any(map(_SETTING.fullmatch, names)):
        return "it is a setting of the sensor"
    if leaf.path and leaf.is_variance != need.says(*_ABOUT_UNCERTAINTY):
        return "it is an uncertainty" if leaf.is_variance else "it is not an uncertainty"
    return _type(need, message, leaf) or _unit(need, leaf)


def _type(need: Need, message: str, leaf: Leaf) -> str | None:
    if not leaf.path:
        return None
    is_number = leaf.type in ("int", "float")
    is_coded = leaf.units == () and leaf.type == "int"  # an enumeration, bits
    if need.type == "bool":
        is_told = bool(leaf.path) and set(words(leaf.text)) <= set(need.told)
        fits = leaf.type == "bool" or (is_number and (message.startswith(_COMPARED) or is_told))
    elif need.type in ("float", "int"):
        fits = is_number and not (is_coded and need.type == "float")
    elif need.type == "float[]":
        fits = is_number and leaf.text.endswith("[]") and leaf.lists == 1
    elif need.type == "bool[]":
        fits = leaf.type == "bool" and leaf.text.endswith("[]") and leaf.lists == 1
    else:  # a text, or a state by its name
        fits = leaf.type == "str"
    return None if fits else f"it is a {leaf.type}"


def _unit(need: Need, leaf: Leaf) -> str | None:
    if need.unit is None or need.type not in ("float", "int"):
        return None
    given = units_of(leaf)
    if given is None:
        return None
    if not given:
        return "it has no unit" if need.unit else None
    if any(units.factor(unit, need.unit) is not None for unit in given):
        return None
    return f"it is in {' or '.join(given)}"
