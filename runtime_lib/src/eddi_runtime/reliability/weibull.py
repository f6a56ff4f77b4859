"""The law of Weibull."""

from __future__ import annotations

import math

_LARGEST = 709.0
_NEW = 1e-9


def hazard(age: float, ahead: float, scale: float, shape: float) -> float:
    """Return ((age + ahead) / scale) ** shape - (age / scale) ** shape without cancellation.

    Returns:
        The hazard; ``inf`` when it is larger than any number.
    """
    try:
        if age <= _NEW * ahead:
            return float(((age + ahead) / scale) ** shape - (age / scale) ** shape)
        return float((age / scale) ** shape * math.expm1(shape * math.log1p(ahead / age)))
    except OverflowError:  # what lies behind is nothing beside it, or both are beyond all numbers
        exponent = shape * math.log((age + ahead) / scale)
        return math.inf if exponent > _LARGEST else math.exp(exponent)
