"""Test vectors of a perception scope: windows of the reference that move away from it.

Statistics are computed by their definition over the pooled sample, without ranks that are kept.
"""

from __future__ import annotations

import math
import struct
from collections.abc import Iterator, Mapping, Sequence
from copy import copy
from decimal import ROUND_CEILING, Context, Decimal
from fractions import Fraction
from itertools import accumulate, pairwise
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from eddi_scaffold.evidence.vectors import MOST_BYTES, Run, Step, text, vectors_file

if TYPE_CHECKING:
    from eddi_scaffold.kinds.safeml.scope import SafeMLOptions
    from eddi_scaffold.program.input_expressions import BoundInput

Row = Sequence[float]
_MOST_WORK = 20_000_000  # pooled values that are looked at
_NEAR = 1e-9  # relative: nothing is expected of what rounding decides
_LARGEST = 3e38  # of what is given: a float32 can hold it
_FAR = 64.0  # in units of an axis: beyond all that is compared
_ASIDE, _WIDE = 8, 1e4  # samples that one axis does not see: so it has to be this one
_TRIED = 30  # windows of the reference
_HALVED = 14  # how often the way there is, until a window is just above the threshold
_LIMITS = {"cvm": (1 / 6, 1 / 45, 2 / math.pi**2), "ad": (1.0, 2 * (math.pi**2 - 9) / 3, 1.0)}
"""Mean and variance of the limiting laws, and growth of a quantile per -ln(level)."""
_NAMES = {
    "ks": "KolmogorovSmirnovDistance",
    "cvm": "CramerVonMisesDistance",
    "ad": "AndersonDarlingDistance",
}


class Definition:
    """The monitor, which looks through reference and window anew in each step."""

    def __init__(self, options: SafeMLOptions) -> None:
        self.options, self.plan = options, options.plan
        design, settings = self.plan.design, self.plan.settings
        self.settings, self.n, self.m = settings, self.plan.n, settings.window_size
        self.rows: list[Row] = design.sample.tolist()
        self.table: list[Row] = [] if design.table is None else design.table.tolist()
        if not self.table:
            self.rows = [*zip(*self.rows, strict=True)]
        self.reference = np.sort([*zip(*map(self.values, self.rows), strict=True)])
        self.law = [] if settings.metric == "ks" else [*_law(settings.metric, self.n, self.m)]
        self.limits = [self.scaled(value) for value in (self.plan.threshold, self.plan.theoretical)]
        self.window: list[Row] = []  # values of the tests
        self.phase = self.accepted = self.rejected = 0
        self.violation = False
        self.accepted_ns: int | None = None

    def scaled(self, limit: float) -> float:
        """Return a threshold as it is used: of nine digits, not below."""
        if self.settings.metric == "ks":
            return int(limit) / (self.n * self.m)
        return float(Context(9, ROUND_CEILING).create_decimal(Decimal(limit)))

    def values(self, row: Row) -> Row:
        """Return the value of each test."""
        if not self.table:
            return row
        centre, scale, *axes = self.table
        z = [(x - c) / s for x, c, s in zip(row, centre, scale, strict=True)]
        tests = [_dot(axis, z) for axis in axes]
        if self.plan.design.floor is None:
            return tests
        rest = [x - _dot(tests, parts) for x, parts in zip(z, zip(*axes, strict=True), strict=True)]
        size = math.sqrt(_dot(rest, rest))
        return [*tests, size if size >= self.plan.design.floor else 0.0]

    def sample(self, row: Row) -> Row:
        """Return the values of the tests for what comes as a message."""
        if self.plan.single:
            row = struct.unpack(f"{len(row)}f", struct.pack(f"{len(row)}f", *row))
        return self.values(row)

    def statistic(self, test: int, window: Sequence[Row]) -> float:
        """Return the distance of the empirical distributions F and G, by definition."""
        reference, own = self.reference[test], np.sort([row[test] for row in window])
        n, m, total = self.n, self.m, self.n + self.m
        pooled = np.concatenate([reference, own])
        f, g = (np.searchsorted(of, pooled, side="right") for of in (reference, own))
        gaps = m * f - n * g  # n m (F - G)
        if self.settings.metric == "ks":
            return int(np.abs(gaps).max()) / (n * m)
        if self.settings.metric == "cvm":
            return float(Fraction(sum(gap * gap for gap in gaps.tolist()), n * m * total**2))
        b = (f + g).astype(float)  # what is done element by element is the same on each machine
        d, b = (total * f - n * b)[b < total], b[b < total]
        return math.fsum((d * d / (b * (total - b))).tolist()) / (n * m)

    def tail(self, value: float) -> float:
        """Return the probability of at least a distance, for independent samples."""
        if not self.law:
            x = value * math.sqrt(self.n * self.m / (self.n + self.m))
            terms = (math.exp(-2 * (j * x) ** 2) * (-1) ** (j + 1) for j in range(1, 101))
            return 1.0 if x < 0.2 else min(1.0, max(0.0, 2 * math.fsum(terms)))
        *points, (slope, _) = self.law
        k = sum(point <= value for point, _ in points)
        if k == 0:
            return 1.0
        (low, level), above = points[k - 1], points[k : k + 1]
        rate = math.log(level / above[0][1]) / (above[0][0] - low) if above else 1 / slope
        return level * math.exp(-(value - low) * rate)

    def step(self, t: int, value: Any) -> dict[str, Any]:
        """Return the results of a step with samples, or with what is none."""
        max_age = math.inf if self.options.max_age is None else self.options.max_age
        if self.accepted_ns is not None and t - self.accepted_ns > max_age * 1e9 * (1 + _NEAR):
            self.window, self.phase = [], 0
        if value in (None, {"is": "absent"}):
            return self._result("filling" if self.accepted_ns is None else "stale")
        bad = []
        for row in value if isinstance(value, list) and value else [value]:
            length = len(row) if isinstance(row, list) else -1
            if length != len(self.rows[0]):
                bad.append("wrong_length" if length else "empty")
            elif not all(isinstance(x, int | float) for x in row):
                bad.append("not_finite")
            else:
                self.accepted, self.accepted_ns = self.accepted + 1, t
                if self.phase % self.settings.stride == 0:
                    self.window = [*self.window, self.sample(row)][-self.m :]
                self.phase += 1
        self.rejected += len(bad)
        is_full = len(self.window) == self.m
        return self._result(bad[0] if bad else "" if is_full else "filling")

    def _result(self, reason: str) -> dict[str, Any]:
        value: float | None = None
        component, bound = -1, None
        if not reason:
            statistics = [self.statistic(k, self.window) for k in range(self.plan.tests)]
            value = max(statistics)
            component = statistics.index(value)
            self.violation = value >= self.limits[0]
            # of ten digits: the last ones differ between machines
            bound = float(f"{min(1.0, self.plan.tests * self.tail(value)):.10g}")
        return {
            "omission": reason != "",
            "odd_violation": self.violation and (not reason or self.settings.on_omission == "hold"),
            "statistic": value,
            "component": component,
            "p_value_bound": bound,
            "threshold": self.limits[0],
            "threshold_theoretical": self.limits[1],
            "significance_level": self.settings.significance_level,
            "accepted": self.accepted,
            "rejected": self.rejected,
            "reason": reason,
        }


