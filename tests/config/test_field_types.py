"""Keys in field paths, as the definitions of the messages say them."""

from __future__ import annotations

import pytest

from eddi_scaffold.config.field_paths import FieldPathError, expression, parse_field, resolve
from eddi_scaffold.config.field_types import declared
from eddi_scaffold.monitors.message_types import known_messages

KNOWN = {
    **known_messages(),
    "vision_msgs/Hypothesis": declared([("int64", "id"), ("float64", "score")], "vision_msgs"),
    "vision_msgs/Detection": declared([("Hypothesis[]", "results")], "vision_msgs"),
    "my_msgs/Frames": declared([("sensor_msgs/Range[]", "ranges"), ("Gone[]", "gone")], "my_msgs"),
}


def taken(message: str, text: str) -> tuple[str, str | None]:
    found = resolve(parse_field(text), message, KNOWN.get)
    return expression("m", found.path), found.type


@pytest.mark.parametrize(
    ("message", "text", "code", "of"),
    [
        (
            "eddi_messages/BayesianNetworkOutput",
            "output_nodes[Collision].outcomes[High].outcome_value",
            (
                "by_key(by_key(m.output_nodes, 'title', 'Collision').outcomes, "
                "'outcome_name', 'High').outcome_value"
            ),
            "float",
        ),
        (
            "eddi_messages/ConSertOutput",
            "guarantees[G0].active",
            "by_id(m.guarantees, 'G0').active",
            "bool",
        ),
        (
            "diagnostic_msgs/DiagnosticArray",
            'status["/Power: battery"].values[Voltage].value',
            "by_key(by_key(m.status, 'name', '/Power: battery').values, 'key', 'Voltage').value",
            "str",
        ),
        (
            "diagnostic_msgs/DiagnosticArray",
            'status[hardware_id="BMS-1"].level',
            "by_key(m.status, 'hardware_id', 'BMS-1').level",
            "int",
        ),
        ("vision_msgs/Detection", "results[id=3].score", "by_id(m.results, 3).score", "float"),
        (
            "sensor_msgs/JointState",
            "position[gripper]",
            "by_name(m.position, m.name, 'gripper')",
            "float",
        ),
        (
            "my_msgs/Frames",
            "ranges[front].range",
            "by_key(m.ranges, 'header.frame_id', 'front').range",
            "float",
        ),
        ("my_msgs/Frames", "gone[x].y", "by_id(m.gone, 'x').y", None),
    ],
)
def test_the_key_is_the_field_that_names_the_element(
    message: str, text: str, code: str, of: str | None
) -> None:
    assert taken(message, text) == (code, of)


@pytest.mark.parametrize(
    ("message", "text", "reason"),
    [
        (
            "sensor_msgs/PointCloud",
            "points[here].x",
            (
                "the elements are geometry_msgs/Point32, which have no name that [here] could be; "
                'name the field, [field="here"], of: x, y, z'
            ),
        ),
        (
            "vision_msgs/Detection",
            "results[person].score",
            (
                "the elements are vision_msgs/Hypothesis, which have no name that [person] "
                'could be; name the field, [field="person"], of: id, score'
            ),
        ),
        (
            "diagnostic_msgs/DiagnosticArray",
            "status[names=x].level",
            (
                "diagnostic_msgs/DiagnosticStatus has no field 'names'; did you mean 'name'? "
                "its fields: level, name, message, hardware_id, values"
            ),
        ),
        (
            "vision_msgs/Detection",
            "results[id=person].score",
            "'id' of vision_msgs/Hypothesis is a int64, 'person' is not a whole number",
        ),
        (
            "vision_msgs/Detection",
            "results[score=1].id",
            "'score' of vision_msgs/Hypothesis is a float64: a key is a text or a whole number",
        ),
        (
            "sensor_msgs/LaserScan",
            "ranges[front]",
            (
                "sensor_msgs/LaserScan has no list of names (name, names, joint_names, "
                "labels) for 'ranges'; one element is [0]; its fields: header, angle_min, "
                "angle_max, angle_increment, time_increment, scan_time, range_min, range_max, "
                "ranges, intensities"
            ),
        ),
        (
            "sensor_msgs/JointState",
            "name[gripper]",
            (
                "sensor_msgs/JointState has no list of names (name, names, joint_names, "
                "labels) for 'name'; one element is [0]; its fields: header, name, "
                "position, velocity, effort"
            ),
        ),
    ],
)
def test_what_has_no_such_key_is_said_with_the_fields(message: str, text: str, reason: str) -> None:
    with pytest.raises(FieldPathError) as failure:
        taken(message, text)
    said, hint = str(failure.value), failure.value.hint
    assert (said if hint is None else f"{said}; {hint}") == reason
