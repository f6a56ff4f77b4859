"""Helpers for the hand-written lines of ``process_<input>``."""

from __future__ import annotations

from typing import Any, Iterable, List, TypeVar

T = TypeVar("T")


def by_id(items: Iterable[T], wanted: str) -> T:
    """Return the first element whose ``id`` equals ``wanted``.

    A ``ConSertOutput`` lists guarantees in an order that its author may change; an index, as in
    SESAME D7.2 Fig 44, would then read another guarantee without a word.

    Raises:
        LookupError: no element has that id; the message names the ids that are there.
    """
    there = []
    for item in items:
        found = getattr(item, "id", None)
        if found == wanted:
            return item
        there.append(str(found))
    listed = ", ".join(there) if there else "nothing"
    raise LookupError(f"no element has the id {wanted!r}; there: {listed}")


def joined(*parts: Any) -> List[Any]:
    """Return the numbers of several parts as one list, in this order.

    A part is a number, a sequence of numbers, or a message of ``std_msgs`` with ``layout`` and
    ``data``, whose ``data_offset`` is honoured.
    """
    numbers: List[Any] = []
    for part in parts:
        data = part.data[part.layout.data_offset :] if hasattr(part, "layout") else part
        if hasattr(data, "__iter__"):
            numbers.extend(data)
        else:
            numbers.append(data)
    return numbers