def _dot(a: Row, b: Row) -> float:
    return math.fsum(x * y for x, y in zip(a, b, strict=True))


def _law(metric: str, n: int, m: int) -> Iterator[tuple[float, float]]:
    """Yield critical values with their levels, at last the slope beyond.

    Quantiles of the limit are brought to mean and variance of finite samples (Anderson 1962; Scholz
    and Stephens 1987, section 2, for two samples).
    """
    total, mean, (limit_mean, limit_variance, slope) = n + m, 1.0, _LIMITS[metric]
    if metric == "cvm":
        mean = (1 + 1 / total) / 6
        spread = 4 * n * m * total - 3 * (n * n + m * m) - 2 * n * m
        variance = (total + 1) * spread / (180 * n * m * total**2)
    else:
        sums = [0.0, *accumulate(1 / i for i in range(1, total))]
        h, r = sums[-1], 1 / n + 1 / m
        g = math.fsum((h - sums[i]) / (total - i) for i in range(1, total - 1))
        a = 4 * g - 6 + (10 - 6 * g) * r
        b = 12 * g - 22 + 8 * h + (2 * g - 14 * h - 4) * r
        c = 36 * h + 4 + (2 * h - 6) * r
        product = (total - 1) * (total - 2) * (total - 3)
        variance = (a * total**3 + b * total**2 + c * total + 24) / product
    width = math.sqrt(variance / limit_variance)
    for line in Path(__file__).with_name("quantiles.txt").read_text("utf-8").splitlines()[1:]:
        level, *quantiles = map(float, line.split())
        yield mean + (quantiles[metric == "ad"] - limit_mean) * width, level
    yield slope * width, 0.0


class _Play:
    """A run in the making."""

    def __init__(self, definition: Definition) -> None:
        self.definition, self.steps, self.t = definition, list[Step](), 0
        self.period = round(1e9 / (definition.options.frequency or 10.0))
        self.results: dict[str, Any] = {}

    def step(self, value: Any, wait: int = 0, *, is_row: bool = True) -> None:
        """Add a step; of each row as many as one that enters the window needs."""
        times = self.definition.settings.stride if is_row else 1
        value = [row for row in value for _ in range(times)] if times > 1 else value
        self.t += wait or self.period
        old, self.results = self.results, self.definition.step(self.t, value)
        changes = {key: of for key, of in self.results.items() if key not in old or old[key] != of}
        self.steps.append(Step(self.t, {self.definition.options.input_id: value}, changes))


