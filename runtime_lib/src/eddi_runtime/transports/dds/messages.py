"""Messages of ROS 2 as classes of cyclonedds, and what of them is believed when they arrive.

A writer of another type of the same name may match, and its bytes may decode. So bytes must have
exactly the length of the message that was made of them, and a Boolean must be 0 or 1.
"""

from __future__ import annotations

import time
from operator import attrgetter
from types import SimpleNamespace
from typing import Any, Callable, Mapping

from cyclonedds.idl import make_idl_struct, types

from ...node.topics import Converter

_PRIMITIVES: Mapping[str, tuple[Any, Callable[[], object]]] = {
    "bool": (bool, bool),
    "string": (str, str),
    "byte": (types.uint8, int),
    "char": (types.uint8, int),
    **{f"float{n}": (getattr(types, f"float{n}"), float) for n in (32, 64)},
    **{
        f"{s}int{n}": (getattr(types, f"{s}int{n}"), int)
        for s in ("", "u")
        for n in (8, 16, 32, 64)
    },
}
_HEADER, _PADDING = 4, 3
_EMPTY = {"structure_needs_at_least_one_member": "uint8"}


class Unreadable:
    """Bytes that are no message of the expected type."""


def _filled(message: Any, /, **fields: object) -> None:
    """Set the fields of a new message; those that are not given have the value of nothing."""
    for name, make in message.MAKERS.items():
        setattr(message, name, fields[name] if name in fields else make())


def _read(cls: Any, data: bytes, /, **more: object) -> object:
    """Return the message in bytes, or ``Unreadable``; cyclonedds calls it."""
    try:
        message = cls.__idl__.deserialize(data, **more)
        again: bytes = message.serialize()
    except Exception:  # noqa: BLE001 - struct, Unicode, memory: whatever the bytes lead to
        return Unreadable()
    surplus = len(data) - len(again)
    if data[1:2] != again[1:2] or not 0 <= surplus <= _PADDING:
        return Unreadable()
    if data[_HEADER : len(again)] == again[_HEADER:]:
        return message
    # what differs may be padding, which is 0; a Boolean that was neither 0 nor 1 became 1
    spoilt = any(new == 1 != old for old, new in zip(data[_HEADER:], again[_HEADER:]))
    return Unreadable() if spoilt else message


def message_classes(
    definitions: Mapping[str, str], hashes: Mapping[str, str] = {}
) -> SimpleNamespace:
    """Return the classes of messages by name: ``std_msgs_Bool``.

    ``MAKERS`` of a class: field -> makes its first value. Definitions are ``type field, type
    field``, used ones first; hashes are those of ROS 2 since Iron.
    """
    made: dict[str, Any] = {}
    for name, text in definitions.items():
        pairs = [part.split() for part in text.split(",") if part.strip()]
        fields = {field: of for of, field in pairs} or _EMPTY
        built = {field: _built(of, made) for field, of in fields.items()}
        package, _, short = name.partition("/")
        cls = make_idl_struct(
            short,
            f"{package}::msg::dds_::{short}_",
            {field: of for field, (of, _) in built.items()},
            dataclassify=False,
        )
        cls.TYPE, cls.FIELDS = name, fields if pairs else {}
        cls.HASH = hashes.get(name, "")
        cls.MAKERS = {field: make for field, (_, make) in built.items()}
        cls.__init__, cls.deserialize = _filled, classmethod(_read)  # a base would be one of IDL
        made[name] = cls
    return SimpleNamespace(**{name.replace("/", "_"): cls for name, cls in made.items()})


def _built(of: str, made: Mapping[str, Any]) -> tuple[Any, Callable[[], object]]:
    """Return a type for cyclonedds, and what makes its first value."""
    if not of.endswith("]"):
        return _PRIMITIVES[of] if of in _PRIMITIVES else (made[of], made[of])
    item, _, length = of[:-1].rpartition("[")
    inner, make = _built(item, made)
    if length.isdecimal():
        count = int(length)
        if inner is types.uint8:
            return types.array[inner, count], lambda: bytes(count)
        return types.array[inner, count], lambda: [make() for _ in range(count)]
    if length:
        return types.sequence[inner, int(length.lstrip("<="))], list
    return types.sequence[inner], list


OWN = message_classes(
    {
        "builtin_interfaces/Time": "int32 sec, uint32 nanosec",
        "rosgraph_msgs/Clock": "builtin_interfaces/Time clock",
        "std_msgs/Header": "builtin_interfaces/Time stamp, string frame_id",
        "diagnostic_msgs/KeyValue": "string key, string value",
        "diagnostic_msgs/DiagnosticStatus": "byte level, string name, string message,"
        " string hardware_id, diagnostic_msgs/KeyValue[] values",
        "diagnostic_msgs/DiagnosticArray": "std_msgs/Header header,"
        " diagnostic_msgs/DiagnosticStatus[] status",
    },
    {
        "diagnostic_msgs/DiagnosticArray": "RIHS01_"
        "5a8a36efb05fb25070fa0fb3810290c0e6cd4862b54a8fb975a1ee8dc55a333e"
    },
)
"""What every node publishes, and the clock of a simulation."""


def stamp() -> object:
    """Return the present wall time for a header."""
    seconds, rest = divmod(time.time_ns(), 1_000_000_000)
    return OWN.builtin_interfaces_Time(sec=seconds, nanosec=rest)


def converter(messages: SimpleNamespace, package: str = "eddi_messages") -> Converter:
    """Return what makes those of a package of what ``message_classes`` returned."""
    begin = f"{package}_"
    own = {name[len(begin) :]: of for name, of in vars(messages).items() if name.startswith(begin)}
    module: Any = SimpleNamespace(__name__=f"{package}.msg", **own)
    return Converter(module, lambda cls: cls.FIELDS.items(), attrgetter("TYPE"), stamp)
