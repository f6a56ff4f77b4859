"""Models in series."""

from __future__ import annotations

import math

from .component import NAN, Component, Estimate, Known, Moment, Values


class Series(Component):
    """Fails as soon as one of its parts does."""

    def __init__(self, *parts: str) -> None:
        self._parts = parts

    def step(self, values: Values, moment: Moment, known: Known) -> Estimate:
        del values, moment
        parts = [known[name] for name in self._parts]
        low, high = _series([p.low for p in parts]), _series([p.high for p in parts])
        unknown = tuple(dict.fromkeys(name for part in parts for name in part.unknown))
        reason = next((part.reason for part in parts if part.reason), "")
        alive = math.prod(part.reliability for part in parts)
        mttf = parts[0].mttf if len(parts) == 1 else NAN
        return Estimate(low, high, alive, mttf, unknown, reason)


def _series(failures: list[float]) -> float:
    if any(p >= 1.0 for p in failures):
        return 1.0
    return -math.expm1(math.fsum(math.log1p(-p) for p in failures)) + 0.0  # never -0.0