def _directions(of: Definition, test: int) -> Iterator[Row]:
    """Yield how a sample moves so that this test sees the most of it, then what it does not see."""
    width = len(of.rows[0])
    units = [[float(k == feature) for k in range(width)] for feature in range(width)]
    if not of.table:
        spread = min(float(of.reference[test][-1] - of.reference[test][0]), _LARGEST) or 1.0
        yield [x * spread for x in units[test]]
        return
    _, scale, *axes = of.table
    seen = [axes[test]] if test < len(axes) else axes
    aside = [
        [x - sum(axis[k] * axis[feature] for axis in seen) for k, x in enumerate(unit)]
        for feature, unit in enumerate(units)
    ]
    most = seen[0] if test < len(axes) else max(aside, key=lambda rest: _dot(rest, rest))
    for way in (most, *aside[: _ASIDE if test < len(axes) else 0]):
        yield [x * s for x, s in zip(way, scale, strict=True)]


def _run(of: Definition, test: int, base: Sequence[Row]) -> Run:
    """Return a window of the reference, of which row after row moves away in one direction."""
    play, (direction, *aside) = _Play(of), _directions(of, test)

    def moved(row: Row, offset: float, direction: Row = direction) -> list[float]:
        digits = 9 if of.plan.single else 12 if offset else 17
        pairs = zip(row, direction, strict=True)
        values = [min(max(x + offset * way, -_LARGEST), _LARGEST) for x, way in pairs]
        return [float(f"{value:.{digits}g}") for value in values]

    def is_above(row: Row, limit: float) -> bool:
        return of.statistic(test, [*of.window[1:], of.sample(row)]) >= limit

    play.step([moved(row, 0.0) for row in base[:-1]])
    play.step([moved(base[-1], 0.0)])
    targets = [of.limits[0]] * 2  # just below it, then just above
    if test == 0:
        points = [point for point, _ in of.law[:-1]]
        targets += [low / 2 + high / 2 for low, high in pairwise(points)] + [
            p + 1 for p in points[-1:]
        ]
    begun = play.results["statistic"] or 0.0
    targets = sorted(target for target in targets if target > begun)
    for row in base:
        low, high = 0.0, _FAR
        if targets and is_above(moved(row, high), targets[0]):
            for _ in range(_HALVED):
                middle = (low + high) / 2
                is_high = is_above(moved(row, middle), targets[0])
                low, high = (low, middle) if is_high else (middle, high)
            is_below = targets.count(targets.pop(0)) == 1 and of.limits[0] in targets[:1]
            high = low if is_below else high
        if targets or high != _FAR:
            play.step([moved(row, high)])
    for k, way in enumerate(aside):
        play.step([moved(base[k % len(base)], _WIDE * (-1) ** k, way)])
    if test == 0:
        _spoil(play, moved(base[0], _FAR))
    return Run(f"shift:{of.plan.labels[test]}", play.steps)


def _spoil(play: _Play, row: list[float]) -> None:
    """Add what is no sample, each followed by one, then samples that come late."""
    no_rows = ["text", True, {"is": "object"}, {"is": "absent"}, None, []]
    for value in (*no_rows, [row[1:]], [[{"is": "nan"}, *row[1:]]]):
        play.step(value, is_row=False)
        play.step([row])
    max_age = play.definition.options.max_age
    if max_age is not None:
        play.step([row], math.floor(max_age * 1e9))
        play.step([row], math.ceil(max_age * 1e9 * (1 + _NEAR)) + 1)


def safeml_vectors(
    options: SafeMLOptions, inputs: Sequence[BoundInput], about: Mapping[str, str]
) -> str:
    """Return the content of ``vectors.json``, empty where it would be too much."""
    plan, m = options.plan, options.plan.settings.window_size
    work = plan.tests * (plan.n + m) * (m + 60)
    if work > _MOST_WORK:
        return ""
    name = _NAMES[plan.settings.metric]
    lists: dict[str, list[Any]] = {"tables": [("metric_name", name)], "runs": []}
    of, tests = Definition(options), range(plan.tests)
    starts = range(max(1, min(plan.n // m, _TRIED)))
    bases = [[of.rows[k * of.n // m + start] for k in range(m)] for start in starts]
    windows = [[*map(of.values, base)] for base in bases]
    distances = [max(of.statistic(test, window) for test in tests) for window in windows]
    base = bases[distances.index(min(distances))]  # as much like the reference as can be
    size, complete = len(vectors_file(about, inputs, lists, complete=False)), True
    for test in tests:
        run = _run(copy(of), test, base)
        length = len(text(run).encode()) + 4
        fits = size + length < MOST_BYTES
        size, complete = size + length * fits, complete and fits
        lists["runs"] += [run] * fits
    return vectors_file(about, inputs, lists, complete=complete) if lists["runs"] else ""
