"""The few array functions that the statistics need, by numpy, CuPy or PyTorch.

numpy is the default. The others are used when the configuration asks for them and they are
installed; nothing of them is ever required.
"""

from __future__ import annotations

import importlib
import warnings
from typing import Any, Protocol, Sequence

import numpy as np

Array = Any
"""An array of the backend: ``numpy.ndarray``, ``cupy.ndarray`` or ``torch.Tensor``."""

NAMES = ("numpy", "torch", "cupy")
"""What ``array_backend:`` may be."""


class Backend(Protocol):
    """Array functions under one name. "Last" is the last axis of an array.

    Attributes:
        name: ``numpy``, ``torch`` or ``cupy``.
    """

    name: str

    def array(self, values: Any) -> Array:
        """Return numpy values as an array of this backend."""

    def numpy(self, values: Array) -> Array:
        """Return an array as one of numpy."""

    def sort(self, values: Array) -> Array:
        """Return a copy that is sorted along the last axis."""

    def highest(self, values: Array) -> Array:
        """Return the maximum along the last axis."""

    def lowest(self, values: Array) -> Array:
        """Return the minimum along the last axis."""

    def larger(self, one: Array, other: Array) -> Array:
        """Return the larger one of each two elements."""

    def at_least(self, values: Array, bound: int) -> Array:
        """Return the elements, those below ``bound`` replaced by it."""

    def take(self, flat: Array, index: Array) -> Array:
        """Return ``flat[index]``: the shape of ``index``, elements of a flat array."""

    def doubles(self, values: Array) -> Array:
        """Return the values as float64."""

    def positions(self, flat: Array, keys: Array) -> Array:
        """Return for each key how many elements of a sorted flat array are <= it."""

    def count(self, truths: Array) -> int:
        """Return how many elements are true."""

    def ranks(self, rows: Array, values: Array, *, equal: bool) -> Array:
        """Count in each sorted row what is below each value of the same row.

        Args:
            rows: (K, n), each row ascending.
            values: (K, q).
            equal: count what is equal to the value as well.

        Returns:
            Whole numbers (K, q).
        """

    def join(self, parts: Sequence[Array]) -> Array:
        """Join arrays along the first axis."""


class NumpyLike:
    """numpy itself, or CuPy, which has its names."""

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

    def at_least(self, values: Array, bound: int) -> Array:
        """Return the elements, those below ``bound`` replaced by it."""
        return self._xp.maximum(values, bound)

    def take(self, flat: Array, index: Array) -> Array:
        """Return ``flat[index]``: the shape of ``index``, elements of a flat array."""
        return flat[index]

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
        """Count in each sorted row what is below each value of the same row."""
        side = "right" if equal else "left"
        found = [
            self._xp.searchsorted(row, one, side=side)  # (q,)
            for row, one in zip(rows, values)
        ]
        return self._xp.stack(found).astype(self._xp.int64)

    def join(self, parts: Sequence[Array]) -> Array:
        """Join arrays along the first axis."""
        return self._xp.concatenate(parts)


class Torch:
    """PyTorch, on the first CUDA device where there is one."""

    name = "torch"

    def __init__(self, module: Any) -> None:
        self._torch = module
        self._device = module.device("cuda" if module.cuda.is_available() else "cpu")

    def array(self, values: Any) -> Array:
        """Return numpy values as an array of this backend."""
        return self._torch.as_tensor(np.ascontiguousarray(values), device=self._device)

    def numpy(self, values: Array) -> Array:
        """Return an array as one of numpy."""
        return values.cpu().numpy()

    def sort(self, values: Array) -> Array:
        """Return a copy that is sorted along the last axis."""
        return self._torch.sort(values, dim=-1)[0]

    def highest(self, values: Array) -> Array:
        """Return the maximum along the last axis."""
        return values.amax(dim=-1)

    def lowest(self, values: Array) -> Array:
        """Return the minimum along the last axis."""
        return values.amin(dim=-1)

    def larger(self, one: Array, other: Array) -> Array:
        """Return the larger one of each two elements."""
        return self._torch.maximum(one, other)

    def at_least(self, values: Array, bound: int) -> Array:
        """Return the elements, those below ``bound`` replaced by it."""
        return self._torch.clamp(values, min=bound)

    def take(self, flat: Array, index: Array) -> Array:
        """Return ``flat[index]``: the shape of ``index``, elements of a flat array."""
        return flat[index]

    def doubles(self, values: Array) -> Array:
        """Return the values as float64."""
        return values.to(self._torch.float64)

    def positions(self, flat: Array, keys: Array) -> Array:
        """Return for each key how many elements of a sorted flat array are <= it."""
        return self._torch.searchsorted(flat, keys.contiguous(), right=True)

    def count(self, truths: Array) -> int:
        """Return how many elements are true."""
        return int(self._torch.count_nonzero(truths))

    def ranks(self, rows: Array, values: Array, *, equal: bool) -> Array:
        """Count in each sorted row what is below each value of the same row."""
        return self._torch.searchsorted(rows.contiguous(), values.contiguous(), right=equal)

    def join(self, parts: Sequence[Array]) -> Array:
        """Join arrays along the first axis."""
        return self._torch.cat(list(parts))


NUMPY = NumpyLike(np)
"""The backend that is always there."""


def backend(name: str) -> Backend:
    """Return the backend of this name; numpy, with a warning, where its library is not there.

    Decisions are the same with each of them: a robot without the library is slower or faster,
    not less safe.
    """
    if name in NAMES[1:]:
        try:
            module = importlib.import_module(name)
            return Torch(module) if name == "torch" else NumpyLike(module, name)
        except Exception as problem:  # noqa: BLE001 - drivers fail in ways of their own
            reason = " ".join(str(problem).split())[:200] or type(problem).__name__
            message = f"SafeML: numpy is used, because {name} cannot be: {reason}"
            warnings.warn(message, RuntimeWarning, stacklevel=2)
    return NUMPY
