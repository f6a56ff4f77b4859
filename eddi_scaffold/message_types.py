"""Message types of a configuration that are known without ROS: fields and their Python types.

The table is part of eddi-scaffold, so that the same configuration gives the same package on a
machine with ROS and on one without.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping

from eddi_scaffold.kinds import Kind

FieldsOf = Mapping[str, Mapping[str, str]]
"""Message type -> field -> ``bool``, ``int``, ``float``, ``str`` or another message type."""

_PYTHON_TYPES = {
    "bool": "bool", "string": "str", "float32": "float", "float64": "float", "int8": "int",
    "int16": "int", "int32": "int", "int64": "int", "uint8": "int", "uint16": "int",
    "uint32": "int", "uint64": "int",
}  # fmt: skip
_FIELD = re.compile(r"^\s*([A-Za-z][\w/]*(?:\[\d*\])?)\s+([A-Za-z]\w*)\s*(?:#.*)?$", re.MULTILINE)

_STD_MSGS = {
    "Bool": "bool", "Byte": "int8", "Char": "uint8", "Float32": "float32", "Float64": "float64",
    "Int8": "int8", "Int16": "int16", "Int32": "int32", "Int64": "int64", "String": "string",
    "UInt8": "uint8", "UInt16": "uint16", "UInt32": "uint32", "UInt64": "uint64",
}  # fmt: skip


def known_messages(kinds: Iterable[Kind]) -> FieldsOf:
    """Return the fields of the messages of ``std_msgs`` and of our own ``eddi_messages``."""
    known: dict[str, Mapping[str, str]] = {
        f"std_msgs/{name}": {"data": _PYTHON_TYPES[of]} for name, of in _STD_MSGS.items()
    }
    for kind in kinds:
        for name, text in kind.messages.items():
            known[f"eddi_messages/{name}"] = fields_of(text)
    return known


def fields_of(text: str) -> Mapping[str, str]:
    """Read the fields of a ``.msg`` text: name -> Python type, or the ROS type as written."""
    return {name: _PYTHON_TYPES.get(of, of) for of, name in _FIELD.findall(text)}


def packages_of(texts: Iterable[str]) -> list[str]:
    """Return the packages of the field types in ``.msg`` texts, sorted."""
    types = (of for text in texts for of, _ in _FIELD.findall(text))
    return sorted({of.partition("/")[0] for of in types if "/" in of})
