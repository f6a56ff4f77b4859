"""Powers of small matrices of transitions, and the law of Weibull."""

from __future__ import annotations

import math
from operator import mul
from typing import Iterator, Sequence

Matrix = Sequence[Sequence[float]]


def factors(powers: list[Matrix], quanta: int) -> Iterator[Matrix]:
    """Yield the powers that make up one of ``quanta``: as many as binary ones in it."""
    for bit in range(quanta.bit_length()):
        if bit == len(powers):
            columns = list(zip(*powers[-1]))
            square = [[dot(row, column) for column in columns] for row in powers[-1]]
            powers.append(
                [[one / whole for one in row] for row, whole in zip(square, map(sum, square))]
            )
        if quanta >> bit & 1:
            yield powers[bit]


def dot(one: Sequence[float], other: Sequence[float]) -> float:
    """Return the sum of products."""
    total: float = sum(map(mul, one, other))
    return total


_LARGEST = 709.0
_NEW = 1e-9


def hazard(age: float, ahead: float, scale: float, shape: float) -> float:
    """Return ((age + ahead) / scale) ** shape - (age / scale) ** shape without cancellation."""
    try:
        if age <= _NEW * ahead:
            return float(((age + ahead) / scale) ** shape - (age / scale) ** shape)
        return float((age / scale) ** shape * math.expm1(shape * math.log1p(ahead / age)))
    except OverflowError:  # what lies behind is nothing beside it, or both are beyond all numbers
        exponent = shape * math.log((age + ahead) / scale)
        return math.inf if exponent > _LARGEST else math.exp(exponent)
