"""The few array functions that the statistics need, by numpy or CuPy."""

from __future__ import annotations

from typing import Any

import numpy as np

Array = Any
"""An array of the backend: ``numpy.ndarray``, ``cupy.ndarray`` or ``torch.Tensor``."""


class Backend:
    """Array functions under one name: numpy itself, or CuPy, which has its names.

    "Last" is the last axis of an array.

    Attributes:
        name: ``numpy``, ``torch`` or ``cupy``.
    """

    def __init__(self, module: Any, name: str = "numpy") -> None:
        self.name = name
        self._xp = module

    def array(self, values: Any) -> Array:
        """Return numpy values as an array of this backend."""
        return self._xp.asarray(values)

    def numpy(self, values: Array) -> Array:
        """Return an array as one of numpy."""
        return values if self.name == "numpy" else self._xp.asnumpy(values)

    def sort(self, values: Array) -> Array:
        """Return a copy that is sorted along the last axis."""
        return self._xp.sort(values, axis=-1)

    def highest(self, values: Array) -> Array:
        """Return the maximum along the last axis."""
        return values.max(axis=-1)

    def lowest(self, values: Array) -> Array:
        """Return the minimum along the last axis."""
        return values.min(axis=-1)

    def larger(self, one: Array, other: Array) -> Array:
        """Return the larger one of each two elements."""
        return self._xp.maximum(one, other)

    def doubles(self, values: Array) -> Array:
        """Return the values as float64."""
        return values.astype(self._xp.float64)

    def positions(self, flat: Array, keys: Array) -> Array:
        """Return for each key how many elements of a sorted flat array are <= it."""
        return self._xp.searchsorted(flat, keys, side="right")

    def count(self, truths: Array) -> int:
        """Return how many elements are true."""
        return int(self._xp.count_nonzero(truths))

    def ranks(self, rows: Array, values: Array, *, equal: bool) -> Array:
        """Count in each sorted row what is below each value of the same row.

        Args:
            rows: (K, n), each row ascending.
            values: (K, q).
            equal: count what is equal to the value as well.

        Returns:
            Whole numbers (K, q).
        """
        side = "right" if equal else "left"
        found = [
            self._xp.searchsorted(row, one, side=side)  # (q,)
            for row, one in zip(rows, values)
        ]
        return self._xp.stack(found).astype(self._xp.int64)


NUMPY = Backend(np)
"""The backend that is always there."""


def rounded(values: Array, *, single: bool) -> Array:
    """Return float64 values that float32 can hold, where samples are float32."""
    if not single:
        return values
    with np.errstate(over="ignore"):  # what becomes infinite is refused as such
        return values.astype(np.float32).astype(np.float64)
