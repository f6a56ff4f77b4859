"""Helpers for the hand-written lines of ``process_<input>``."""

from __future__ import annotations

from operator import attrgetter
from typing import Any, Iterable, Sequence, TypeVar, Union

from .plain_values import plain

T = TypeVar("T")
UNTOLD = "unknown there"
"""Why an input is not known where another monitor does not know it."""
Step = Union[str, int, Sequence[Union[str, int]]]
"""One step of a path into a message, see ``follow``."""


class NotGivenError(LookupError):
    """A message of a monitor does not tell what it is asked for: that is not known there."""


def given(value: T, *known: object) -> T:
    """Return a field of a monitor's message, where the message says that it is known.

    Args:
        value: the field.
        known: its values that are known by themselves; a tuple is another field, and values of
            that by which this one is known: ``given(event.active, (event.verdict, 0, 2))``.

    Raises:
        NotGivenError: it is not known; a claim that is not made need not be false.
    """
    for one in known:
        told, *wanted = one if isinstance(one, tuple) else (value, one)
        if told in wanted:
            return value
    raise NotGivenError(UNTOLD)


def by_id(items: Iterable[T], wanted: str) -> T:
    """Return the only element whose ``id`` equals ``wanted``.

    A ``ConSertOutput`` lists guarantees in an order that its author may change; an index, as in
    SESAME D7.2 Fig 44, would then read another guarantee without a word.

    Raises:
        LookupError: no element has that id, or several have; the message names what is there.
    """
    return by_key(items, "id", wanted)


def by_key(items: Iterable[T], key: str, wanted: str | int) -> T:
    """Return the only element whose field ``key`` (``title``, ``header.frame_id``) is ``wanted``.

    Raises:
        LookupError: no element has that key, or several have: none of them is the one that is
            meant.
    """
    take, first = attrgetter(key), key.partition(".")[0]
    keyed = [(take(item) if hasattr(item, first) else None, item) for item in items]
    return _only(f"the {key}", wanted, keyed)


def by_name(values: Sequence[T], names: Sequence[str], wanted: str) -> T:
    """Return the value at the position of ``wanted`` in the list of names.

    Raises:
        LookupError: there is no such name, or there are two, or as many names as values there
            are not (an ``effort`` that is left empty).
    """
    if len(values) != len(names):
        raise LookupError(f"{len(values)} values have {len(names)} names")
    return _only("the name", wanted, list(zip(names, values)))


def follow(message: object, path: Iterable[Step]) -> object:
    """Return the value at the end of a path in a message.

    A step is the name of a field, an index, ``[key, wanted]`` (see ``by_key``), or
    ``[values, names, wanted]`` (see ``by_name``).

    Raises:
        LookupError: an element is not there, or not alone.
        AttributeError: a message has no such field.
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
    found = [item for one, item in keyed if plain(one) == wanted]
    if len(found) == 1:
        return found[0]
    what = f"{len(found)} elements have" if found else "no element has"
    there = ", ".join(str(one) for one, _ in keyed) or "nothing"
    raise LookupError(f"{what} {key} {wanted!r}; there: {there}")


def joined(*parts: object) -> list[float]:
    """Return the numbers of several parts as one list, in this order.

    A part is a number, a sequence of numbers, or a message of ``std_msgs`` with ``layout`` and
    ``data``, whose ``data_offset`` is honoured.
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
