"""The reference sample as ``numpy.savetxt(name, a, delimiter=",")`` writes it."""

from __future__ import annotations

from typing import Any

import numpy as np


def read_rows(data: bytes) -> Any:
    """Return a CSV of numbers as an array (rows, features) of float64.

    Empty lines and lines that begin with ``#`` are passed over. ``float`` reads decimal numbers
    alike in every locale.

    Raises:
        ValueError: a cell is no number, or the rows differ in length.
    """
    text = data.decode("utf-8-sig")
    lines = (line.strip() for line in text.splitlines())
    rows = [
        [float(cell) for cell in line.split(",")]
        for line in lines
        if line and not line.startswith("#")
    ]
    if len({len(row) for row in rows}) != 1:
        raise ValueError("the rows differ in length")
    return np.array(rows, dtype=np.float64)
