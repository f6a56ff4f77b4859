"""Any value that an input may hold: in a message, read, as a plain value, as a short text."""

from __future__ import annotations

import sys
from operator import attrgetter
from types import SimpleNamespace
from typing import Any, Iterable, Sequence, TypeVar, Union

T = TypeVar("T")


def plain(raw: object) -> bool | int | float | str | None:
    """Return a bool, int, float or str of exactly that type; None for every other; never raises.

    Nothing that a subclass or a proxy overrides (``__class__``, ``__eq__``) is called. A ``byte``
    of a message is ``bytes`` of length 1 in rclpy, and a number everywhere else.
    """
    if raw is None or type(raw) is float or type(raw) is bool:
        return raw
    if type(raw) is int or type(raw) is str:
        return raw
    if type(raw) is bytes and len(raw) == 1:
        return raw[0]
    kind = type(raw)
    item: Any = raw
    numpy: Any = sys.modules.get("numpy")  # a numpy scalar cannot exist before numpy is imported
    if issubclass(kind, getattr(numpy, "generic", ())):  # nor while another thread imports it
        if issubclass(kind, numpy.timedelta64):  # a duration, though numpy calls it an integer
            return None
        item = numpy.generic.item(raw)
        if type(item) is numpy.longdouble:  # it has no Python twin and is its own item
            item = float(item)
        return item if type(item) in (bool, int, float, str) else None
    if issubclass(kind, float):
        return float.__float__(item)
    if issubclass(kind, int):
        return int.__int__(item)
    return str.__str__(item) if issubclass(kind, str) else None


def exactly(kind: type[T], raw: object) -> T:
    """Return a value of a type as a plain one, else TypeError."""
    value: Any = plain(raw)
    if type(value) is not kind:
        raise TypeError(f"{show(raw)} is no {kind.__name__}")
    return value


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
    """Return the value of an attribute, an ``Absent`` where it cannot be read; never raises."""
    for name in (attribute, input_id):
        try:
            return getattr(source, name)
        except AttributeError:  # noqa: PERF203 - the second is rare
            continue
        except Exception as problem:  # noqa: BLE001 - a property may raise anything
            return Absent(f"reading it raised {type_name(problem)}")
    return ABSENT


def as_message(said: object) -> object:
    """Return what ``message`` of a monitor gives as an object with its fields, else as it is."""
    tree: Any = said[0] if type(said) is list and len(said) == 1 else said
    if type(tree) is not tuple or len(tree) != 2 or type(tree[1]) is not dict:
        return said
    fields = tree[1].items()
    return SimpleNamespace(
        **{
            name: [as_message(item) for item in value]
            if type(value) is list
            else as_message(value)
            for name, value in fields
        }
    )


UNTOLD = "unknown there"  # why an input is not known where another monitor does not know it
Step = Union[str, int, Sequence[Union[str, int]]]
"""One step of a path into a message, see ``follow``."""


class NotGivenError(LookupError):
    """A message of a monitor does not tell what it is asked for: that is not known there."""


def given(value: T, *known: object) -> T:
    """Return a field of a monitor's message if that says that it is known, else NotGivenError.

    ``known``: values that are known by themselves; a tuple is another field and values of that by
    which this one is known: ``given(event.active, (event.verdict, 0, 2))``.
    """
    for entry in known:
        told, *wanted = entry if isinstance(entry, tuple) else (value, entry)
        if told in wanted:
            return value
    raise NotGivenError(UNTOLD)


def by_id(items: Iterable[T], wanted: str) -> T:
    """Return the only element with this ``id``, else LookupError: the order may change."""
    return by_key(items, "id", wanted)


def by_key(items: Iterable[T], key: str, wanted: str | int) -> T:
    """Return the only element whose field ``key`` (``header.frame_id``) is that (LookupError)."""
    take, first = attrgetter(key), key.partition(".")[0]
    keyed = [(take(item) if hasattr(item, first) else None, item) for item in items]
    return _only(f"the {key}", wanted, keyed)


def by_name(values: Sequence[T], names: Sequence[str], wanted: str) -> T:
    """Return the value at the place of a name, else LookupError, also with as many names not."""
    if len(values) != len(names):
        raise LookupError(f"{len(values)} values have {len(names)} names")
    return _only("the name", wanted, list(zip(names, values)))


def follow(message: object, path: Iterable[Step]) -> object:
    """Return the value at the end of a path in a message; else LookupError, AttributeError.

    A step is the name of a field, an index, ``[key, wanted]`` (see ``by_key``), or ``[values,
    names, wanted]`` (see ``by_name``).
    """
    there: Any = message
    for step in path:
        if isinstance(step, str):
            there = getattr(there, step)
        elif isinstance(step, int):
            there = there[step]
        elif len(step) == 2:
            there = by_key(there, str(step[0]), step[1])
        else:
            values, names, wanted = (str(part) for part in step)
            there = by_name(getattr(there, values), getattr(there, names), wanted)
    return plain(there) if type(there) is bytes and len(there) == 1 else there


def _only(key: str, wanted: object, keyed: Sequence[tuple[object, T]]) -> T:
    items = [item for item_key, item in keyed if plain(item_key) == wanted]
    if len(items) == 1:
        return items[0]
    what = f"{len(items)} elements have" if items else "no element has"
    there = ", ".join(str(item_key) for item_key, _ in keyed) or "nothing"
    raise LookupError(f"{what} {key} {wanted!r}; there: {there}")


def joined(*parts: object) -> list[float]:
    """Return the numbers of several parts as one list, in this order.

    A part is a number, numbers, or ``layout`` and ``data`` of std_msgs, behind its
    ``data_offset``.
    """
    numbers: list[float] = []
    given: Iterable[Any] = parts
    for part in given:
        layout = getattr(part, "layout", None)
        data = part if layout is None else part.data[slice(layout.data_offset, None)]
        if hasattr(data, "__iter__"):
            numbers.extend(data)
        else:
            numbers.append(data)
    return numbers
