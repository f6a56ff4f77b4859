"""The laws of the statistics under correct behaviour."""

import math

import numpy as np
import pytest
from eddi_runtime.safeml import Interpolated, Kolmogorov
from eddi_runtime.safeml.comparison import Comparison

from eddi_scaffold.kinds.safeml import thresholds as limits
from eddi_scaffold.kinds.safeml.calibration import of_windows


def tail(metric, n, m):
    return Interpolated(*limits.critical_values(metric, n, m))


@pytest.mark.parametrize("metric", ["cvm", "ad"])
def test_tail_is_the_inverse_of_the_quantile(metric):
    for level in (0.5, 0.1, 0.07, 0.01, 1e-3, 3e-6, 1e-6, 1e-9):
        value = limits.critical_value(metric, level, 1000, 70)
        assert tail(metric, 1000, 70)(value) == pytest.approx(level, rel=1e-9)


@pytest.mark.parametrize("metric", ["cvm", "ad"])
def test_above_one_half_the_quantile_stays(metric):
    assert limits.limit_quantile(metric, 0.9) == limits.limit_quantile(metric, 0.5)
    assert tail(metric, 1000, 70)(0.0) == 1.0


def test_known_quantiles():
    """Anderson and Darling (1952) and Marsaglia and Marsaglia (2004) print these digits."""
    assert limits.limit_quantile("cvm", 0.05) == pytest.approx(0.46136, abs=1e-5)
    assert limits.limit_quantile("ad", 0.05) == pytest.approx(2.4924, abs=1e-4)


def test_beyond_the_table_the_quantile_is_on_the_safe_side():
    assert limits.limit_quantile("cvm", 1e-8) == pytest.approx(3.428, abs=1e-3)  # exact: 3.398


def test_kolmogorov():
    tail = Kolmogorov(10_000, 10_000)
    scale = math.sqrt(10_000 / 2)
    assert tail(1.3581 / scale) == pytest.approx(0.05, abs=1e-4)
    assert tail(0.0) == tail(0.1 / scale) == 1.0
    assert tail(1.0) == pytest.approx(0.0, abs=1e-300)


def test_samples_too_small_for_a_variance():
    assert tail("ad", 1, 1)(1.0) == 1.0


@pytest.mark.parametrize(("metric", "mean"), [("cvm", 1 / 6 * (1 + 1 / 30)), ("ad", 1.0)])
def test_moments_by_simulation(metric, mean):
    chance = np.random.RandomState(8)
    found = []
    for _ in range(300):
        reference = np.sort(chance.normal(size=(1, 20)), axis=1)
        found += of_windows(
            Comparison(metric, reference, 10), chance.normal(size=(10, 1, 10))
        ).tolist()
    expected = limits.moments(metric, 20, 10)
    assert expected[0] == pytest.approx(mean)
    assert np.mean(found) == pytest.approx(expected[0], rel=0.1)
    assert np.var(found) == pytest.approx(expected[1], rel=0.25)
