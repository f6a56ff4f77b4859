"""Messages of ours without ROS: objects made of a monitor's message trees.

They are checked field by field: a tree that does not fit its ``.msg`` file is refused, as a node
would refuse it.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import cache
from types import SimpleNamespace
from typing import Any

from eddi_runtime.monitor import Tree

from eddi_scaffold.config.message_types import (
    Fields,
    element,
    is_primitive,
    known_messages,
)

Message = SimpleNamespace
"""One attribute for each field, and ``message_type``."""

_RANGES = {
    f"{sign}int{bits}": range(2**bits) if sign else range(-(2 ** (bits - 1)), 2 ** (bits - 1))
    for sign in ("", "u")
    for bits in (8, 16, 32, 64)
}
_HEADER = "std_msgs/Header"
_PLAIN_DEFAULTS: Mapping[str, Any] = {"bool": False, "string": "", "float32": 0.0, "float64": 0.0}


def message_of(tree: Tree) -> Message:
    """Return a message of the product's own package.

    Raises:
        TypeError: a field is missing, surplus, or of a wrong type.
    """
    name, fields = tree
    return _built(f"eddi_messages/{name}")(fields)


def blank(message_type: str) -> Message:
    """Return a message in which every field has the default of its type."""
    of = known_messages()[message_type]
    return Message(message_type=message_type, **{name: _blank(kind) for name, kind in of.items()})


def _blank(kind: str) -> Any:
    if kind.endswith("]"):
        return []
    if is_primitive(kind):
        return _PLAIN_DEFAULTS.get(kind, 0)
    return blank(kind)


@cache
def _built(message_type: str) -> Callable[[Mapping[str, Any]], Message]:
    of: Fields = known_messages()[message_type]
    checks = {
        name: _check(f"{message_type}.{name}", kind) for name, kind in of.items() if kind != _HEADER
    }
    rest: dict[str, Any] = {name: blank(_HEADER) for name, kind in of.items() if kind == _HEADER}
    rest["message_type"] = message_type

    def build(fields: Mapping[str, Any]) -> Message:
        if fields.keys() != checks.keys():
            raise TypeError(f"{message_type} has {sorted(checks)}, not {sorted(fields)}")
        checked = {name: check(fields[name]) for name, check in checks.items()}
        return Message(**checked, **rest)

    return build


def _check(where: str, kind: str) -> Callable[[Any], Any]:
    """Return what checks a value of a field and returns it as the message holds it."""
    inner = element(kind)
    if inner is not None:
        one = _check(where, inner)
        return lambda value: [
            one(item) for item in _fitting(isinstance(value, list | tuple), where, value)
        ]
    if kind == "bool":
        return lambda value: _fitting(type(value) is bool, where, value)
    if kind == "string":
        return lambda value: _fitting(type(value) is str, where, value)
    if kind in _RANGES:
        return lambda value: _fitting(type(value) is int and value in _RANGES[kind], where, value)
    if kind in _PLAIN_DEFAULTS:
        return lambda value: float(_fitting(type(value) in (int, float), where, value))
    return lambda value: _nested(where, kind, value)


def _fitting(fits: bool, where: str, value: Any) -> Any:
    if not fits:
        raise TypeError(f"{where} cannot be {value!r}")
    return value


def _nested(where: str, kind: str, value: Any) -> Message:
    _fitting(isinstance(value, tuple) and f"eddi_messages/{value[0]}" == kind, where, value)
    return message_of(value)
