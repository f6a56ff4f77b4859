"""Sums over small tables, written out as one expression: no loop, no list between."""

from __future__ import annotations

import math
from typing import Callable, Dict, List, Optional, Sequence

Total = Callable[[Sequence[Sequence[float]]], List[float]]
"""One vector per axis -> the sums of all products with a table, one for each state of the row."""

MAX_NUMBERS = 128
"""Numbers of a table up to which this is the faster way."""


def make_total(
    values: Sequence[float], counts: Sequence[int], strides: Sequence[int], card: int
) -> Optional[Total]:
    """Return the function for a table, None for a large one.

    Args:
        values: the table, flat.
        counts: numbers of each axis that are summed; what lies beyond is left out.
        strides: distance between two numbers of each axis.
        card: length of the row, whose numbers lie side by side.
    """
    if card * math.prod(counts) > MAX_NUMBERS:
        return None

    def text(axis: int, offset: int) -> str:
        if axis == len(counts):
            return repr(values[offset])
        terms = [
            f"v{axis}_{k}*{text(axis + 1, offset + k * strides[axis])}" for k in range(counts[axis])
        ]
        return f"({'+'.join(terms)})"

    vectors = [", ".join(f"v{axis}_{k}" for k in range(n)) for axis, n in enumerate(counts)]
    lines = [
        "def total(v):",
        f"    [{', '.join(f'[{one}]' for one in vectors)}] = v",
        f"    return [{', '.join(text(0, state) for state in range(card))}]",
    ]
    names: Dict[str, Total] = {}
    exec(compile("\n".join(lines), "<Bayesian network>", "exec"), names)  # noqa: S102 - numbers only
    return names["total"]
