"""Types of the fields of messages, as ``.msg`` files write them.

A type is ``float64``, ``geometry_msgs/Point``, or one of these with ``[]`` or ``[9]`` behind it.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping

Fields = Mapping[str, str]  # field -> type; constants are none

MessageFields = Mapping[str, Fields]
"""Message type (``std_msgs/Bool``) -> field -> type as in a ``.msg`` file."""
_INTEGERS = (
    "int8", "int16", "int32", "int64", "uint8", "uint16", "uint32", "uint64", "byte", "char",
)  # fmt: skip
_PYTHON_TYPES = {
    "bool": "bool",
    "string": "str",
    "float32": "float",
    "float64": "float",
    **dict.fromkeys(_INTEGERS, "int"),
}
TIMES: Mapping[str, Fields] = {
    "time": {"secs": "uint32", "nsecs": "uint32"},
    "duration": {"secs": "int32", "nsecs": "int32"},
}
"""What rospy makes of the two primitive types that have parts."""
PRIMITIVES = (*_PYTHON_TYPES, *TIMES, "wstring")  # all types that are no messages
EITHER_TIMES: Mapping[str, Fields] = {
    "time": {**TIMES["time"], "sec": "int32", "nanosec": "uint32"},
    "duration": {**TIMES["duration"], "sec": "int32", "nanosec": "uint32"},
}
"""The same, or as in ROS 2: before it is known for which of them a package is."""
_FIELD = re.compile(r"^\s*([A-Za-z][\w/]*(?:\[\d*\])?)\s+([A-Za-z]\w*)\s*(?:#.*)?$", re.MULTILINE)
_TYPE = re.compile(r"([A-Za-z][\w/]*)(\[\d*\])?")


def fields_of(text: str, package: str = "") -> dict[str, str]:
    """Read the fields of a ``.msg`` text of a package, whose name types of its own leave out."""
    return {name: _qualified(of, package) for of, name in _FIELD.findall(text)}


def declared(fields: Iterable[tuple[str, str]], package: str) -> dict[str, str]:
    """Return a field table of pairs of type and name; what is not a field name is left out."""
    return {
        name: _qualified(of.replace("/msg/", "/").replace(".", "/"), package)
        for of, name in fields
        if _TYPE.fullmatch(of.replace(".", "/")) and re.fullmatch(r"[A-Za-z]\w*", name)
    }


def _qualified(of: str, package: str) -> str:
    """Return a type with its package: ``Header`` is that of std_msgs."""
    match = _TYPE.fullmatch(of)
    if match is None:
        return of
    name, array = match[1], match[2] or ""
    if name == "Header":
        name = "std_msgs/Header"
    elif "/" not in name and name not in _PYTHON_TYPES and name not in TIMES and package:
        name = f"{package}/{name}"
    return f"{name}{array}"


def element(of: str) -> str | None:
    """Return the type of the elements of a list, ``None`` for what is not a list."""
    return of.partition("[")[0] if of.endswith("]") else None


def is_primitive(of: str) -> bool:
    """Return whether a type has no fields: ``bool``, ``float64``, ``string``, ..."""
    return of in _PYTHON_TYPES


def python_type(of: str) -> str:
    """Return ``bool``, ``int``, ``float``, ``str``, ``float[]`` or ``bool[]``, else the type.

    A list of bytes (``uint8[]``, ``char[]``) is ``bytes`` in rospy, which is none of these.
    """
    inner = element(of)
    if inner is None:
        return _PYTHON_TYPES.get(of, of)
    if inner in ("uint8", "char"):
        return of
    number = {"float": "float[]", "int": "float[]", "bool": "bool[]"}
    return number.get(_PYTHON_TYPES.get(inner, ""), of)


def packages_of(texts: Iterable[str]) -> list[str]:
    """Return the packages of the field types in ``.msg`` texts, sorted."""
    types = [of for text in texts for of in fields_of(text).values()]
    return sorted({of.partition("/")[0] for of in types if "/" in of})


def used(types: Iterable[str], known: MessageFields) -> dict[str, dict[str, str]]:
    """Return those of the known messages that are needed to follow any path into some types."""
    needed: dict[str, dict[str, str]] = {}
    waiting = list(types)
    while waiting:
        name = waiting.pop()
        name = element(name) or name
        if name in known and name not in needed:
            needed[name] = dict(known[name])
            waiting += known[name].values()
    return dict(sorted(needed.items()))
