"""Keys in field paths, as the definitions of the messages say them."""

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


def taken(text: str) -> tuple[str, str | None]:
    """Return what is read of `Message path`."""
    name, path = text.split(" ", 1)
    (message,) = (entry for entry in KNOWN if entry.endswith(f"/{name}"))
    result = resolve(parse_field(path), message, KNOWN.get)
    return expression("m", result.path), result.type


POWER = "by_key(by_key(m.status, 'name', '/Power: b').values, 'key', 'V').value"
NODE = "by_key(by_key(m.output_nodes, 'title', 'A').outcomes, 'outcome_name', 'B').outcome_value"


@pytest.mark.parametrize(
    ("text", "code", "of"),
    [
        ("BayesianNetworkOutput output_nodes[A].outcomes[B].outcome_value", NODE, "float"),
        ("ConSertOutput guarantees[G0].active", "by_id(m.guarantees, 'G0').active", "bool"),
        ('DiagnosticArray status["/Power: b"].values[V].value', POWER, "str"),
        (
            'DiagnosticArray status[hardware_id="BMS-1"].level',
            "by_key(m.status, 'hardware_id', 'BMS-1').level",
            "int",
        ),
        ("Detection results[id=3].score", "by_id(m.results, 3).score", "float"),
        ("JointState position[gripper]", "by_name(m.position, m.name, 'gripper')", "float"),
        ("Frames ranges[a].range", "by_key(m.ranges, 'header.frame_id', 'a').range", "float"),
        ("Frames gone[x].y", "by_id(m.gone, 'x').y", None),
    ],
)
def test_the_key_is_the_field_that_names_the_element(text: str, code: str, of: str | None) -> None:
    assert taken(text) == (code, of)


@pytest.mark.parametrize(
    ("text", "reason"),
    [
        (
            "PointCloud points[here].x",
            'no name that [here] could be; name the field, [field="here"',
        ),
        ("Detection results[person].score", "vision_msgs/Hypothesis, which have no name that [p"),
        ("DiagnosticArray status[names=x].level", "has no field 'names'; did you mean 'name'?"),
        ("Detection results[id=person].score", "is a int64, 'person' is not a whole number"),
        ("Detection results[score=1].id", "is a float64: a key is a text or a whole number"),
        (
            "LaserScan ranges[front]",
            "labels) for 'ranges'; one element is [0]; its fields: header,",
        ),
        ("JointState name[gripper]", "no list of names (name, names, joint_names, labels) for 'na"),
    ],
)
def test_what_has_no_such_key_is_said_with_the_fields(text: str, reason: str) -> None:
    with pytest.raises(FieldPathError) as failure:
        taken(text)
    assert reason in f"{failure.value}; {failure.value.hint}"
