"""The reference sample as ``numpy.savetxt(name, a, delimiter=",")`` writes it."""

from __future__ import annotations

import re
from typing import Any, List, Tuple

import numpy as np

BLANKS = " \t\v\f"
"""Characters allowed around a number, as in ``float`` for ASCII."""

_LINE_END = re.compile(r"\r\n|\r|\n")  # not splitlines(), which sees ends that editors do not


def filled_lines(text: str) -> List[Tuple[int, str]]:
    """Return number (from 1) and text of each line that is neither empty nor a comment (``#``)."""
    lines = ((k, line.strip(BLANKS)) for k, line in enumerate(_LINE_END.split(text), 1))
    return [(number, line) for number, line in lines if line and not line.startswith("#")]


def read_rows(data: bytes) -> Any:
    """Return a CSV of numbers as an array (rows, features) of float64.

    ``float`` reads decimal numbers alike in every locale.

    Raises:
        ValueError: a cell is no number, or the rows differ in length.
    """
    lines = filled_lines(data.decode("utf-8-sig"))
    rows = [[float(cell) for cell in line.split(",")] for _, line in lines]
    if len({len(row) for row in rows}) != 1:
        raise ValueError("the rows differ in length")
    return np.array(rows, dtype=np.float64)
