"""Messages of ROS 1 from their bytes; a message is believed only as far as it is one."""

from __future__ import annotations

import struct
from collections.abc import Callable, Mapping
from functools import cache
from types import SimpleNamespace
from typing import Any

from eddi_scaffold.config.message_types import Fields, element, fields_of, known_messages

Decode = Callable[[bytes, int], tuple[Any, int]]
"""Bytes and where a value begins -> the value, and where it ends; raises DecodingError."""

_LENGTH = struct.Struct("<I")
_NUMBERS = {
    "bool": "?", "byte": "b", "char": "B", "int8": "b", "uint8": "B", "int16": "h", "uint16": "H",
    "int32": "i", "uint32": "I", "int64": "q", "uint64": "Q", "float32": "f", "float64": "d",
}  # fmt: skip
_HEADER = "std_msgs/Header"
_STAMPED = 16
"""Bytes of a header before its frame: number, stamp, and the length of the frame."""


class DecodingError(ValueError):
    """The bytes are no message of this type."""


def decode(type_: str, data: bytes) -> Any:
    """Return a message with its fields as attributes.

    Args:
        type_: ``package/Name``, a known one.
        data: all bytes of it.

    Raises:
        DecodingError: they are no message of this type.
    """
    try:
        message, end = _decoder(type_)(data, 0)
    except (struct.error, UnicodeDecodeError, RecursionError):
        raise DecodingError(f"not a message {type_}") from None
    if end != len(data):
        raise DecodingError(f"{len(data) - end} bytes behind a message {type_}")
    return message


def without_stamp(type_: str, data: bytes) -> bytes:
    """Return the bytes of a message behind the stamp of its header, if it has one."""
    return data[_STAMPED:] if _HEADER in _first(known_messages()[type_]) else data


def same_definition(type_: str, text: str) -> bool:
    """Return whether a publisher's definition is the known one, with all that it is made of.

    Args:
        type_: ``package/Name``, a known one.
        text: as the head of a connection has it: definitions between lines of ``=``, all but the
            first after a line ``MSG: package/Name``.
    """
    first, *others = text.split("=" * 80 + "\n")
    theirs = {type_: fields_of(first, type_.partition("/")[0])}
    for other in others:
        head, _, body = other.partition("\n")
        name = head.removeprefix("MSG: ").strip()
        theirs[name] = fields_of(body, name.partition("/")[0])
    return _same(type_, theirs)


def _same(type_: str, theirs: Mapping[str, Fields]) -> bool:
    ours = known_messages()[type_]
    if list(ours.items()) != list(theirs.get(type_, {}).items()):
        return False
    parts = ((element(of) or of) for of in ours.values())
    return all(_same(part, theirs) for part in parts if "/" in part)


def _first(fields: Fields) -> tuple[str, ...]:
    return tuple(fields.values())[:1]


@cache
def _decoder(kind: str) -> Decode:
    inner = element(kind)
    if inner is not None:
        return _list(_decoder(inner), kind)
    if kind == "string":
        return _string
    if kind in _NUMBERS:
        return _number(struct.Struct(f"<{_NUMBERS[kind]}"))
    return _message({field: _decoder(of) for field, of in known_messages()[kind].items()})


def _number(of: struct.Struct) -> Decode:
    def read(data: bytes, at: int) -> tuple[Any, int]:
        return of.unpack_from(data, at)[0], at + of.size

    return read


def _string(data: bytes, at: int) -> tuple[str, int]:
    end = at + 4 + _LENGTH.unpack_from(data, at)[0]
    if end > len(data):
        raise DecodingError("a text that is too short")
    return data[at + 4 : end].decode(), end


def _list(read: Decode, kind: str) -> Decode:
    fixed = kind[kind.index("[") + 1 : -1]

    def read_all(data: bytes, at: int) -> tuple[list[Any], int]:
        if fixed:
            count = int(fixed)
        else:
            (count,), at = _LENGTH.unpack_from(data, at), at + 4
        if count > len(data) - at:  # each element has a byte at least
            raise DecodingError("a list that is too short")
        found = []
        for _ in range(count):
            one, at = read(data, at)
            found.append(one)
        return found, at

    return read_all


def _message(fields: Mapping[str, Decode]) -> Decode:
    pairs = tuple(fields.items())

    def read(data: bytes, at: int) -> tuple[SimpleNamespace, int]:
        found = {}
        for name, pair in pairs:
            found[name], at = pair(data, at)
        return SimpleNamespace(**found), at

    return read
