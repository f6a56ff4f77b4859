"""Arrays of a library, the samples in values of the robot, and their principal components."""

from __future__ import annotations

import hashlib
import os
import warnings
from functools import partial
from types import ModuleType
from typing import Any, NamedTuple, Sequence, Union

import numpy as np

from ..history import Messages
from ..monitor import ModelError
from ..plain_values import plain

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
        search = self._module.searchsorted
        places = [search(row, given, side=side) for row, given in zip(rows, values)]
        return self._module.stack(places).astype(self._module.int64)


NUMPY = Backend()  # the backend that is always there


def rounded(values: Array, *, single: bool) -> Array:
    """Return float64 values that float32 can hold, where samples are float32."""
    if not single:
        return values
    with np.errstate(over="ignore"):  # what becomes infinite is refused as such
        return values.astype(np.float32).astype(np.float64)


class Table(NamedTuple):
    """A file of doubles, least significant byte first, one row after the other."""

    spec: Any  # ``__spec__`` of the compiled monitor: what has loaded that also loads the file
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

    It is ``Messages``, a list of lists, or one message: numbers (d,), an array (r, d), one with
    ``layout`` and ``data``, bytes. Booleans are no numbers, and a list in a list is no message.
    """
    taken = Taken([], [])
    faults: list[str] = []
    for message in _messages(value):
        try:
            samples = _array(message)
        except Exception as problem:  # noqa: BLE001, PERF203 - any object may come
            known = isinstance(problem, _NoNumbersError)
            name = str(problem) if known else type(problem).__name__
            faults.append(f"{'numbers are expected, not' if known else 'it is no array:'} {name}")
            taken.bad.append(WRONG_LENGTH)
        else:
            _sort_out(rounded(samples, single=single), features, taken, faults)
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
        sizes = tuple(dimension.size for dimension in message.layout.dim)
        message = message.data[message.layout.data_offset :]
        if len(sizes) == 2 and sizes[0] * sizes[1] == len(message):
            shape = sizes
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
            message = [plain(item) for item in message]
    array = np.asarray(message)
    if array.dtype.kind == "b":
        raise _NoNumbersError("Booleans")
    if array.dtype.kind not in "fiu" or (array.ndim > 2 and array.size):
        raise _NoNumbersError(of)
    array = array.astype(np.float64)
    return array if shape is None else array.reshape(shape)


def _sort_out(samples: Array, features: int, taken: Taken, faults: list[str]) -> None:
    if samples.size == 0:
        taken.bad.append(EMPTY)
        faults.append("the message is empty")
        return
    if samples.ndim == 2 and samples.shape[1] == features:
        rows = list(samples)
    elif samples.size == features:
        rows = [samples.reshape(-1)]  # one sample that has a shape of its own, such as an image
    else:
        count, length = samples.shape if samples.ndim == 2 else (1, samples.size)
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

    Projections of the reference are found by the machine that compares, one by one: an equal row
    becomes equal numbers to the last bit. ``floor``: length up to which what the axes leave out
    counts as 0; None: it is not tested.
    """

    def __init__(self, numbers: Numbers, floor: float | None = None) -> None:
        array = array_of(numbers)
        self.centre, self.scale, self.vectors = array[0], array[1], array[2:]
        self._floor = floor
        names = [f"component {k}" for k in range(len(self.vectors))]
        self.labels = tuple(names if floor is None else [*names, "residual"])

    def values(self, sample: Array) -> Array:
        """Return the value of each test (K,) for one sample (d,); too large ones are infinite."""
        with np.errstate(over="ignore", invalid="ignore"):
            centred = (sample - self.centre) / self.scale
            tests = self.vectors @ centred
            if self._floor is not None:
                rest = centred - tests @ self.vectors
                size = float(np.sqrt(rest @ rest))
                tests = np.append(tests, size if size >= self._floor else 0.0)
        return tests if np.isfinite(tests).all() else np.where(np.isnan(tests), np.inf, tests)

    def series(self, rows: Array) -> Array:
        """Return the values of many samples, (K, rows); one by one, see the class."""
        return np.ascontiguousarray(np.array([self.values(row) for row in rows]).T)
