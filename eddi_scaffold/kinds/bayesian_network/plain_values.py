"""Plain values of a configuration, as inputs can have them and doubles can hold them."""

from __future__ import annotations

import math
import sys
from typing import TypeGuard

from eddi_scaffold.kinds import InputType, JsonValue

TRUTH = {"true": True, "false": False}
"""Keys of maps are texts; those that mean a bool."""


def is_number(value: object) -> TypeGuard[int | float]:
    """Return whether a value is a number that a double can hold; NaN and infinity are."""
    if isinstance(value, bool) or not isinstance(value, int | float):
        return False
    return isinstance(value, float) or abs(value) <= sys.float_info.max


def is_raw(value: object) -> bool:
    """Return whether an input can have this value and JSON can hold it."""
    if isinstance(value, bool | str):
        return True
    return isinstance(value, int | float) and is_number(value) and math.isfinite(value)


def as_integer(text: str) -> int | None:
    """Return the integer that a key of a map is, ``None`` for others."""
    try:
        return int(text)
    except ValueError:
        return None


def value_of(key: str, of: InputType) -> JsonValue:
    """Return the value that a key of a map means, by the type of the input."""
    if of == "bool":
        return TRUTH.get(key)
    if of == "int":
        return as_integer(key)
    if of == "float":
        try:
            return float(key)
        except ValueError:
            return None
    return key
