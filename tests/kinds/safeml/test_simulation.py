"""False violations and power by simulation; thousands of windows, tens of thousands when long."""

import numpy as np
import pytest
from eddi_runtime.safeml.comparison import Comparison

from benchmarks.safeml_power import METRICS, WINDOW, planned, power, process, rate
from eddi_scaffold.kinds.safeml.scope import Metric
from eddi_scaffold.kinds.safeml.thresholds import theoretical
from runtime_lib.tests.safeml.monitors import of_windows

pytestmark = pytest.mark.slow


@pytest.fixture(scope="module")
def is_long(request: pytest.FixtureRequest) -> bool:
    return bool(request.config.getoption("--hypothesis-profile", default=None) == "long")


@pytest.mark.parametrize("metric", METRICS)
def test_ten_independent_tests(metric: Metric, is_long: bool) -> None:
    """20,000 windows over 8 references: between 0.08 and 0.105 of correct ones are violations."""
    windows = 2500 if is_long else 250
    chance = np.random.default_rng(17)
    threshold, _ = theoretical(metric, 1000, WINDOW, 0.01)
    rates = []
    for _ in range(8):
        reference = np.sort(chance.normal(size=(10, 1000)), axis=1)
        comparison = Comparison(metric, reference, WINDOW)
        for _ in range(windows // 250):
            found = of_windows(comparison, chance.normal(size=(250, 10, WINDOW)))
            rates.append((found.max(axis=1) >= threshold).mean())
    low, high = (0.08, 0.105) if is_long else (0.065, 0.125)
    assert low < float(np.mean(rates)) < high


@pytest.mark.parametrize("phi", [0.0, 0.5, 0.9])
def test_default_configuration_with_dependent_samples(phi: float, is_long: bool) -> None:
    """SESAME D7.2's configuration; thresholds come from calibration, whatever phi is."""
    references, rows = (12, 10_000) if is_long else (1, 4000)
    rates = []
    for seed in range(references):
        chance = np.random.default_rng(seed)
        reference = process(rows, phi, chance)
        stream = process(200 * WINDOW, phi, chance)
        rates.append(rate(planned(reference, "ks", 10), stream))
    assert np.mean(rates) < (0.13 if is_long else 0.16)


def test_dependent_samples_without_calibration_are_false_violations() -> None:
    """What calibration is for."""
    chance = np.random.default_rng(3)
    rows = process(2000, 0.9, chance)
    made = planned(rows, "ks", 10, calibration="iid")
    assert rate(made, process(100 * WINDOW, 0.9, chance)) > 0.9


def test_a_flat_spectrum(is_long: bool) -> None:
    """Axes from the rows of the reference itself would make it look too near to its subspace."""
    found = []
    for seed in range(12 if is_long else 1):
        chance = np.random.default_rng(seed)
        reference = chance.normal(size=(400, 100))
        made = planned(reference, "ks", 10, calibration="iid")
        stream = chance.normal(size=((200 if is_long else 60) * WINDOW, 100))
        found.append(rate(made, stream))
    assert np.mean(found) < (0.13 if is_long else 0.15)


@pytest.mark.parametrize(
    ("metric", "components", "fault", "low", "high"),
    [
        ("ks", None, "none", 0.02, 0.15),
        ("ks", None, "shift by 0.5 sd", 0.85, 1.0),
        ("cvm", None, "shift by 0.5 sd", 0.93, 1.0),
        ("ad", None, "shift by 0.5 sd", 0.93, 1.0),
        ("ad", None, "scale x 1.5", 0.7, 1.0),
        ("ks", None, "frozen at its mean", 1.0, 1.0),
        ("ks", None, "correlation lost", 0.0, 0.2),
        ("ks", 10, "correlation lost", 0.95, 1.0),
        ("ad", 10, "10 % outliers at 6 sd", 0.6, 1.0),
    ],
)
def test_power(metric: Metric, components: int | None, fault: str, low: float, high: float) -> None:
    assert low <= power(metric, components, fault, references=1, windows=100) <= high


def test_a_constant_feature_that_moves_is_seen_by_the_residual() -> None:
    chance = np.random.default_rng(8)
    rows = process(4000, 0.0, chance)
    rows[:, 4] = 3.14
    stream = process(20 * WINDOW, 0.0, chance)
    stream[:, 4] = 100.0
    assert rate(planned(rows, "ks", 10), stream) == 1.0
    without = planned(rows, "ks", 10, residual_test=False)
    assert rate(without, stream) < 0.5
