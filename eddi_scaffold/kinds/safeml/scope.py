"""What a SafeML monitor is made of: configuration, reference, and what was found of both."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Literal

from eddi_scaffold.common.files import Source
from eddi_scaffold.common.problems import Place, Problem
from eddi_scaffold.kinds import TypedModel
from eddi_scaffold.kinds.safeml.design import Design, DesignSpec, Rows

NAME = "safeml"
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
    """``safeml_config.yml`` (SESAME D7.2 Fig 23 and our own keys).

    Attributes:
        window_size: samples that are compared with the reference.
        reference_sample_file: CSV, relative to the configuration.
        significance_level: probability of a false violation per step, over all tests.
        metric: the statistic.
        n_components: principal components; ``None``: the features themselves are tested.
        standardize: divide features by their standard deviation before.
        residual_test: test what the components leave out as well.
        calibration: thresholds for dependent samples from the reference (``stream``), or
            theoretical ones (``iid``), or as the length of the reference allows (``auto``).
        calibration_stride: distance of successive calibration windows.
        stride: only every so manieth sample enters the window.
        on_omission: whether the last verdict is kept while there is none (``hold``).
        max_age: seconds without a sample after which the window is emptied; ``None``: ten periods
            of the monitor.
        input_dtype: ``auto``: by the type of the message.
        array_backend: library of the arrays at run time.
        places: key -> place of its value; ``""``: of the file.
    """

    window_size: int
    reference_sample_file: str
    significance_level: float
    metric: Metric
    n_components: int | None = None
    standardize: bool = False
    residual_test: bool = True
    calibration: str = "auto"
    calibration_stride: int | None = None
    stride: int = 1
    on_omission: str = "hold"
    max_age: float | None = None
    input_dtype: str = "auto"
    array_backend: str = "numpy"
    places: Mapping[str, Place] = field(default_factory=dict, compare=False, hash=False)

    def place(self, key: str) -> Place:
        """Return the place of a key, or the file if the key is absent."""
        return self.places.get(key, self.places.get("", Place()))


@dataclass(frozen=True, eq=False)
class ReferenceSample:
    """A reference sample that was read without errors.

    Attributes:
        source: the file.
        rows: (rows, features), finite, in the order of the file.
    """

    source: Source
    rows: Rows


@dataclass(frozen=True)
class SafeMLFile:
    """A configuration together with the reference that it names."""

    settings: SafeMLSettings
    reference: ReferenceSample


@dataclass(frozen=True)
class Calibration:
    """Thresholds from windows of the reference itself.

    Attributes:
        windows: how many windows were compared.
        quantile: of the largest statistics of each (n m D for Kolmogorov-Smirnov).
        is_last: the quantile is the largest of them, so the level is not resolved.
    """

    windows: int
    quantile: float
    is_last: bool


@dataclass(frozen=True)
class Plan:
    """All that generation finds out.

    Statistics and thresholds are whole numbers n m D for Kolmogorov-Smirnov.

    Attributes:
        spec: what is tested, as the runtime needs it.
        design: the tests, and the reference in their form.
        n: size of the reference sample.
        level: significance level of one test.
        theoretical: threshold for independent samples.
        calibration: ``None`` when samples count as independent.
        threshold: what is used; never below the theoretical one.
        method: how the theoretical threshold was found: ``exact``, ``asymptotic`` or ``limit``.
        autocorrelation: the largest of neighbouring reference values, and the test it is of.
        constant: features that never change in the reference.
    """

    settings: SafeMLSettings
    spec: DesignSpec
    design: Design
    n: int
    level: float
    theoretical: float
    calibration: Calibration | None
    threshold: float
    method: str
    autocorrelation: tuple[float, int]
    constant: tuple[int, ...]

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
        return (
            statistic / (self.n * self.settings.window_size)
            if self.settings.metric == "ks"
            else statistic
        )


@dataclass(frozen=True)
class Planned:
    """A plan, ``None`` when there is an error, and all problems."""

    plan: Plan | None
    problems: tuple[Problem, ...]


@dataclass(frozen=True)
class SafeMLOptions:
    """What the eddi_config.yml adds.

    Attributes:
        plan: thresholds for the type of the messages.
        input_id: id of the one input.
        max_age: seconds, ``None`` for never.
        frequency: steps per second, ``None`` without a configuration.
    """

    plan: Plan
    input_id: str
    max_age: float | None
    frequency: float | None


SafeMLModel = TypedModel[SafeMLFile, SafeMLOptions]
"""A SafeML monitor; its options are how it is connected."""
