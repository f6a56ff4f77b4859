"""Derive tests and thresholds from a reference and a configuration, with all problems."""

from __future__ import annotations

import math
from functools import lru_cache
from typing import Any

import numpy as np
from eddi_runtime.safeml.arrays import rounded
from eddi_runtime.safeml.comparison import Comparison

from eddi_scaffold.common.problems import Problem, has_errors, plural, problem, shortened_list
from eddi_scaffold.kinds.safeml import scope, thresholds
from eddi_scaffold.kinds.safeml.thresholds import autocorrelation, calibrate

ROWS_PER_WINDOW = 20
"""Windows that a reference must hold for calibration to be worth it (``calibration: auto``)."""
_DEPENDENT = 0.2
_SMALL_COMPONENT = 1e-12
_UNLIKE_UNITS = 100.0
_LARGEST_SQUARED = 1e150
_FEWEST_FOR_LIMITS = 10


@lru_cache(maxsize=8)
def plan(
    settings: scope.SafeMLSettings, reference: scope.ReferenceSample, *, single: bool
) -> tuple[scope.Plan | None, tuple[Problem, ...]]:
    """Find tests and thresholds (L004 to L013); ``single``: samples come as float32."""
    planner = _Planner(settings, reference, single=single)
    return planner.plan(), tuple(planner.problems)


class _Planner:
    def __init__(
        self, settings: scope.SafeMLSettings, reference: scope.ReferenceSample, *, single: bool
    ) -> None:
        self.settings, self.single = settings, single
        self.problems: list[Problem] = []
        self.rows: scope.Rows = rounded(reference.rows, single=single)
        self.needed_rows = ROWS_PER_WINDOW * settings.window_size
        is_long = len(self.rows) >= self.needed_rows
        self.streams = settings.calibration == "stream" or (
            settings.calibration == "auto" and is_long
        )

    def plan(self) -> scope.Plan | None:
        """Return the plan, ``None`` after an error; either way what was found is reported."""
        settings, m = self.settings, self.settings.window_size
        if not np.isfinite(self.rows).all():
            self._report("L004.float32", "input_dtype")
            return None
        halves = self.streams or settings.n_components is not None
        _, other = scope.split(self.rows, halves=halves)
        constant = np.flatnonzero((self.rows == self.rows[0]).all(axis=0))
        if len(constant):
            features = shortened_list([*map(str, constant)])
            self._report("L010.constant", "reference_sample_file", features=features)
        if self.streams and len(other) < (needed := max(2 * m, (m - 1) * settings.stride + 1)):
            self._report("L008", "calibration", needed=2 * needed, rows=len(self.rows))
        elif len(self.rows) < 2 * m:
            rows, key = len(self.rows), "reference_sample_file"
            self._report("L009.few_rows", key, rows=rows, window=m)
        components = self._components(other)
        if has_errors(self.problems):
            return None
        leaves_something = components is not None and components < self.rows.shape[1]
        design = scope.Design(
            self.rows,
            components=components,
            standardize=settings.standardize,
            residual=leaves_something and settings.residual_test,
            halves=halves,
            single=self.single,
        )
        comparison = Comparison(settings.metric, design.reference, m)
        n, level = comparison.n, settings.significance_level / comparison.tests
        critical, method = thresholds.theoretical(settings.metric, n, m, level)
        largest = thresholds.largest_possible(settings.metric, n, m)
        if critical > largest:
            fields: dict[str, Any] = {"window": m, "values": n}
            fields["tests"] = plural(comparison.tests, "test")
            fields["significance_level"] = settings.significance_level
            self._report("L007.too_few", "window_size", **fields)
            return None
        threshold, calibration = critical, None
        if self.streams:
            calibration = calibrate(
                comparison,
                design.series(other),
                stride=settings.stride,
                distance=settings.calibration_stride or max(1, m // 20),
                level=settings.significance_level,
            )
            # Above the quantile, and never below the theoretical one.
            above = math.nextafter(calibration.quantile, math.inf)
            if settings.metric == "ks":
                above = int(calibration.quantile) + math.gcd(n, m)
            threshold = max(critical, above)
        if threshold > largest:
            self._report("L007.drift", "reference_sample_file")
            return None
        plan = scope.Plan(
            settings, design, self.single, level, critical, calibration, threshold, method,
            autocorrelation(design.series(self.rows)),
        )  # fmt: skip
        self._warn(plan)
        return plan

    def _report(self, case: str, key: str, /, *, hint: str | None = None, **fields: Any) -> None:
        self.problems.append(problem(case, self.settings.place(key), hint=hint, **fields))

    def _components(self, other: scope.Rows) -> int | None:
        settings, requested = self.settings, self.settings.n_components
        if requested is None:
            return None
        rows, features = other.shape
        if requested > min(rows, features):
            counts = {"possible": min(rows, features), "rows": rows, "features": features}
            self._report("L006.components", "n_components", requested=requested, **counts)
            return None
        if np.abs(self.rows).max() > _LARGEST_SQUARED:
            self._report("L004.overflow", "reference_sample_file")
            return None
        _, singular = scope.principal_axes(other, requested, standardize=settings.standardize)
        if singular[0] == 0.0:
            self._report("L006.no_axis", "n_components")
            return None
        if not settings.standardize:
            spread = other.std(axis=0)
            largest, median = float(spread.max()), float(np.median(spread[spread > 0.0]))
            if largest > _UNLIKE_UNITS * median:
                index = int(spread.argmax())
                self._report("L013", "n_components", spread=index, largest=largest, median=median)
        kept = int((singular[:requested] > _SMALL_COMPONENT * singular[0]).sum())
        if kept < requested:
            dropped = shortened_list([*map(str, range(kept, requested))])
            self._report("L010.dropped", "n_components", components=dropped, kept=kept)
        return kept

    def _warn(self, plan: scope.Plan) -> None:
        """Warn of thresholds that are less exact or less powerful than they look."""
        settings, metric = self.settings, self.settings.metric
        if metric != "ks" and settings.window_size < _FEWEST_FOR_LIMITS:
            self._report("L009.short_window", "window_size", metrics=scope.METRIC_NAMES[metric])
        correlation, test = plan.autocorrelation
        if plan.calibration is None:
            if correlation > _DEPENDENT:
                rows, label = len(self.rows), plan.labels[test]
                hint = f"calibration needs {self.needed_rows} rows in time order, there are {rows}"
                if rows >= self.needed_rows:
                    hint = "write `calibration: stream`"
                fields = {"label": label, "autocorrelation": correlation}
                self._report("L011.dependent", "calibration", hint=hint, **fields)
            return
        if plan.threshold > 2 * plan.theoretical:
            self._report("L011.raised", "window_size", ratio=plan.threshold / plan.theoretical)
        if plan.calibration.is_last:
            level, windows = settings.significance_level, plan.calibration.windows
            key = "significance_level"
            self._report("L011.resolution", key, significance_level=level, windows=windows)
