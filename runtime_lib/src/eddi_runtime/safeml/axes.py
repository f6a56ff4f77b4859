"""Principal components: what a sample becomes before it is compared.

The generator prepares references and thresholds with the same code, and the projections of the
reference are found by the machine that compares, one by one: so a sample of the robot and an equal
row of the reference become equal numbers to the last bit.
"""

from __future__ import annotations

import numpy as np

from .arrays import Array, Numbers, array_of


class Axes:
    """Principal axes of some rows.

    Args:
        numbers: rows of one number for each feature: the means; what the features are divided by
            then; and the axes, by falling variance.
        floor: length up to which what the axes leave out is rounding noise and counts as 0;
            ``None`` when it is not tested.
    """

    def __init__(self, numbers: Numbers, floor: float | None = None) -> None:
        found = array_of(numbers)
        self.centre, self.scale, self.vectors = found[0], found[1], found[2:]
        self._floor = floor
        names = [f"component {k}" for k in range(len(self.vectors))]
        self.labels = tuple(names if floor is None else [*names, "residual"])

    def values(self, sample: Array) -> Array:
        """Return the value of each test (K,) for one sample (d,).

        Numbers too large to multiply become infinite, which is beyond every reference.
        """
        with np.errstate(over="ignore", invalid="ignore"):
            found = self._projected(sample)
        return found if np.isfinite(found).all() else np.where(np.isnan(found), np.inf, found)

    def _projected(self, sample: Array) -> Array:
        centred = (sample - self.centre) / self.scale
        found = self.vectors @ centred
        if self._floor is None:
            return found
        rest = centred - found @ self.vectors
        size = float(np.sqrt(rest @ rest))
        return np.append(found, size if size >= self._floor else 0.0)

    def series(self, rows: Array) -> Array:
        """Return the values of many samples, (K, rows).

        One sample after the other: a product of matrices may differ in the last bit from what
        ``values`` gives, and would make equal samples unequal.
        """
        return np.ascontiguousarray(np.array([self.values(row) for row in rows]).T)

    def weights(self, test: int, most: int = 3) -> list[tuple[int, float]]:
        """Return the features that weigh most in a component, with their weights."""
        if test >= len(self.vectors):
            return []
        vector = self.vectors[test]
        order = np.argsort(-np.abs(vector), kind="stable")[:most]
        return [(int(k), float(vector[k])) for k in order]
