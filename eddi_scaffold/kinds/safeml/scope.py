"""What a SafeML monitor is made of: configuration, reference, and what was found of both.

Thresholds are found with the code that runs on the robot, and with the very numbers that it gets.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Literal, NamedTuple

import numpy as np
import numpy.typing as npt
from eddi_runtime.safeml import Axes
from eddi_runtime.safeml.arrays import rounded

from eddi_scaffold.common.files import Source
from eddi_scaffold.common.problems import Place

Rows = npt.NDArray[np.float64]
_NEGLIGIBLE = 1e-9
"""Residuals below this part of the longest sample are rounding noise and count as 0."""
_DECIMALS = 12  # Of axes: their last digits differ between machines, and a package must not

Metric = Literal["ks", "cvm", "ad"]

METRICS: Mapping[str, Metric] = {
    "KolmogorovSmirnovDistance": "ks",
    "AndersonDarlingDistance": "ad",
    "CramerVanMisesDistance": "cvm",
    "CramerVonMisesDistance": "cvm",
}
"""Names in a configuration; the third one is SESAME D7.2's spelling of the fourth."""

METRIC_NAMES: Mapping[Metric, str] = {short: long for long, short in METRICS.items()}


@dataclass(frozen=True)
class SafeMLSettings:
    """``safeml_config.yml`` (SESAME D7.2 Fig 23 and our own keys)."""

    window_size: int  # samples that are compared with the reference
    reference_sample_file: str = field(compare=False)  # CSV, relative to the configuration
    significance_level: float  # probability of a false violation per step, over all tests
    metric: Metric
    n_components: int | None = None  # principal components; `None`: the features themselves
    standardize: bool = False  # divide features by their standard deviation before
    residual_test: bool = True  # test what the components leave out as well
    calibration: str = "auto"  # thresholds for dependent samples (`stream`), theoretical (`iid`)
    calibration_stride: int | None = None  # distance of successive calibration windows
    stride: int = 1  # only every so manieth sample enters the window
    on_omission: str = "hold"  # whether the last verdict is kept while there is none (`hold`)
    max_age: float | None = None  # seconds until the window is emptied; `None`: ten periods
    input_dtype: str = "auto"  # `auto`: by the type of the message
    array_backend: str = "numpy"  # library of the arrays at run time
    # of the values of keys; `""`: of the file
    places: Mapping[str, Place] = field(default_factory=dict, compare=False, hash=False)

    def place(self, key: str) -> Place:
        """Return the place of a key, or the file if the key is absent."""
        return self.places.get(key, self.places.get("", Place()))


@dataclass(frozen=True, eq=False)
class ReferenceSample:
    """A reference sample that was read without errors."""

    source: Source
    rows: Rows  # (rows, features), finite, in the order of the file


@dataclass(frozen=True)
class SafeMLFile:
    """A configuration together with the reference that it names."""

    settings: SafeMLSettings
    reference: ReferenceSample


def split(rows: Rows, *, halves: bool) -> tuple[Rows, Rows]:
    """Return the rows that are the reference, and those that axes and calibration come from."""
    middle = len(rows) // 2
    return (rows[:middle], rows[middle:]) if halves else (rows, rows)


def principal_axes(rows: Rows, count: int, *, standardize: bool) -> tuple[Rows, Rows]:
    """Find the axes of the largest variance by singular value decomposition.

    Returns:
        Means, divisors and the axes by falling variance, orthonormal but for the rounding, the
        largest entry of each axis positive; and the singular values of all axes.
    """
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
    return np.vstack([centre, scale, vectors]), singular


class Design:
    """What is tested, with the reference in this form, (K, n) with ascending rows."""

    def __init__(
        self,
        rows: Rows,  # (rows, d), finite, in time order
        *,
        components: int | None = None,  # `None`: the features themselves are tested
        standardize: bool = False,  # divide features by their standard deviation before
        residual: bool = False,  # test what the components leave out as well
        halves: bool = False,  # the first half is the reference, the second gives the axes
        single: bool = False,  # samples come as float32, to which the reference is rounded
    ) -> None:
        rows = rounded(rows, single=single)
        reference, other = split(rows, halves=halves)
        self.labels: Sequence[str] = [f"feature {k}" for k in range(rows.shape[1])]
        self.table: Rows | None = None  # means, divisors and axes
        self.floor: float | None = None  # length of a residual that counts as 0
        self._axes: Axes | None = None
        # `sample` is what the robot gets: ascending features, or the rows of the reference
        if components is None:
            self.sample = self.reference = np.sort(self.series(reference), axis=1)
            return
        self.table, _ = principal_axes(other, components, standardize=standardize)
        if residual:
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


class Calibration(NamedTuple):
    """Thresholds from windows of the reference itself."""

    windows: int  # how many windows were compared
    quantile: float  # of the largest statistics of each (n m D for Kolmogorov-Smirnov)
    is_last: bool  # the quantile is the largest of them, so the level is not resolved


@dataclass(frozen=True)
class Plan:
    """All that generation finds out.

    Statistics and thresholds are whole numbers n m D for Kolmogorov-Smirnov.
    """

    settings: SafeMLSettings
    design: Design = field(compare=False)  # made of settings and reference
    single: bool  # samples come as float32
    level: float  # significance level of one test
    theoretical: float  # threshold for independent samples
    calibration: Calibration | None  # `None` when samples count as independent
    threshold: float  # what is used; never below the theoretical one
    method: str  # how the theoretical threshold was found: `exact`, `asymptotic` or `limit`
    autocorrelation: tuple[float, int]  # of neighbouring reference values, and of which test

    @property
    def n(self) -> int:
        """Size of the reference sample."""
        return len(self.design.reference[0])

    @property
    def labels(self) -> Sequence[str]:
        """Name of each test."""
        return self.design.labels

    @property
    def tests(self) -> int:
        """Number of tests, K."""
        return len(self.labels)

    def scale(self, statistic: float) -> float:
        """Return a statistic as people know it: D for Kolmogorov-Smirnov."""
        is_ks = self.settings.metric == "ks"
        return statistic / (self.n * self.settings.window_size) if is_ks else statistic


@dataclass(frozen=True)
class SafeMLOptions:
    """What the eddi_config.yml adds."""

    plan: Plan  # thresholds for the type of the messages
    input_id: str  # id of the one input
    max_age: float | None  # seconds, `None` for never
    frequency: float | None  # steps per second, `None` without a configuration
