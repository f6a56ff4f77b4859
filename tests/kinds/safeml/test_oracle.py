"""The shared oracle: statistics, thresholds, calibration and traces, from scipy's definitions."""

import math
from functools import cache
from itertools import combinations
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
import yaml
from eddi_runtime.safeml import Interpolated, Kolmogorov
from eddi_runtime.safeml.comparison import Comparison

from eddi_scaffold.common.files import Source
from eddi_scaffold.kinds.safeml.compile import upwards
from eddi_scaffold.kinds.safeml.plan import plan
from eddi_scaffold.kinds.safeml.scope import Metric, Plan, ReferenceSample, SafeMLSettings
from eddi_scaffold.kinds.safeml.thresholds import (
    critical_value,
    critical_values,
    ks_asymptotic,
    ks_tail,
    largest_possible,
    limit_quantile,
    theoretical,
)
from runtime_lib.tests.safeml.monitors import of_windows
from tests.data_files import data_file
from tests.kinds.safeml.monitors import LONG_NAMES, running


@cache
def oracle() -> dict[str, Any]:
    text = data_file("monitors/oracle_safeml.yml").read_text("utf-8")
    return dict(yaml.load(text, yaml.CSafeLoader))


def lcg(count: int, offset: int) -> list[float]:
    return [((i * 7919 + offset) % 104729) / 104729 for i in range(count)]


def samples(case: dict[str, Any]) -> tuple[list[float], list[float]]:
    """Return reference and window of a case, of which some are given by a formula."""
    if "reference" in case:
        return case["reference"], case["window"]
    reference, window = lcg(case["n"], 3), lcg(case["m"], 17)
    if case["name"].endswith("shift"):
        window = [0.8 * value + 0.15 for value in window]
    if case["name"].endswith("ties"):
        reference = np.round(reference, 2).tolist()
        window = np.round(0.9 * np.array(window), 2).tolist()
    return reference, window


def test_statistics() -> None:
    checked = 0
    for case in oracle()["statistics"]:
        reference, window = (np.array(one) for one in samples(case))
        n, m = case["n"], case["m"]
        assert (len(reference), len(window)) == (n, m)
        found = {
            metric: of_windows(Comparison(metric, np.sort(reference)[None], m), window[None, None])
            for metric in LONG_NAMES
        }
        ks, cvm, ad = (found[metric][0, 0] for metric in ("ks", "cvm", "ad"))
        assert int(ks) == round(case["ks"] * n * m), case["name"]
        assert ks_tail(n, m, int(ks)) == pytest.approx(case["ks_p_exact"], rel=3e-9)
        assert cvm == pytest.approx(case["cvm_ecdf"], rel=1e-10, abs=1e-15), case["name"]
        equal = len({*reference.tolist(), *window.tolist()}) == 1
        right = case["ad_right"] if case["ad_right"] is not None else (0.0 if equal else 1.0)
        assert ad == pytest.approx(right, rel=1e-10, abs=1e-13), case["name"]
        checked += 1
    assert checked == 11


def test_thresholds() -> None:
    for case in oracle()["thresholds"]:
        n, m, level = case["n"], case["m"], case["alpha_per_test"]
        scaled, method = theoretical("ks", n, m, level)
        assert (scaled, method) == (case["ks_exact_int"], "exact")
        assert ks_tail(n, m, int(scaled)) == pytest.approx(
            case["ks_exact_attained_level"], rel=1e-8
        )
        for metric in ("cvm", "ad"):
            assert critical_value(metric, level, n, m) == pytest.approx(case[metric], rel=1e-9)
        asymptotic = ks_asymptotic(n, m, level) / (n * m)
        assert 0 <= asymptotic - case["ks_asymptotic"] < 1 / math.lcm(n, m) + 1e-12


def test_the_table_of_limits_is_the_one_to_ship() -> None:
    for row in oracle()["limit_quantiles"]:
        for metric in ("cvm", "ad"):
            assert limit_quantile(metric, row["p"]) == row[metric]


def recipe(case: dict[str, Any]) -> np.ndarray[Any, Any]:
    """Return the rows of a calibration case: a linear congruential generator, then AR(1)."""
    state, values = case["seed"], []
    for _ in range(case["rows"] * case["features"]):
        state = (1103515245 * state + 12345) % 2**31
        values.append(state / 2**31)
    noise = np.array(values).reshape(case["rows"], case["features"])
    rows = noise.copy()
    for t in range(1, len(rows)):
        rows[t] = case["phi"] * rows[t - 1] + noise[t]
    if case["decimals"] is not None:
        rows = np.rint(rows * 10 ** case["decimals"]) / 10 ** case["decimals"]
    return rows


def planned(case: dict[str, Any]) -> Plan:
    settings = SafeMLSettings(
        case["window_size"],
        "",
        case["significance_level"],
        case["metric"],
        calibration="stream",
        calibration_stride=case["stride"],
    )
    made = plan(settings, ReferenceSample(Source("", b""), recipe(case)), single=False)[0]
    assert made is not None
    return made


def test_calibration() -> None:
    for case in oracle()["calibration"]:
        made = planned(case)
        assert made.calibration is not None
        assert made.calibration.windows == case["windows"]
        assert made.autocorrelation[0] == pytest.approx(case["lag1_max"], rel=1e-6)
        tolerance = 0.0 if case["metric"] == "ks" else 1e-9
        assert made.theoretical == pytest.approx(case["theoretical"], rel=tolerance)
        assert made.calibration.quantile == pytest.approx(case["quantile"], rel=tolerance)
        assert made.threshold == pytest.approx(case["effective"], rel=tolerance)


def test_monitor_traces(tmp_path: Path) -> None:
    for trace in oracle()["monitor_traces"]:
        monitor = running(
            tmp_path,
            trace["reference"],
            window_size=trace["window_size"],
            significance_level=trace["significance_level"],
            distance_metric=LONG_NAMES[trace["metric"]],
            on_omission=trace["on_omission"],
            calibration="iid",
        )
        for number, step in enumerate(trace["steps"]):
            result = monitor.execute_step(SimpleNamespace(sample=step["input"]), 0)
            expected = (step["omission"], step["oddViolation"])
            assert (result.omission, result.odd_violation) == expected, (trace["name"], number)
            assert result.threshold == pytest.approx(trace["threshold"], rel=1e-9)
            if step["distance"] is None:
                assert math.isnan(result.statistic)
            else:
                assert result.statistic == pytest.approx(step["distance"], abs=1e-9)


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


@pytest.mark.parametrize(("metric", "least"), [("ks", 2), ("cvm", 3), ("ad", 2)])
def test_a_window_that_can_fire_and_one_that_cannot(metric: Metric, least: int) -> None:
    def can_fire(m: int) -> bool:
        return theoretical(metric, 20, m, 0.01)[0] <= largest_possible(metric, 20, m)

    assert (can_fire(least - 1), can_fire(least)) == (False, True)
    beyond = np.arange(20.0, 20.0 + least)[None, None]
    comparison = Comparison(metric, np.arange(20.0)[None], least)
    assert of_windows(comparison, beyond)[0, 0] == largest_possible(metric, 20, least)


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
