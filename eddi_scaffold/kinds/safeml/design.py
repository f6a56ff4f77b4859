"""From the rows of a reference to what is tested: features, or principal components.

Thresholds are found with the code that runs on the robot, and with the very numbers that it gets.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
from eddi_runtime.safeml import Axes
from eddi_runtime.safeml.arrays import rounded

Rows = npt.NDArray[np.float64]
_NEGLIGIBLE = 1e-9
"""Residuals below this part of the longest sample are rounding noise and count as 0."""
_DECIMALS = 12
"""Of axes: their last digits differ between machines, and a package must not."""


@dataclass(frozen=True)
class DesignSpec:
    """What is tested.

    Attributes:
        components: principal components; ``None``: the features themselves.
        standardize: divide features by their standard deviation before.
        residual: test what the components leave out as well.
        halves: the first half of the rows is the reference, the second one gives the axes.
        single: samples come as float32, so the reference is rounded to float32 first.
    """

    components: int | None = None
    standardize: bool = False
    residual: bool = False
    halves: bool = False
    single: bool = False


@dataclass(frozen=True)
class FoundAxes:
    """Principal axes as they are found.

    Attributes:
        table: means, divisors and the axes by falling variance, orthonormal but for the rounding;
            the largest entry of each axis is positive.
        singular: the singular values of all axes, not only of these.
    """

    table: Rows
    singular: Rows


def split(rows: Rows, *, halves: bool) -> tuple[Rows, Rows]:
    """Return the rows that are the reference, and those that axes and calibration come from."""
    middle = len(rows) // 2
    return (rows[:middle], rows[middle:]) if halves else (rows, rows)


def principal_axes(rows: Rows, count: int, *, standardize: bool) -> FoundAxes:
    """Find the axes of the largest variance by singular value decomposition."""
    centre = rows.mean(axis=0)
    scale = np.ones_like(centre)
    if standardize:
        spread = rows.std(axis=0)
        constant = rows.max(axis=0) == rows.min(axis=0)
        scale = np.where(constant | (spread == 0.0), 1.0, spread)
    _, singular, vectors = np.linalg.svd((rows - centre) / scale, full_matrices=False)
    vectors = vectors[:count]
    largest = np.argmax(np.abs(vectors), axis=1)
    signs = np.sign(vectors[np.arange(len(vectors)), largest])
    vectors = np.round(vectors * signs[:, None], _DECIMALS) + 0.0  # no -0.0
    return FoundAxes(np.vstack([centre, scale, vectors]), singular)


class Design:
    """What is tested, with the reference in this form.

    Args:
        rows: (rows, d), finite, in time order.
        spec: what is tested.

    Attributes:
        labels: name of each test for people.
        table: means, divisors and axes; ``None`` when the features themselves are tested.
        floor: length of a residual that counts as 0; ``None`` when it is not tested.
        sample: what the robot gets: the features, each ascending, or the rows of the reference.
        reference: (K, n), each row ascending.
    """

    def __init__(self, rows: Rows, spec: DesignSpec) -> None:
        rows = rounded(rows, single=spec.single)
        reference, other = split(rows, halves=spec.halves)
        self.labels: Sequence[str] = [f"feature {k}" for k in range(rows.shape[1])]
        self.table: Rows | None = None
        self.floor: float | None = None
        self._axes: Axes | None = None
        if spec.components is None:
            self.sample = self.reference = np.sort(self.series(reference), axis=1)
            return
        self.table = principal_axes(other, spec.components, standardize=spec.standardize).table
        if spec.residual:
            centre, scale = self.table[:2]
            longest = np.sqrt((((other - centre) / scale) ** 2).sum(axis=1).max())
            self.floor = _NEGLIGIBLE * float(longest)
        self._axes = Axes(self.table.tolist(), self.floor)
        self.labels = self._axes.labels
        self.sample = np.ascontiguousarray(reference)
        self.reference = np.sort(self.series(reference), axis=1)

    def values(self, sample: Rows) -> Rows:
        """Return the value of each test (K,) for one sample (d,)."""
        return sample if self._axes is None else self._axes.values(sample)

    def series(self, rows: Rows) -> Rows:
        """Return the values of many samples, (K, rows)."""
        return np.ascontiguousarray(rows.T) if self._axes is None else self._axes.series(rows)
