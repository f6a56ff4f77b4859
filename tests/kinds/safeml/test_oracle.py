"""The shared oracle: statistics, thresholds, calibration and traces, from scipy's definitions."""

import math
from functools import cache
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
import yaml
from eddi_runtime.safeml.comparison import Comparison

from eddi_scaffold.common.files import Source
from eddi_scaffold.kinds.safeml.plan import plan
from eddi_scaffold.kinds.safeml.scope import Plan, ReferenceSample, SafeMLSettings
from eddi_scaffold.kinds.safeml.thresholds import (
    critical_value,
    ks_asymptotic,
    ks_tail,
    limit_quantile,
    of_windows,
    theoretical,
)
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
