"""Arrays: where they come from, and the few functions that the statistics need of a library."""

from __future__ import annotations

import hashlib
import os
import warnings
from functools import partial
from types import ModuleType
from typing import Any, NamedTuple, Sequence, Union

import numpy as np

from ..monitor import ModelError

Array = Any  # an array of the backend: ``numpy.ndarray`` or ``torch.Tensor``


class Backend:
    """Array functions under one name. "Last" is the last axis of an array."""

    def __init__(self, module: ModuleType = np, name: str = "numpy") -> None:
        self.name = name  # ``numpy`` or ``torch``
        self.array: Any = module.asarray  # numpy values -> an array of this backend
        self.numpy: Any = module.asarray  # an array -> one of numpy
        self.sort: Any = partial(module.sort, axis=-1)  # -> a copy sorted along the last axis
        self.highest: Any = lambda values: values.max(-1)  # -> the maximum along the last axis
        self.lowest: Any = lambda values: values.min(-1)  # -> the minimum along the last axis
        self.larger: Any = module.maximum  # -> the larger one of each two elements
        self.doubles: Any = partial(module.asarray, dtype=module.float64)  # -> as float64
        self.count: Any = lambda truths: int(module.count_nonzero(truths))  # -> how many are true
        # sorted flat array, keys -> for each key how many elements are <= it
        self.positions: Any = partial(module.searchsorted, side="right")
        self._module = module

    def ranks(self, rows: Array, values: Array, *, equal: bool) -> Array:
        """Count (K, q) in each ascending row (K, n) what is below each value of the same row."""
        side = "right" if equal else "left"
        found = [self._module.searchsorted(row, one, side=side) for row, one in zip(rows, values)]
        return self._module.stack(found).astype(self._module.int64)


NUMPY = Backend()  # the backend that is always there


def rounded(values: Array, *, single: bool) -> Array:
    """Return float64 values that float32 can hold, where samples are float32."""
    if not single:
        return values
    with np.errstate(over="ignore"):  # what becomes infinite is refused as such
        return values.astype(np.float32).astype(np.float64)


class Table(NamedTuple):
    """A file of doubles, least significant byte first, one row after the other."""

    # ``__spec__`` of the compiled monitor, beside which the file lies: whatever has loaded the
    # monitor also loads the file, from the source tree as from an archive
    spec: Any
    file: str  # its name
    sha256: str  # of its bytes
    shape: tuple[int, int]  # numbers of rows and columns


Numbers = Union[Table, Sequence[Sequence[float]]]


def array_of(numbers: Numbers) -> Array:
    """Return numbers as a writable array of float64, or raise ModelError."""
    if not isinstance(numbers, Table):
        return np.array(numbers, dtype=np.float64)
    folder = os.path.dirname(numbers.spec.origin)  # noqa: PTH120 - pathlib is slow to import
    path = os.path.join(folder, numbers.file)  # noqa: PTH118
    try:
        data = numbers.spec.loader.get_data(path)
    except OSError as problem:
        reason = f"cannot read the file: {problem.strerror or problem}"
        raise ModelError(path, f"{reason}: run `eddi-scaffold generate` again") from None
    if hashlib.sha256(data).hexdigest() != numbers.sha256:
        reason = "the file changed since generation: run `eddi-scaffold generate` again"
        raise ModelError(path, reason)
    return np.frombuffer(data, dtype="<f8").astype(np.float64).reshape(numbers.shape)


class Torch(Backend):
    """PyTorch, where a configuration asks for it, on the first CUDA device where there is one."""

    def __init__(self, module: ModuleType) -> None:
        device = module.device("cuda" if module.cuda.is_available() else "cpu")
        self.name = "torch"
        self.array = lambda values: module.as_tensor(np.ascontiguousarray(values), device=device)
        self.numpy = lambda values: values.cpu().numpy()
        self.sort = lambda values: module.sort(values, dim=-1)[0]
        self.highest = partial(module.amax, dim=-1)
        self.lowest = partial(module.amin, dim=-1)
        self.larger = module.maximum
        self.doubles = lambda values: values.to(module.float64)
        self.count = lambda truths: int(module.count_nonzero(truths))
        self.positions = lambda flat, keys: self.ranks(flat, keys, equal=True)
        self._module = module

    def ranks(self, rows: Array, values: Array, *, equal: bool) -> Array:
        return self._module.searchsorted(rows.contiguous(), values.contiguous(), right=equal)


def torch_or_numpy() -> Backend:
    """Return PyTorch as the backend; numpy, with a warning, where that is not there."""
    try:
        import torch  # noqa: PLC0415 - only where it is asked for

        return Torch(torch)
    except Exception as problem:  # noqa: BLE001 - drivers fail in ways of their own
        reason = " ".join(str(problem).split())[:200] or type(problem).__name__
        message = f"SafeML: numpy is used, because torch cannot be: {reason}"
        warnings.warn(message, RuntimeWarning, stacklevel=2)
    return NUMPY
