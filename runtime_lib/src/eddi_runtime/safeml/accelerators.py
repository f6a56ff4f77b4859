"""Array libraries that a configuration may ask for; nothing of them is ever required."""

from __future__ import annotations

import warnings
from typing import Any

import numpy as np

from .arrays import NUMPY, Array, Backend


class Torch(Backend):
    """PyTorch, on the first CUDA device where there is one."""

    def __init__(self, module: Any) -> None:
        super().__init__(module, "torch")
        self._torch = module
        self._device = module.device("cuda" if module.cuda.is_available() else "cpu")

    def array(self, values: Any) -> Array:
        return self._torch.as_tensor(np.ascontiguousarray(values), device=self._device)

    def numpy(self, values: Array) -> Array:
        return values.cpu().numpy()

    def sort(self, values: Array) -> Array:
        return self._torch.sort(values, dim=-1)[0]

    def highest(self, values: Array) -> Array:
        return values.amax(dim=-1)

    def lowest(self, values: Array) -> Array:
        return values.amin(dim=-1)

    def larger(self, one: Array, other: Array) -> Array:
        return self._torch.maximum(one, other)

    def doubles(self, values: Array) -> Array:
        return values.to(self._torch.float64)

    def positions(self, flat: Array, keys: Array) -> Array:
        return self._torch.searchsorted(flat, keys.contiguous(), right=True)

    def count(self, truths: Array) -> int:
        return int(self._torch.count_nonzero(truths))

    def ranks(self, rows: Array, values: Array, *, equal: bool) -> Array:
        return self._torch.searchsorted(rows.contiguous(), values.contiguous(), right=equal)


def backend(name: str) -> Backend:
    """Return the backend ``torch`` or ``cupy``; numpy, with a warning, where that is not there.

    Decisions are the same with each of them: a robot without the library is slower or faster,
    not less safe.
    """
    try:
        if name == "torch":
            import torch  # noqa: PLC0415 - only where it is asked for

            return Torch(torch)
        import cupy  # noqa: PLC0415 - the same

        return Backend(cupy, name)
    except Exception as problem:  # noqa: BLE001 - drivers fail in ways of their own
        reason = " ".join(str(problem).split())[:200] or type(problem).__name__
        message = f"SafeML: numpy is used, because {name} cannot be: {reason}"
        warnings.warn(message, RuntimeWarning, stacklevel=2)
    return NUMPY
