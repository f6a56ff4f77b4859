"""Messages of rclpy: their fields as a ``.msg`` file spells them, and statuses as a message."""

from __future__ import annotations

import re
from types import ModuleType
from typing import Any, Callable, Iterable

from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus, KeyValue

from ...node.health import Status
from ...node.outputs import Converter, MessageClasses

_SPELT = {"boolean": "bool", "float": "float32", "double": "float64", "octet": "byte"}
_SEQUENCE = re.compile(r"sequence<(.*?)(?:, (\d+))?>")
_ARRAY = re.compile(r"(.*)(\[\d+\])")


def msg_type(of: str) -> str:
    """Return a type of a field: ``float64[]`` of ``sequence<double>``."""
    sequence = _SEQUENCE.fullmatch(of)
    if sequence is not None:
        item, most = sequence.groups()
        return f"{msg_type(item)}[{f'<={most}' if most else ''}]"
    array = _ARRAY.fullmatch(of)
    if array is not None:
        return msg_type(array.group(1)) + array.group(2)
    return _SPELT.get(of, of)


def _fields(cls: Any) -> Iterable[tuple[str, str]]:
    return ((name, msg_type(of)) for name, of in cls.get_fields_and_field_types().items())


def ros_type(message: object) -> str:
    """Return ``package/Name`` of a message or of its class."""
    cls = message if isinstance(message, type) else type(message)
    return f"{cls.__module__.partition('.')[0]}/{cls.__name__}"


def converter(messages: ModuleType, stamp: Callable[[], object]) -> Converter:
    """Return what makes messages of a package.

    Args:
        messages: module that holds the message classes by name (``eddi_messages.msg``).
        stamp: returns the present time for a header.
    """
    return Converter(MessageClasses(messages, _fields, ros_type, stamp))


def diagnostics_of(statuses: list[Status], stamp: object) -> object:
    """Return statuses as one message."""
    array = DiagnosticArray(
        status=[
            DiagnosticStatus(
                level=bytes([status.report.level]),
                name=status.name,
                message=status.report.message,
                hardware_id=status.node,
                values=[KeyValue(key=key, value=value) for key, value in status.report.values],
            )
            for status in statuses
        ]
    )
    array.header.stamp = stamp
    return array
