"""Derive tests and thresholds from a reference and a configuration, with all problems."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from functools import lru_cache

import numpy as np
from eddi_runtime.safeml.arrays import rounded
from eddi_runtime.safeml.comparison import Comparison

from eddi_scaffold.common.problems import Problem, error, has_errors, warning
from eddi_scaffold.kinds.safeml.calibration import autocorrelation, calibrate, effective
from eddi_scaffold.kinds.safeml.design import Design, DesignSpec, Rows, principal_axes, split
from eddi_scaffold.kinds.safeml.scope import (
    METRIC_NAMES,
    Calibration,
    Plan,
    Planned,
    ReferenceSample,
    SafeMLSettings,
)
from eddi_scaffold.kinds.safeml.thresholds import (
    can_fire,
    largest_possible,
    limit_quantile,
    smallest_window,
    theoretical,
)

ROWS_PER_WINDOW = 20
"""Windows that a reference must hold for calibration to be worth it (``calibration: auto``)."""
_DEPENDENT = 0.2
_SMALL_COMPONENT = 1e-12
_UNLIKE_UNITS = 100.0
_LARGEST_SQUARED = 1e150
_HIGHEST_LEVEL = 0.5
_FEWEST_FOR_LIMITS = 10
_LISTED = 10


@lru_cache(maxsize=8)
def plan(settings: SafeMLSettings, reference: ReferenceSample, *, single: bool) -> Planned:
    """Find tests and thresholds.

    Args:
        settings: the configuration.
        reference: rows of correct behaviour.
        single: samples come as float32.

    Returns:
        The plan, ``None`` when a problem is an error (L006 to L008), and all problems (to L013).
    """
    return _Planner(settings, reference, single=single).planned()


class _Planner:
    def __init__(
        self, settings: SafeMLSettings, reference: ReferenceSample, *, single: bool
    ) -> None:
        self.settings = settings
        self.problems: list[Problem] = []
        self.single = single
        self.rows: Rows = rounded(reference.rows, single=single)
        self.streams = settings.calibration == "stream" or (
            settings.calibration == "auto"
            and len(self.rows) >= ROWS_PER_WINDOW * settings.window_size
        )
        self.halves = self.streams or settings.n_components is not None

    def planned(self) -> Planned:
        """Return the plan and all problems."""
        made = self._plan()
        return Planned(None if has_errors(self.problems) else made, tuple(self.problems))

    def _plan(self) -> Plan | None:
        settings, problems = self.settings, self.problems
        if not np.isfinite(self.rows).all():
            text = "the reference contains numbers beyond float32, the type of the samples"
            problems.append(error("L005", text, settings.place("input_dtype")))
            return None
        _, other = split(self.rows, halves=self.halves)
        constant = self._look_at_features()
        problems += self._too_short(other)
        kept = self._components(other)
        if has_errors(problems):
            return None
        features = self.rows.shape[1]
        residual = settings.residual_test and kept is not None and kept < features
        spec = DesignSpec(kept, settings.standardize, residual, self.halves, self.single)
        design = Design(self.rows, spec)
        comparison = Comparison(settings.metric, design.reference, settings.window_size)
        level = settings.significance_level / comparison.tests
        if not self._fires(comparison, level):
            return None
        critical, method = theoretical(settings.metric, comparison.n, settings.window_size, level)
        calibration = self._calibrated(comparison, design.series(other)) if self.streams else None
        threshold = effective(
            settings.metric, critical, calibration, comparison.n, settings.window_size
        )
        if threshold > largest_possible(settings.metric, comparison.n, comparison.m):
            text = (
                "the monitor can never report a violation: calibration found windows of the "
                "reference that have nothing in common with its first half"
            )
            hint = "the reference drifts: record one whose halves are alike"
            where = settings.place("reference_sample_file")
            problems.append(error("L007", text, where, hint))
            return None
        made = Plan(
            settings, spec, design, comparison.n, level, critical, calibration, threshold, method,
            autocorrelation(design.series(self.rows)), constant,
        )  # fmt: skip
        problems += self._remarks(made)
        return made

    def _warn(self, code: str, text: str, key: str, hint: str | None = None) -> None:
        self.problems.append(warning(code, text, self.settings.place(key), hint))

    def _look_at_features(self) -> tuple[int, ...]:
        rows, key = self.rows, "reference_sample_file"
        constant = np.flatnonzero((rows == rows[0]).all(axis=0)).tolist()
        if constant:
            text = f"constant in the reference: {_listed('feature', constant)}"
            hint = "every other value of it counts as a violation: leave it out if that is wrong"
            self._warn("L010", text, key, hint)
        same = [pair for pair in _equal_columns(rows) if pair[0] not in constant]
        if same:
            pairs = ", ".join(f"{first} and {second}" for first, second in same[:_LISTED])
            text = f"features are equal in every row: {pairs}{_more(same)}"
            self._warn("L010", text, key, "a second copy is tested again and lowers the power")
        return tuple(constant)

    def _too_short(self, other: Rows) -> Iterable[Problem]:
        settings, m = self.settings, self.settings.window_size
        place = settings.place("reference_sample_file")
        needed = max(2 * m, (m - 1) * settings.stride + 1)
        if self.streams and len(other) < needed:
            text = (
                f"calibration: stream needs {2 * needed} rows, half of them for windows; the "
                f"reference has {len(self.rows)}"
            )
            where = settings.place("calibration")
            yield error("L008", text, where, "record more, or write `calibration: iid`")
        elif len(self.rows) < 2 * m:
            text = f"the reference has {len(self.rows)} rows, fewer than two windows of {m}"
            yield warning("L009", text, place, "record more: the tests compare like with like")

    def _components(self, other: Rows) -> int | None:
        """Return how many components are kept; notes what is wrong with the wish."""
        settings, wanted = self.settings, self.settings.n_components
        if wanted is None:
            if settings.standardize:
                text = "standardize has no effect without n_components: ranks do not change"
                self._warn("L010", text, "standardize")
            return None
        rows, features = other.shape
        if wanted > min(rows, features):
            text = (
                f"n_components is {wanted}, but only {min(rows, features)} are possible: the "
                f"half of the reference for the axes has {rows} rows, and {features} features"
            )
            self.problems.append(error("L006", text, settings.place("n_components")))
            return None
        if np.abs(self.rows).max() > _LARGEST_SQUARED:
            text = "the reference contains numbers whose squares overflow"
            where = settings.place("reference_sample_file")
            self.problems.append(error("L005", text, where, "choose a larger unit"))
            return None
        singular = principal_axes(other, wanted, standardize=settings.standardize).singular
        if singular[0] == 0.0:
            text = "n_components: all features are constant, there is no axis"
            where = settings.place("n_components")
            self.problems.append(error("L006", text, where, "write `n_components: null`"))
            return None
        if not settings.standardize:
            self._look_at_units(other)
        kept = int((singular[:wanted] > _SMALL_COMPONENT * singular[0]).sum())
        if kept < wanted:
            dropped = list(range(kept, wanted))
            text = f"without variance, dropped: {_listed('component', dropped)}"
            self._warn("L010", text, "n_components", f"write `n_components: {kept}`")
        return kept

    def _look_at_units(self, other: Rows) -> None:
        spread = other.std(axis=0)
        largest, usual = float(spread.max()), float(np.median(spread[spread > 0.0]))
        if largest > _UNLIKE_UNITS * usual:
            text = (
                f"components follow the unit of feature {int(spread.argmax())}: its standard "
                f"deviation is {largest:.3g}, the median of all {usual:.3g}"
            )
            self._warn("L013", text, "n_components", "write `standardize: true`")

    def _fires(self, comparison: Comparison, level: float) -> bool:
        settings, n, m = self.settings, comparison.n, comparison.m
        if can_fire(settings.metric, n, m, level):
            return True
        least = smallest_window(settings.metric, n, level)
        text = (
            f"the monitor can never report a violation: window_size {m}, {n} reference values, "
            f"{comparison.tests} test{'s' if comparison.tests > 1 else ''}, significance_level "
            f"{settings.significance_level:g}"
        )
        hint = (
            f"the smallest window_size that works is {least}"
            if least is not None
            else "no window_size works: test fewer components or raise significance_level"
        )
        self.problems.append(error("L007", text, settings.place("window_size"), hint))
        return False

    def _calibrated(self, comparison: Comparison, series: Rows) -> Calibration:
        settings = self.settings
        distance = settings.calibration_stride or max(1, settings.window_size // 20)
        return calibrate(
            comparison,
            series,
            stride=settings.stride,
            distance=distance,
            level=settings.significance_level,
        )

    def _remarks(self, made: Plan) -> Iterable[Problem]:
        settings = self.settings
        if made.settings.metric != "ks" and settings.window_size < _FEWEST_FOR_LIMITS:
            text = f"{METRIC_NAMES[settings.metric]} is verified for a window_size of at least 10"
            yield warning("L009", text, settings.place("window_size"))
        if settings.metric != "ks" and made.level > _HIGHEST_LEVEL:
            value = limit_quantile(settings.metric, _HIGHEST_LEVEL)
            text = f"a level of {made.level:g} per test counts as 0.5 (quantile {value:.3g})"
            yield warning("L009", text, settings.place("significance_level"))
        yield from self._dependence(made)
        if made.calibration is None:
            return
        if made.threshold > 2 * made.theoretical:
            ratio = made.threshold / made.theoretical
            text = (
                f"calibration raises the threshold to {ratio:.1f} times the theoretical one: "
                "samples depend strongly on each other, or the reference drifts"
            )
            hint = "the power to detect is low: take a longer window or a larger stride"
            yield warning("L012", text, settings.place("window_size"), hint)
        if made.calibration.is_last:
            text = (
                f"significance_level {settings.significance_level:g} cannot be resolved with "
                f"{made.calibration.windows} calibration windows"
            )
            yield warning("L012", text, settings.place("significance_level"), "record more rows")

    def _dependence(self, made: Plan) -> Iterable[Problem]:
        value, test = made.autocorrelation
        if made.calibration is not None or value <= _DEPENDENT:
            return
        needed = ROWS_PER_WINDOW * self.settings.window_size
        text = (
            f"neighbouring samples depend on each other ({made.labels[test]}: autocorrelation "
            f"{value:.2f}), and thresholds are for independent ones: false violations are frequent"
        )
        hint = f"calibration needs {needed} rows in time order, there are {len(self.rows)}"
        if len(self.rows) >= needed:
            hint = "write `calibration: stream`"
        yield warning("L011", text, self.settings.place("calibration"), hint)


def _equal_columns(rows: Rows) -> list[tuple[int, int]]:
    first: dict[bytes, int] = {}
    found = []
    for k, column in enumerate(np.ascontiguousarray(rows.T) + 0.0):  # -0.0 equals 0.0
        other = first.setdefault(column.tobytes(), k)
        if other != k:
            found.append((other, k))
    return found


def _listed(what: str, numbers: Sequence[int]) -> str:
    """Name things by their numbers: ``feature 3``, ``features 3, 5``."""
    if len(numbers) == 1:
        return f"{what} {numbers[0]}"
    shown = ", ".join(map(str, numbers[:_LISTED]))
    return f"{what}s {shown}{_more(numbers)}"


def _more(items: Sequence[object]) -> str:
    return f" and {len(items) - _LISTED} more" if len(items) > _LISTED else ""


def upwards(value: float, digits: int = 9) -> float:
    """Return a number of few digits that is not below ``value``: the same on every machine."""
    if value == 0.0 or not math.isfinite(value):
        return value
    up = float(f"{value:.{digits - 1}e}")
    if up >= value:
        return up
    unit = 10.0 ** (math.floor(math.log10(abs(value))) - digits + 1)
    return float(f"{value + unit / 2:.{digits - 1}e}")
