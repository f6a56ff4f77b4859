"""Values in messages without ROS, read and written by paths."""

from functools import cache
from typing import Any

from eddi_scaffold.config.field_paths import Attribute, ByKey, FieldPath, Index, Step, parse_field
from eddi_scaffold.config.field_types import element
from eddi_scaffold.monitors.message_types import known_messages
from eddi_scaffold.recordings.node import Message, blank


@cache
def path_of(text: str) -> FieldPath:
    """Return a field path in steps."""
    return parse_field(text)


def read(message: Any, path: FieldPath) -> Any:
    """Return the value at the end of a path, None where it leads nowhere."""
    try:
        for step in path:
            message = _element(message, step)
    except (AttributeError, LookupError):
        return None
    return message


def _element(value: Any, step: Step) -> Any:
    if isinstance(step, Attribute):
        return getattr(value, step.name)
    if isinstance(step, Index):
        return value[step.position]
    assert isinstance(step, ByKey)
    key = step.field or "id"
    return [one for one in value if getattr(one, key) == step.key][0]  # noqa: RUF015 - a LookupError


def written(message: Message, path: FieldPath, value: Any) -> Message:
    """Return a copy of a message with another value at the end of a path.

    Elements that a list on the way does not have are made.
    """
    return _replaced(message, message.message_type, path, value)


def _replaced(here: Any, kind: str, path: FieldPath, value: Any) -> Any:
    if not path:
        return value
    step, *rest = path
    if isinstance(step, Attribute):
        inner = known_messages()[kind][step.name]
        changed = _replaced(getattr(here, step.name), inner, tuple(rest), value)
        return Message(**{**vars(here), step.name: changed})
    one = element(kind)
    assert one is not None, "a list is expected"
    items = list(here)
    number = _number(items, one, step)
    items[number] = _replaced(items[number], one, tuple(rest), value)
    return items


def _number(items: list[Any], kind: str, step: Step) -> int:
    """Return which element a step means; what the list lacks is appended."""
    if isinstance(step, Index):
        items.extend(blank(kind) for _ in range(len(items), step.position + 1))
        return step.position
    assert isinstance(step, ByKey)
    key = step.field or "id"
    found = [number for number, one in enumerate(items) if getattr(one, key) == step.key]
    if not found:
        items.append(Message(**{**vars(blank(kind)), key: step.key}))
    return found[0] if found else len(items) - 1
