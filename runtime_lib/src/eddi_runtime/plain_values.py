"""Any value that an input may hold: read, as a plain Python value, or as a short text.

Robot messages and people's methods hand over numpy scalars, subclasses and proxies: all of them
are asked here, by methods that they cannot override.
"""

from __future__ import annotations

import sys
from typing import Any


def plain(raw: object) -> bool | int | float | str | None:
    """Return a bool, int, float or str of exactly that type; None for every other; never raises.

    Types are asked with ``type()`` and converted by the methods of the built-in types, so nothing
    that a subclass or a proxy overrides (``__class__``, ``__float__``, ``__eq__``) is called. A
    ``byte`` of a message is ``bytes`` of length 1 in rclpy, and a number everywhere else.
    """
    if raw is None or type(raw) is float or type(raw) is bool:
        return raw
    if type(raw) is int or type(raw) is str:
        return raw
    if type(raw) is bytes and len(raw) == 1:
        return raw[0]
    kind = type(raw)
    numpy = sys.modules.get("numpy")  # a numpy scalar cannot exist before numpy is imported
    if issubclass(kind, getattr(numpy, "generic", ())):  # nor while another thread imports it
        return _plain_numpy(raw, kind, numpy)
    # "isinstance" also believes "__class__": it only tells mypy what "issubclass" has found.
    if issubclass(kind, float) and isinstance(raw, float):
        return float.__float__(raw)
    if issubclass(kind, int) and isinstance(raw, int):
        return int.__int__(raw)
    if issubclass(kind, str):
        return str.__str__(raw)
    return None


def _plain_numpy(raw: Any, kind: type, numpy: Any) -> bool | int | float | str | None:
    if issubclass(kind, numpy.timedelta64):  # a duration, though numpy calls it an integer
        return None
    item = numpy.generic.item(raw)
    if type(item) is numpy.longdouble:  # it has no Python twin and is its own item
        item = float(item)
    return item if type(item) in (bool, int, float, str) else None


def is_nan(raw: object) -> bool:
    """Return whether a value is the number NaN; never raises."""
    value = plain(raw)
    return type(value) is float and value != value  # noqa: PLR0124 - NaN


def show(raw: object) -> str:
    """Return a short text of any value; never raises."""
    value = plain(raw)
    if value is None:
        return f"an object of type {type_name(raw)}"
    if isinstance(value, int) and value.bit_length() > 256:
        return f"a whole number of {value.bit_length()} bits"
    text = repr(value)
    return text if len(text) <= 60 else f"{text[:57]}..."


def type_name(raw: object) -> str:
    """Return the name of the type, also when its metaclass hides it."""
    return str(type.__dict__["__name__"].__get__(type(raw)))[:60]


def one_line(problem: BaseException) -> str:
    """Return a problem in one line that every transport can send; never raises."""
    try:
        whole = str(problem).encode("utf-8", "backslashreplace").decode("utf-8")
        text = " ".join(whole.split())[:300]
    except Exception:  # noqa: BLE001 - an exception may fail to print itself
        text = "it cannot be printed"
    return f"{type(problem).__name__}: {text}" if text else type(problem).__name__


class Absent:
    """Represents an attribute that could not be read."""

    __slots__ = ("problem",)

    def __init__(self, problem: str = "") -> None:
        self.problem = problem  # empty when the object simply has no such attribute


ABSENT = Absent()


def read(source: object, attribute: str, input_id: str) -> object:
    """Return the value of an attribute, an ``Absent`` where it cannot be read; never raises.

    An object that was not generated may hold an id that is no identifier as it is.
    """
    for name in (attribute, input_id):
        try:
            return getattr(source, name)
        except AttributeError:  # noqa: PERF203 - the second is rare
            continue
        except Exception as problem:  # noqa: BLE001 - a property may raise anything
            return Absent(f"reading it raised {type_name(problem)}")
    return ABSENT
