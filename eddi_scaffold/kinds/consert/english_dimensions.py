"""Dimensions that the older ConSert dialect (DEIS 2019) writes as English text.

``Communication Delay bound to < 300.5 ms: ASIL B`` is a numeric dimension with an integrity
level. Rules: those of conserts-rs 0.1.6, except that an open bound is infinite, that ``> x``
excludes x, and that a bound which cannot be read gives a binary dimension and a remark.
"""

from __future__ import annotations

import math
import re
from dataclasses import dataclass

from eddi_scaffold.common.units import find as find_unit
from eddi_scaffold.kinds.consert.model import (
    BinaryDimension,
    Bound,
    Dimension,
    NumericDimension,
    Range,
)
from eddi_scaffold.kinds.consert.names import class_name

# The first of this order that occurs anywhere wins, as in the peer.
_OPERATORS = ("<=", ">=", "<", ">", "bound to")
_BOUND = re.compile(r"([0-9]+(?:\.[0-9]*)?|\.[0-9]+)\s*(\S+)?")
_ZERO = Bound("0.0", 0.0)
_INFINITY = Bound("inf", math.inf)


@dataclass(frozen=True)
class EnglishDimension:
    """Meaning of one text.

    Attributes:
        dimension: the dimension.
        integrity_level: the text behind the first colon (``ASIL D``), ``None`` without one.
        remark: why a bound could not be read, ``None`` when all is well.
    """

    dimension: Dimension
    integrity_level: str | None = None
    remark: str | None = None


def read_english(text: str) -> EnglishDimension:
    """Read a dimension from English text."""
    statement, colon, level = text.partition(":")
    statement = statement.strip()
    integrity_level = level.strip() or None if colon else None
    operator = next((o for o in _OPERATORS if o in statement), None)
    if operator is None:
        remark = "there is no operator <=, >=, <, > or bound to" if "=" in statement else None
        return EnglishDimension(_binary(statement), integrity_level, remark)
    subject, _, rest = statement.partition(operator)
    bound = _BOUND.fullmatch(rest.strip())
    remark = _objection(subject, rest, bound)
    if bound is None or remark is not None:
        return EnglishDimension(_binary(statement), integrity_level, remark)
    covered = _range(operator, Bound(bound.group(1), float(bound.group(1))))
    kind = class_name(subject)
    dimension = NumericDimension(kind, (covered,), "Guarantee", bound.group(2))
    return EnglishDimension(dimension, integrity_level)


def _objection(subject: str, rest: str, bound: re.Match[str] | None) -> str | None:
    if bound is None:
        return f'"{rest.strip()}" is not a number with a unit'
    unit = bound.group(2)
    if unit is not None and find_unit(unit) is None:
        return f'the unit "{unit}" is unknown'
    return None if class_name(subject) else "there is nothing before the operator"


def _binary(statement: str) -> BinaryDimension:
    return BinaryDimension(class_name(statement) or statement)


def _range(operator: str, bound: Bound) -> Range:
    if operator == ">=":
        return Range(bound, _INFINITY, inclusive=True)
    if operator == ">":
        # A range always contains its start, so it starts at the next double.
        above = math.nextafter(bound.value, math.inf)
        return Range(Bound(repr(above), above), _INFINITY, inclusive=True)
    return Range(_ZERO, bound, inclusive=operator != "<")
