"""Test vectors of a perception scope: windows of the reference, of which a feature moves away.

Statistics are by their definition; bounds of probabilities, which are tables, are for ``verify``.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from decimal import ROUND_CEILING, Context, Decimal
from operator import mul
from typing import TYPE_CHECKING, Any

import numpy as np

from eddi_scaffold.evidence.vectors import Run, Step, changed, fitting_file

if TYPE_CHECKING:
    from eddi_scaffold.kinds.safeml.scope import SafeMLOptions
    from eddi_scaffold.program.input_expressions import BoundInput

Row = Sequence[float]
_MOST_WORK = 20_000_000  # pooled values that are looked at
_LARGEST = 1e36  # range of a feature: a float32 can hold what is as far away as can be
_FAR, _HALVED = 64.0, 16  # the longest way, in ranges of a feature, and how often it is halved


class Definition:
    """The monitor, which looks through reference and window anew in each step."""

    def __init__(self, options: SafeMLOptions) -> None:
        self.plan, self.settings = options.plan, options.plan.settings
        self.n, self.m = self.plan.n, self.settings.window_size
        self.max_age_ns = math.inf if options.max_age is None else options.max_age * 1e9
        rows, table = self.plan.design.sample.tolist(), self.plan.design.table
        self.table: list[Row] = [] if table is None else table.tolist()
        self.rows: list[Row] = rows if self.table else [*zip(*rows, strict=True)]
        self.reference = np.sort([*zip(*map(self.values, self.rows), strict=True)])
        # it is written with nine digits, not below
        limit = Context(9, ROUND_CEILING).create_decimal(Decimal(self.plan.threshold))
        self.limit = self.plan.scale(float(limit))
        self.window: list[Row] = []  # values of the tests
        self.phase = self.accepted = self.rejected = self.accepted_ns = 0
        self.violation = False

    def values(self, row: Row) -> Row:
        """Return the value of each test."""
        if not self.table:
            return row
        centre, scale, *axes = self.table
        z = [(x - c) / s for x, c, s in zip(row, centre, scale, strict=True)]
        tests = [math.fsum(map(mul, axis, z)) for axis in axes]
        if (floor := self.plan.design.floor) is not None:
            rest = math.dist(z, [math.fsum(map(mul, tests, of)) for of in zip(*axes, strict=True)])
            tests.append(rest if rest >= floor else 0.0)
        return tests

    def with_sample(self, row: Row) -> list[Row]:
        """Return the window after a sample."""
        given = [float(np.float32(x)) for x in row] if self.plan.single else row
        return [*self.window, self.values(given)][-self.m :]

    def statistics(self, window: Sequence[Row]) -> Iterator[float]:
        """Yield of each test the distance of the distributions F and G, by definition."""
        n, m, total = self.n, self.m, self.n + self.m
        for pair in zip(self.reference, np.sort([*zip(*window, strict=True)]), strict=True):
            f, g = (np.searchsorted(of, np.concatenate(pair), side="right") for of in pair)
            gaps, weights = m * f - n * g, (f + g) * (total - f - g)  # n m (F - G)
            if self.settings.metric == "ks":
                yield int(np.abs(gaps).max()) / (n * m)
            elif self.settings.metric == "cvm":
                yield int((gaps * gaps).sum()) / (n * m * total**2)
            else:  # what is done element by element is the same on each machine
                parts = (gaps * gaps)[weights > 0] / weights[weights > 0]
                yield math.fsum(parts.tolist()) / (n * m)

    def step(self, t: int, value: Any) -> dict[str, Any]:
        """Return the results of a step with samples, or with what is none."""
        if self.accepted and t - self.accepted_ns > self.max_age_ns * (1 + 1e-9):
            self.window, self.phase = [], 0
        bad: list[str] = []
        for row in value if isinstance(value, list) else () if value is None else [value]:
            if not isinstance(row, list) or len(row) != len(self.rows[0]):
                bad.append("empty" if row == [] else "wrong_length")
            elif not all(isinstance(x, float) for x in row):
                bad.append("not_finite")
            else:
                self.accepted, self.accepted_ns = self.accepted + 1, t
                if self.phase % self.settings.stride == 0:
                    self.window = self.with_sample(row)
                self.phase += 1
        self.rejected += len(bad)
        bad += ["stale"] if value is None and self.accepted else []
        reason = (*bad, "" if len(self.window) == self.m else "filling")[0]
        values = [] if reason else [*self.statistics(self.window)]
        self.violation = max(values) >= self.limit if values else self.violation
        is_kept = not reason or self.settings.on_omission == "hold"
        shown = {"reason": reason, "accepted": self.accepted, "rejected": self.rejected}
        shown |= {"omission": reason != "", "odd_violation": self.violation and is_kept}
        component = values.index(max(values)) if values else -1
        return {**shown, "statistic": max(values, default=None), "component": component}


def _run(options: SafeMLOptions, feature: int) -> Run:
    """Return a window of the reference, of which sample after sample moves along a feature."""
    of, steps, results = Definition(options), list[Step](), dict[str, Any]()
    period, t = round(1e9 / (options.frequency or 10.0)), 0
    digits = 9 if of.plan.single else 17
    base = [[float(f"{x:.{digits}g}") for x in of.rows[k * of.n // of.m]] for k in range(of.m)]
    span = min(float(np.ptp([row[feature] for row in of.rows])), _LARGEST) or 1.0

    def play(value: Any, wait: int = period) -> None:
        nonlocal t, results
        times = range(of.settings.stride)  # so that each sample enters the window
        value = [row for row in value for _ in times] if isinstance(value, list) else value
        t, before = t + wait, results
        results = of.step(t, value)
        steps.append(Step(t, {options.input_id: value}, changed(before, results)))

    def moved(row: Row, way: float) -> tuple[list[float], bool]:
        value = float(f"{row[feature] + way * span:.9g}")
        sample = [*row[:feature], value, *row[feature + 1 :]]
        return sample, max(of.statistics(of.with_sample(sample))) >= of.limit

    play(base[:-1])
    play(base[-1:])
    ends = 0  # just below the threshold, just above, just below
    for row in base:
        low, high, is_end = 0.0, _FAR, moved(row, _FAR)[1]
        for _ in range(_HALVED * is_end):
            middle = (low + high) / 2
            low, high = (low, middle) if moved(row, middle)[1] else (middle, high)
        play([moved(row, low if is_end and ends != 1 else high)[0]])
        if (ends := ends + is_end) == 3:
            break
    if feature == 0:
        sample = base[0]
        wrong = [[[]], [sample[1:]], [[{"is": "nan"}, *sample[1:]]]]
        for value in ("text", True, {"is": "object"}, None, *wrong):
            play(value)
            play([sample])
        if options.max_age is not None:
            play([sample], math.floor(of.max_age_ns))
            play([sample], math.ceil(of.max_age_ns * (1 + 1e-9)) + 1)
    return Run(f"moved:feature {feature}", steps)


def safeml_vectors(
    options: SafeMLOptions, inputs: Sequence[BoundInput], about: Mapping[str, str]
) -> str:
    """Return the content of ``vectors.json``, empty where it would be too much."""
    plan, m = options.plan, options.plan.settings.window_size
    features = plan.design.sample.shape[0 if plan.design.table is None else 1]
    if features * plan.tests * (plan.n + m) * (m + 3 * _HALVED) > _MOST_WORK:
        return ""
    rows = (_run(options, feature) for feature in range(features))
    return fitting_file(about, inputs, rows, complete=True)
