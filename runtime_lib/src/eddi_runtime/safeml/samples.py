"""Turn values of the robot into samples: any value is taken, and invalid ones are counted."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from ..history import Messages
from ..plain_values import plain
from .arrays import Array, rounded

EMPTY = "empty"
NOT_FINITE = "not_finite"
WRONG_LENGTH = "wrong_length"


class Taken(NamedTuple):
    """What one step brings."""

    rows: list[Array]  # samples (d,), in the order in which they came
    # why each other one cannot be used (``empty``, ``not_finite``, ``wrong_length``)
    bad: list[str]
    fault: str = ""  # what was wrong with the first of these, for people


def take(value: object, features: int, *, single: bool) -> Taken:
    """Read samples out of a value; never raises an Exception.

    Args:
        value: the messages since the last step, or a list of lists, one message each; or one
            message: numbers (d,), an array (r, d), a message of ``std_msgs`` with ``layout`` and
            ``data``, bytes. Booleans are no numbers, and a list in a list is no message.
        features: d.
        single: round to float32.
    """
    taken = Taken([], [])
    faults: list[str] = []
    for message in _messages(value):
        try:
            found = _array(message)
        except Exception as problem:  # noqa: BLE001, PERF203 - any object may come
            known = isinstance(problem, _NoNumbersError)
            name = str(problem) if known else type(problem).__name__
            faults.append(f"{'numbers are expected, not' if known else 'it is no array:'} {name}")
            taken.bad.append(WRONG_LENGTH)
        else:
            _sort_out(rounded(found, single=single), features, taken, faults)
    return taken._replace(fault=faults[0] if faults else "")


def _messages(value: Any) -> Any:
    """Return what counts as one message each: a list of lists may have rows of any length."""
    if isinstance(value, Messages):
        return value
    is_list = isinstance(value, (list, tuple)) and len(value) > 0
    return value if is_list and isinstance(value[0], (list, tuple, np.ndarray)) else (value,)


class _NoNumbersError(Exception):
    """What was given instead of numbers."""


def _array(message: Any) -> Any:
    """Return numbers as float64 (), (d,) or (r, d).

    Raises:
        _NoNumbersError: it is anything else; the text names it.
    """
    of = type(message).__name__
    shape: Any = None
    if hasattr(message, "layout") and hasattr(message, "data"):
        message, shape = _laid_out(message.layout, message.data)
    if isinstance(message, (bytes, bytearray)):
        message = np.frombuffer(message, dtype=np.uint8)
    elif isinstance(message, (list, tuple)):
        types = set(map(type, message))
        _check_elements(types)
        if bytes in types:  # each is a ``byte``, in rclpy
            message = [plain(one) for one in message]
    found = np.asarray(message)
    if found.dtype.kind == "b":
        raise _NoNumbersError("Booleans")
    if found.dtype.kind not in "fiu" or (found.ndim > 2 and found.size):
        raise _NoNumbersError(of)
    found = found.astype(np.float64)
    return found if shape is None else found.reshape(shape)


def _check_elements(types: set[type]) -> None:
    """Refuse what numpy would make numbers of, in a list: it was not meant as a sample."""
    if any(issubclass(type_name, (bool, np.bool_)) for type_name in types):
        raise _NoNumbersError("Booleans")
    if any(issubclass(type_name, (list, tuple, np.ndarray)) for type_name in types):
        raise _NoNumbersError("lists in a list")


def _laid_out(layout: Any, data: Any) -> Any:
    """Return data behind the offset, and its shape where the layout has two dimensions."""
    data = data[layout.data_offset :]
    sizes = [dimension.size for dimension in layout.dim]
    if len(sizes) == 2 and sizes[0] * sizes[1] == len(data):
        return data, (sizes[0], sizes[1])
    return data, None


def _sort_out(found: Array, features: int, taken: Taken, faults: list[str]) -> None:
    if found.size == 0:
        taken.bad.append(EMPTY)
        faults.append("the message is empty")
        return
    if found.ndim == 2 and found.shape[1] == features:
        rows = list(found)
    elif found.size == features:
        rows = [found.reshape(-1)]  # one sample that has a shape of its own, such as an image
    else:
        count, length = found.shape if found.ndim == 2 else (1, found.size)
        taken.bad.extend([WRONG_LENGTH] * count)
        shown = f"{length} value{'s' if length != 1 else ''}"
        faults.append(
            f"{shown}, the reference has {features} feature{'s' if features != 1 else ''}"
        )
        return
    for row in rows:
        if np.isfinite(row).all():
            taken.rows.append(row)
        else:
            taken.bad.append(NOT_FINITE)
            faults.append(f"feature {int(np.argmin(np.isfinite(row)))} is not a finite number")
