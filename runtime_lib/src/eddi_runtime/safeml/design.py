"""From the rows of a reference to one sorted series per test: features, or principal components.

The generator finds thresholds with the same code, so that a sample of the robot and an equal row
of the reference become equal numbers to the last bit.
"""

from __future__ import annotations

from typing import List, NamedTuple, Optional, Sequence, Tuple

import numpy as np

from .arrays import Array

_NEGLIGIBLE = 1e-9
"""Residuals below this part of the longest sample are rounding noise and count as 0."""


class DesignSpec(NamedTuple):
    """What is tested.

    Attributes:
        components: principal components; ``None``: the features themselves.
        standardize: divide features by their standard deviation before.
        residual: test what the components leave out as well.
        halves: the first half of the rows is the reference, the second one gives the axes.
        single: samples come as float32, so the reference is rounded to float32 first.
    """

    components: Optional[int] = None
    standardize: bool = False
    residual: bool = False
    halves: bool = False
    single: bool = False


class Axes(NamedTuple):
    """Principal axes of some rows.

    Attributes:
        centre: means of the features (d,).
        scale: what the features are divided by (d,).
        vectors: (k, d), orthonormal, by falling variance; the largest entry of each is positive.
        singular: the singular values of all axes, not only of these k.
    """

    centre: Array
    scale: Array
    vectors: Array
    singular: Array


def rounded(values: Array, *, single: bool) -> Array:
    """Return float64 values that float32 can hold, where samples are float32."""
    if not single:
        return values
    with np.errstate(over="ignore"):  # what becomes infinite is refused as such
        return values.astype(np.float32).astype(np.float64)


def split(rows: Array, *, halves: bool) -> Tuple[Array, Array]:
    """Return the rows that are the reference, and those that axes and calibration come from."""
    middle = len(rows) // 2
    return (rows[:middle], rows[middle:]) if halves else (rows, rows)


def principal_axes(rows: Array, count: int, *, standardize: bool) -> Axes:
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
    vectors = np.ascontiguousarray(vectors * signs[:, None])
    return Axes(centre, scale, vectors, singular)


class Design:
    """Turns samples into one value per test, and holds the reference in this form.

    Args:
        rows: (rows, d), finite, in time order.
        spec: what is tested.

    Attributes:
        features: d.
        labels: name of each test for people.
        axes: ``None`` when the features themselves are tested.
        reference: (K, n), each row ascending.
    """

    def __init__(self, rows: Array, spec: DesignSpec) -> None:
        rows = rounded(rows, single=spec.single)
        reference, other = split(rows, halves=spec.halves)
        self.features = int(rows.shape[1])
        self.axes: Optional[Axes] = None
        self._floor: Optional[float] = None
        labels = [f"feature {k}" for k in range(self.features)]
        if spec.components is not None:
            axes = principal_axes(other, spec.components, standardize=spec.standardize)
            self.axes = axes
            labels = [f"component {k}" for k in range(len(axes.vectors))]
            if spec.residual:
                longest = np.sqrt((((other - axes.centre) / axes.scale) ** 2).sum(axis=1).max())
                self._floor = _NEGLIGIBLE * float(longest)
                labels.append("residual")
        self.labels: Sequence[str] = tuple(labels)
        self.reference = np.sort(self.series(reference), axis=1)

    def values(self, sample: Array) -> Array:
        """Return the value of each test (K,) for one sample (d,).

        Numbers too large to multiply become infinite, which is beyond every reference.
        """
        if self.axes is None:
            return sample
        with np.errstate(over="ignore", invalid="ignore"):
            found = self._projected(sample, self.axes)
        return found if np.isfinite(found).all() else np.where(np.isnan(found), np.inf, found)

    def _projected(self, sample: Array, axes: Axes) -> Array:
        centred = (sample - axes.centre) / axes.scale
        found = axes.vectors @ centred
        if self._floor is None:
            return found
        rest = centred - found @ axes.vectors
        size = float(np.sqrt(rest @ rest))
        return np.append(found, size if size >= self._floor else 0.0)

    def series(self, rows: Array) -> Array:
        """Return the values of many samples, (K, rows).

        One sample after the other: a product of matrices may differ in the last bit from what
        ``values`` gives, and would make equal samples unequal.
        """
        if self.axes is None:
            return np.ascontiguousarray(rows.T)
        found = [self.values(row) for row in rows]
        return np.ascontiguousarray(np.array(found).T)

    def weights(self, test: int, most: int = 3) -> List[Tuple[int, float]]:
        """Return the features that weigh most in a principal component, with their weights."""
        if self.axes is None or test >= len(self.axes.vectors):
            return []
        vector = self.axes.vectors[test]
        order = np.argsort(-np.abs(vector), kind="stable")[:most]
        return [(int(k), float(vector[k])) for k in order]
