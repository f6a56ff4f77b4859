"""What is compared: samples out of values of the robot, and their principal components."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from ..history import Messages
from ..plain_values import plain
from .arrays import Array, Numbers, array_of, rounded

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
    """Read samples of ``features`` numbers out of any value, count invalid ones; never raises.

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
    """Return numbers as float64 (), (d,) or (r, d), else raise _NoNumbersError."""
    of = type(message).__name__
    shape: Any = None
    if hasattr(message, "layout") and hasattr(message, "data"):
        message, shape = _laid_out(message.layout, message.data)
    if isinstance(message, (bytes, bytearray)):
        message = np.frombuffer(message, dtype=np.uint8)
    elif isinstance(message, (list, tuple)):
        # What numpy would make numbers of in a list was not meant as a sample.
        types = set(map(type, message))
        if any(issubclass(type_name, (bool, np.bool_)) for type_name in types):
            raise _NoNumbersError("Booleans")
        if any(issubclass(type_name, (list, tuple, np.ndarray)) for type_name in types):
            raise _NoNumbersError("lists in a list")
        if bytes in types:  # each is a ``byte``, in rclpy
            message = [plain(one) for one in message]
    found = np.asarray(message)
    if found.dtype.kind == "b":
        raise _NoNumbersError("Booleans")
    if found.dtype.kind not in "fiu" or (found.ndim > 2 and found.size):
        raise _NoNumbersError(of)
    found = found.astype(np.float64)
    return found if shape is None else found.reshape(shape)


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


class Axes:
    """Principal axes of some rows: the means, the divisors, and the axes by falling variance.

    The generator prepares references and thresholds with this code, and projections of the
    reference are found by the machine that compares, one by one: an equal row becomes equal
    numbers to the last bit. ``floor``: length up to which what the axes leave out counts as 0;
    None: it is not tested.
    """

    def __init__(self, numbers: Numbers, floor: float | None = None) -> None:
        found = array_of(numbers)
        self.centre, self.scale, self.vectors = found[0], found[1], found[2:]
        self._floor = floor
        names = [f"component {k}" for k in range(len(self.vectors))]
        self.labels = tuple(names if floor is None else [*names, "residual"])

    def values(self, sample: Array) -> Array:
        """Return the value of each test (K,) for one sample (d,); too large ones are infinite."""
        with np.errstate(over="ignore", invalid="ignore"):
            centred = (sample - self.centre) / self.scale
            found = self.vectors @ centred
            if self._floor is not None:
                rest = centred - found @ self.vectors
                size = float(np.sqrt(rest @ rest))
                found = np.append(found, size if size >= self._floor else 0.0)
        return found if np.isfinite(found).all() else np.where(np.isnan(found), np.inf, found)

    def series(self, rows: Array) -> Array:
        """Return the values of many samples, (K, rows); one by one, see the class."""
        return np.ascontiguousarray(np.array([self.values(row) for row in rows]).T)

    def weights(self, test: int, most: int = 3) -> list[tuple[int, float]]:
        """Return the features that weigh most in a component, with their weights."""
        if test >= len(self.vectors):
            return []
        vector = self.vectors[test]
        order = np.argsort(-np.abs(vector), kind="stable")[:most]
        return [(int(k), float(vector[k])) for k in order]
