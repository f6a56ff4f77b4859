"""Keys in field paths, as the definitions of the messages say them."""

import pytest

from eddi_scaffold.config.field_paths import FieldPathError, expression, parse_field, resolve
from eddi_scaffold.config.field_types import declared
from eddi_scaffold.monitors.message_types import known_messages
from tests.data_files import tabled

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


@tabled
def test_the_key_is_the_field_that_names_the_element(text: str, code: str, of: str | None) -> None:
    assert taken(text) == (code, of)


@tabled
def test_what_has_no_such_key_is_said_with_the_fields(text: str, reason: str) -> None:
    with pytest.raises(FieldPathError) as failure:
        taken(text)
    assert reason in f"{failure.value}; {failure.value.hint}"
