"""Hashes of message types as ROS 2 tells them since Iron (RIHS01), of names and fields alone."""

from __future__ import annotations

import hashlib
import json
import re

from eddi_scaffold.config.message_types import Fields, MessageFields

_IDS = {
    "int8": 2, "uint8": 3, "char": 3, "int16": 4, "uint16": 5, "int32": 6, "uint32": 7, "int64": 8,
    "uint64": 9, "float32": 10, "float64": 11, "bool": 15, "byte": 16, "string": 17,
}  # fmt: skip
_NESTED, _ARRAY, _SEQUENCE = 1, 48, 144
_EMPTY = {"structure_needs_at_least_one_member": "uint8"}
_TYPE = re.compile(r"([\w/]+)(\[(\d*)\])?")
_Description = dict[str, object]


def type_hash(name: str, known: MessageFields) -> str:
    """Return the hash of a message type.

    Args:
        name: ``package/Name``.
        known: the fields of it and of all that it is made of.
    """
    parts = sorted(_parts(name, known) - {name})
    document = {
        "type_description": _described(name, known[name]),
        "referenced_type_descriptions": [_described(one, known[one]) for one in parts],
    }
    return f"RIHS01_{hashlib.sha256(json.dumps(document).encode()).hexdigest()}"


def _parts(name: str, known: MessageFields) -> set[str]:
    inner = {_item(of) for of in known[name].values()} - _IDS.keys()
    return {name}.union(*(_parts(one, known) for one in inner))


def _item(of: str) -> str:
    return of.partition("[")[0]


def _described(name: str, fields: Fields) -> _Description:
    rows = [{"name": field, "type": _type(of)} for field, of in (fields or _EMPTY).items()]
    return {"type_name": _full(name), "fields": rows}


def _type(of: str) -> _Description:
    match = _TYPE.fullmatch(of)
    assert match is not None, of
    item, array, length = match.groups()
    kind = 0 if array is None else _ARRAY if length else _SEQUENCE
    return {
        "type_id": _IDS.get(item, _NESTED) + kind,
        "capacity": int(length or 0),
        "string_capacity": 0,
        "nested_type_name": "" if item in _IDS else _full(item),
    }


def _full(name: str) -> str:
    return name.replace("/", "/msg/")
