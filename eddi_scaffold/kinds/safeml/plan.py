"""Derive tests and thresholds from a reference and a configuration, with all problems."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from functools import lru_cache
from typing import Any

import numpy as np
from eddi_runtime.safeml.arrays import rounded
from eddi_runtime.safeml.comparison import Comparison

from eddi_scaffold.common.problems import Problem, has_errors, problem
from eddi_scaffold.kinds.safeml.calibration import autocorrelation, calibrate, effective
from eddi_scaffold.kinds.safeml.scope import (
    METRIC_NAMES,
    Calibration,
    Design,
    DesignSpec,
    Plan,
    Planned,
    ReferenceSample,
    Rows,
    SafeMLSettings,
    principal_axes,
    split,
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
            problems.append(problem("L004.float32", settings.place("input_dtype")))
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
            where = settings.place("reference_sample_file")
            problems.append(problem("L007.drift", where))
            return None
        made = Plan(
            settings, spec, design, comparison.n, level, critical, calibration, threshold, method,
            autocorrelation(design.series(self.rows)), constant,
        )  # fmt: skip
        problems += self._remarks(made)
        return made

    def _report(self, case: str, key: str, /, **fields: Any) -> None:
        self.problems.append(problem(case, self.settings.place(key), **fields))

    def _look_at_features(self) -> tuple[int, ...]:
        rows, key = self.rows, "reference_sample_file"
        constant = np.flatnonzero((rows == rows[0]).all(axis=0)).tolist()
        if constant:
            self._report("L010.constant", key, features=_listed("feature", constant))
        same = [pair for pair in _equal_columns(rows) if pair[0] not in constant]
        if same:
            pairs = ", ".join(f"{first} and {second}" for first, second in same[:_LISTED])
            self._report("L010.equal", key, pairs=pairs, same=_more(same))
        return tuple(constant)

    def _too_short(self, other: Rows) -> Iterable[Problem]:
        settings, m = self.settings, self.settings.window_size
        place = settings.place("reference_sample_file")
        needed = max(2 * m, (m - 1) * settings.stride + 1)
        if self.streams and len(other) < needed:
            where = settings.place("calibration")
            yield problem("L008", where, needed=2 * needed, rows=len(self.rows))
        elif len(self.rows) < 2 * m:
            yield problem("L009.few_rows", place, rows=len(self.rows), window=m)

    def _components(self, other: Rows) -> int | None:
        """Return how many components are kept; notes what is wrong with the wish."""
        settings, wanted = self.settings, self.settings.n_components
        if wanted is None:
            if settings.standardize:
                self._report("L010.no_effect", "standardize")
            return None
        rows, features = other.shape
        if wanted > min(rows, features):
            self.problems.append(
                problem(
                    "L006.components",
                    settings.place("n_components"),
                    requested=wanted,
                    possible=min(rows, features),
                    rows=rows,
                    features=features,
                )
            )
            return None
        if np.abs(self.rows).max() > _LARGEST_SQUARED:
            where = settings.place("reference_sample_file")
            self.problems.append(problem("L004.overflow", where))
            return None
        singular = principal_axes(other, wanted, standardize=settings.standardize).singular
        if singular[0] == 0.0:
            where = settings.place("n_components")
            self.problems.append(problem("L006.no_axis", where))
            return None
        if not settings.standardize:
            self._look_at_units(other)
        kept = int((singular[:wanted] > _SMALL_COMPONENT * singular[0]).sum())
        if kept < wanted:
            dropped = list(range(kept, wanted))
            self._report(
                "L010.dropped", "n_components", features=_listed("component", dropped), kept=kept
            )
        return kept

    def _look_at_units(self, other: Rows) -> None:
        spread = other.std(axis=0)
        largest, usual = float(spread.max()), float(np.median(spread[spread > 0.0]))
        if largest > _UNLIKE_UNITS * usual:
            self._report(
                "L013", "n_components", spread=int(spread.argmax()), largest=largest, median=usual
            )

    def _fires(self, comparison: Comparison, level: float) -> bool:
        settings, n, m = self.settings, comparison.n, comparison.m
        if can_fire(settings.metric, n, m, level):
            return True
        least = smallest_window(settings.metric, n, level)
        hint = (
            f"the smallest window_size that works is {least}"
            if least is not None
            else "no window_size works: test fewer components or raise significance_level"
        )
        self.problems.append(
            problem(
                "L007.too_few",
                settings.place("window_size"),
                hint=hint,
                window=m,
                values=n,
                tests=comparison.tests,
                plural="s" if comparison.tests > 1 else "",
                significance_level=settings.significance_level,
            )
        )
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
            yield problem(
                "L009.short_window",
                settings.place("window_size"),
                metrics=METRIC_NAMES[settings.metric],
            )
        if settings.metric != "ks" and made.level > _HIGHEST_LEVEL:
            value = limit_quantile(settings.metric, _HIGHEST_LEVEL)
            yield problem(
                "L009.level", settings.place("significance_level"), level=made.level, value=value
            )
        yield from self._dependence(made)
        if made.calibration is None:
            return
        if made.threshold > 2 * made.theoretical:
            ratio = made.threshold / made.theoretical
            yield problem("L011.raised", settings.place("window_size"), ratio=ratio)
        if made.calibration.is_last:
            yield problem(
                "L011.resolution",
                settings.place("significance_level"),
                significance_level=settings.significance_level,
                windows=made.calibration.windows,
            )

    def _dependence(self, made: Plan) -> Iterable[Problem]:
        value, test = made.autocorrelation
        if made.calibration is not None or value <= _DEPENDENT:
            return
        needed = ROWS_PER_WINDOW * self.settings.window_size
        hint = f"calibration needs {needed} rows in time order, there are {len(self.rows)}"
        if len(self.rows) >= needed:
            hint = "write `calibration: stream`"
        place, label = self.settings.place("calibration"), made.labels[test]
        yield problem("L011.dependent", place, hint=hint, label=label, autocorrelation=value)


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
