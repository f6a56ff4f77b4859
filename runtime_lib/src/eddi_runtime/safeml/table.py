"""Tables of numbers: in the text of a compiled monitor, large ones in a file beside it."""

from __future__ import annotations

import hashlib
import os
from typing import Any, NamedTuple, Sequence, Tuple, Union

import numpy as np

from ..documents import ModelError
from .arrays import Array


class Table(NamedTuple):
    """A file of doubles, least significant byte first, one row after the other.

    Attributes:
        spec: ``__spec__`` of the compiled monitor, beside which the file lies: whatever has
            loaded the monitor also loads the file, from the source tree as from an archive.
        file: its name.
        sha256: of its bytes.
        shape: numbers of rows and columns.
    """

    spec: Any
    file: str
    sha256: str
    shape: Tuple[int, int]


Numbers = Union[Table, Sequence[Sequence[float]]]


def array_of(numbers: Numbers) -> Array:
    """Return numbers as a writable array of float64.

    Raises:
        ModelError: the file cannot be read, or it is not the one of the thresholds.
    """
    if not isinstance(numbers, Table):
        return np.array(numbers, dtype=np.float64)
    path = os.path.join(os.path.dirname(numbers.spec.origin or ""), numbers.file)  # noqa: PTH118, PTH120 - pathlib is slow to import
    try:
        data = numbers.spec.loader.get_data(path)
    except OSError as problem:
        reason = f"cannot read the file: {problem.strerror or problem}"
        raise ModelError(path, f"{reason}: run `eddi-scaffold generate` again") from None
    if hashlib.sha256(data).hexdigest() != numbers.sha256:
        reason = "the file changed since generation: run `eddi-scaffold generate` again"
        raise ModelError(path, reason)
    return np.frombuffer(data, dtype="<f8").astype(np.float64).reshape(numbers.shape)
