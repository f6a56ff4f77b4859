"""Reductions of the lists of a message: the nearest obstacle of a scan, the share of what holds."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

AGGREGATES = ("list_min", "list_max", "list_median", "list_sum", "list_average", "list_stddev")
"""Reductions of numbers."""
TRUTHS = ("list_count", "list_any", "list_all")
"""Reductions of truth values."""
OPERATIONS = (
    *("neg", "abs", "sqrt", "least", "greatest", "add", "sub", "mul", "div"),
    *("lt", "le", "gt", "ge", "eq", "ne", "eq_bool", "ne_bool"),
    *("xor", "and", "or", "not", "implies", "known", "known_bool"),
)
"""What can be done with one element and with numbers of its message."""


@dataclass(frozen=True)
class Part:
    """A list or a number of the message.

    Attributes:
        name: as in the text.
        type: ``number``, ``bool`` or ``text``.
        is_list: a list of these.
        range: least and greatest value; None for no limits.
        infinite: infinity is a value.
    """

    name: str
    type: str
    is_list: bool
    range: tuple[float, float] | None
    infinite: bool


@dataclass(frozen=True)
class Element:
    """An operation on elements, or on numbers of the message.

    Attributes:
        op: ``input``, ``constant``, or one of ``OPERATIONS``.
        args: numbers of the nodes it works on.
        value: number of the input, or the constant.
        is_list: it has a value for each element.
    """

    op: str
    args: tuple[int, ...]
    value: Any
    is_list: bool


@dataclass(frozen=True)
class Reduction:
    """One value of the lists of a message.

    Attributes:
        op: one of ``AGGREGATES`` or ``TRUTHS``.
        inputs: what it reads, lists first or last as they come.
        nodes: what is computed, each argument before its use.
        value: number of the node that is reduced.
        limits: input, and the nodes of its limits.
        coverage: share of known elements that is enough; None: all.
        length: least and most elements; None: any.
        sector: angles from and to; None: all.
        angles: numbers of the inputs with the angles of the scan.
        messages: a list of messages can be empty.
    """

    op: str
    inputs: tuple[Part, ...]
    nodes: tuple[Element, ...]
    value: int
    limits: tuple[tuple[int, int, int], ...]
    coverage: float | None
    length: tuple[int, int] | None
    sector: tuple[float, float] | None
    angles: tuple[int, ...]
    messages: bool
