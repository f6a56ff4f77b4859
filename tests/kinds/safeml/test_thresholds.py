"""Thresholds: exact for Kolmogorov-Smirnov, on the safe side for the others."""

import math
from itertools import combinations

import numpy as np
import pytest
from eddi_runtime.safeml import Interpolated, Kolmogorov
from eddi_runtime.safeml.comparison import Comparison

from eddi_scaffold.kinds.safeml.compile import upwards
from eddi_scaffold.kinds.safeml.thresholds import (
    can_fire,
    critical_value,
    critical_values,
    ks_asymptotic,
    ks_tail,
    of_windows,
    smallest_window,
    theoretical,
)


@pytest.mark.parametrize(("n", "m"), [(1, 1), (5, 3), (4, 4), (6, 4), (7, 2)])
def test_exact_probabilities_by_counting_every_order(n: int, m: int) -> None:
    distances = []
    for places in combinations(range(n + m), m):
        reference = np.array([[k for k in range(n + m) if k not in places]], dtype=float)
        window = np.array([[places]], dtype=float)
        distances.append(int(of_windows(Comparison("ks", reference, m), window)[0, 0]))
    for scaled in range(n * m + 2):
        expected = sum(distance >= scaled for distance in distances) / len(distances)
        assert ks_tail(n, m, scaled) == pytest.approx(expected, abs=1e-14)


@pytest.mark.parametrize(("n", "m"), [(20, 10), (997, 100), (1000, 100), (3000, 500)])
@pytest.mark.parametrize("level", [0.1, 0.01, 1e-4])
def test_the_threshold_is_the_smallest_of_its_level(n: int, m: int, level: float) -> None:
    scaled, method = theoretical("ks", n, m, level)
    assert method == "exact"
    assert ks_tail(n, m, int(scaled)) <= level < ks_tail(n, m, int(scaled) - math.gcd(n, m))


def test_large_samples_take_the_asymptotic_one_which_is_not_below() -> None:
    scaled, method = theoretical("ks", 100_000, 1000, 0.01)
    assert method == "asymptotic"
    assert scaled == ks_asymptotic(100_000, 1000, 0.01)
    for level in (0.1, 0.01, 0.001):
        assert ks_asymptotic(1000, 100, level) >= theoretical("ks", 1000, 100, level)[0]


@pytest.mark.parametrize("metric", ["ks", "cvm", "ad"])
def test_a_window_that_can_fire_and_one_that_cannot(metric: str) -> None:
    least = smallest_window(metric, 1000, 0.01)
    assert least is not None
    assert can_fire(metric, 1000, least, 0.01)
    assert least == 1 or not can_fire(metric, 1000, least - 1, 0.01)
    threshold, _ = theoretical(metric, 1000, least, 0.01)
    beyond = np.arange(1000.0, 1000.0 + least)[None, None]
    assert of_windows(Comparison(metric, np.arange(1000.0)[None], least), beyond)[0, 0] >= threshold


def test_upwards() -> None:
    for value in (0.123456789012, 1e-9 / 3, 123456.7890123, 0.21, 1.0):
        assert value <= upwards(value) <= value * (1 + 1.1e-8)
        assert float(f"{upwards(value):.8e}") == upwards(value)
    assert upwards(0.0) == 0.0


def tail(metric: str, n: int, m: int) -> Interpolated:
    return Interpolated(*critical_values(metric, n, m))


@pytest.mark.parametrize("metric", ["cvm", "ad"])
def test_tail_is_the_inverse_of_the_quantile(metric: str) -> None:
    for level in (0.5, 0.1, 0.07, 0.01, 1e-3, 3e-6, 1e-6, 1e-9):
        value = critical_value(metric, level, 1000, 70)
        assert tail(metric, 1000, 70)(value) == pytest.approx(level, rel=1e-9)


def test_kolmogorov() -> None:
    tail = Kolmogorov(10_000, 10_000)
    scale = math.sqrt(10_000 / 2)
    assert tail(1.3581 / scale) == pytest.approx(0.05, abs=1e-4)
    assert tail(0.0) == tail(0.1 / scale) == 1.0
    assert tail(1.0) == pytest.approx(0.0, abs=1e-300)


def test_samples_too_small_for_a_variance() -> None:
    assert tail("ad", 1, 1)(1.0) == 1.0
