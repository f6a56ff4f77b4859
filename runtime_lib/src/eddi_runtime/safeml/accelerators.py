"""PyTorch in place of numpy, where a configuration asks for it; it is never required."""

from __future__ import annotations

import warnings
from functools import partial
from types import ModuleType

import numpy as np

from .arrays import NUMPY, Array, Backend


class Torch(Backend):
    """PyTorch, on the first CUDA device where there is one."""

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
        """Count in each sorted row what is below each value of the same row."""
        return self._module.searchsorted(rows.contiguous(), values.contiguous(), right=equal)


def torch_or_numpy() -> Backend:
    """Return PyTorch as the backend; numpy, with a warning, where that is not there.

    Decisions are the same with both: a robot without the library is slower or faster, not less
    safe.
    """
    try:
        import torch  # noqa: PLC0415 - only where it is asked for

        return Torch(torch)
    except Exception as problem:  # noqa: BLE001 - drivers fail in ways of their own
        reason = " ".join(str(problem).split())[:200] or type(problem).__name__
        message = f"SafeML: numpy is used, because torch cannot be: {reason}"
        warnings.warn(message, RuntimeWarning, stacklevel=2)
    return NUMPY
