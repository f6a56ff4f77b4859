"""Time of a SafeML step: ours compared with a loop of scipy and with SafeML's own statistic loop.

Ours is the whole monitor: one new sample in, the verdict out, with a full window of 100. The peers
compute the same number of distances between the window and the reference anew, as one would with
the libraries: ``scipy.stats`` for each feature, and the loop over the pooled sample that the SafeML
library runs in Python (written here anew from its description). Measured in turn in one process.

    python benchmarks/safeml.py [--quick] [--json]
"""

from __future__ import annotations

import argparse
import json
import statistics
import sys
import time
import warnings
from collections.abc import Callable, Sequence
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np

ROOT = Path(__file__).resolve().parents[1]
sys.path[:0] = [str(ROOT), str(ROOT / "runtime_lib" / "src")]

from eddi_runtime import Monitor  # noqa: E402 - a benchmark runs from the checkout

from eddi_scaffold.common.files import Source  # noqa: E402
from eddi_scaffold.kinds.safeml.scope import (  # noqa: E402
    Design,
    Metric,
    Plan,
    ReferenceSample,
    SafeMLFile,
    SafeMLOptions,
    SafeMLSettings,
)
from runtime_lib.tests.bound_models import bound_input, bound_model  # noqa: E402

WINDOW = 100
SIZES = [(1000, 10), (1000, 100), (10_000, 10), (10_000, 100)]
METRICS: tuple[Metric, ...] = ("ks", "cvm", "ad")
Array = Any
"""numpy.ndarray."""

Distances = Callable[[Array, Array], object]
"""Reference (n, d) and window (m, d) -> d distances."""


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--quick", action="store_true", help="fewer and shorter runs")
    parser.add_argument("--json", action="store_true")
    options = parser.parse_args()
    runs, steps = (2, 200) if options.quick else (7, 1000)
    peers = [*scipy_peers(), ("SafeML's loop", {name: safeml(name) for name in METRICS}, None)]
    rows = []
    for n, d in SIZES:
        for metric in METRICS:
            rows += rows_of(metric, n, d, peers, runs, steps)
    rows += pca_rows(runs, steps)
    if options.json:
        print(json.dumps({"rows": rows}, indent=1))
    else:
        print_table(rows)


def rows_of(
    metric: Metric, n: int, d: int, peers: Sequence[Any], runs: int, steps: int
) -> list[dict[str, object]]:
    """Return a row for each peer."""
    chance = np.random.default_rng(n + d)
    reference, samples = chance.normal(size=(n, d)), chance.normal(size=(steps + WINDOW, d))
    monitor = monitor_of(reference, metric)
    window = samples[-WINDOW:]
    rows = []
    for name, functions, reason in peers:
        row = {"case": f"{metric}, n = {n}, d = {d}", "peer": name}
        if reason is not None:
            ours = statistics.median(step_seconds(monitor, samples) for _ in range(runs))
            rows.append(row | {"ours_s": ours, "peer_s": None, "ratio": None, "reason": reason})
            continue
        pairs = [
            (step_seconds(monitor, samples), peer_seconds(functions[metric], reference, window))
            for _ in range(runs)
        ]
        times = {
            "ours_s": statistics.median(one for one, _ in pairs),
            "peer_s": statistics.median(other for _, other in pairs),
            "ratio": statistics.median(other / one for one, other in pairs),
        }
        rows.append(row | times)
    return rows


def pca_rows(runs: int, steps: int) -> list[dict[str, object]]:
    """Return the step of ten components and the residual of 100 features, beside ten features."""
    chance = np.random.default_rng(3)
    wide, samples = chance.normal(size=(10_000, 100)), chance.normal(size=(steps + WINDOW, 100))
    pca = monitor_of(wide, "ks", components=10, residual=True, halves=True)
    plain = monitor_of(wide[:5000, :10], "ks")
    pairs = [
        (step_seconds(pca, samples), step_seconds(plain, samples[:, :10])) for _ in range(runs)
    ]
    times = {
        "ours_s": statistics.median(one for one, _ in pairs),
        "peer_s": statistics.median(other for _, other in pairs),
        "ratio": statistics.median(other / one for one, other in pairs),
    }
    case = "ks, PCA-10 of d = 100 with residual"
    return [{"case": case, "peer": "ours, d = 10 without PCA", **times}]


def step_seconds(monitor: Monitor[Any], samples: Array) -> float:
    """Return the seconds of one step; the window is full."""
    monitor.reset()
    inputs = [SimpleNamespace(sample=row) for row in samples.tolist()]
    for one in inputs[:WINDOW]:
        monitor.execute_step(one, 0)
    start = time.process_time()
    for one in inputs[WINDOW:]:
        result = monitor.execute_step(one, 0)
    assert not result.omission
    return (time.process_time() - start) / (len(inputs) - WINDOW)


def peer_seconds(distances: Distances, reference: Array, window: Array) -> float:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        start = time.process_time()
        distances(reference, window)
        return time.process_time() - start


def monitor_of(reference: Array, metric: Metric, **parts: Any) -> Monitor[Any]:
    settings, design = SafeMLSettings(WINDOW, "r.csv", 0.1, metric), Design(reference, **parts)
    threshold = 17_000 if metric == "ks" else 3.5
    plan = Plan(settings, design, False, 0.1, threshold, None, threshold, "exact", (0.0, 0))
    file = SafeMLFile(settings, ReferenceSample(Source("r.csv", b""), reference))
    options = SafeMLOptions(plan, "sample", None, None)
    bound = bound_model("safeml", "Benchmark", file, options, [bound_input("sample")])
    monitor: Monitor[Any] = bound.monitor()
    return monitor


def scipy_peers() -> list[tuple[str, dict[str, Distances], str | None]]:
    try:
        from scipy import stats
    except ImportError:
        return [("scipy", {}, "scipy is not installed")]

    def each(test: Callable[[Array, Array], object]) -> Distances:
        return lambda reference, window: [
            test(one, other) for one, other in zip(reference.T, window.T, strict=True)
        ]

    return [
        (
            "scipy",
            {
                "ks": each(stats.ks_2samp),
                "cvm": each(stats.cramervonmises_2samp),
                "ad": each(lambda one, other: stats.anderson_ksamp([one, other])),
            },
            None,
        )
    ]


def safeml(metric: str) -> Distances:
    """Return SafeML's way: sort the pooled sample, walk over it, add up |F - G|."""

    def one(reference: Array, window: Array) -> float:
        pooled = np.concatenate([reference, window])
        order = np.argsort(pooled)
        steps_f = np.concatenate(
            [np.full(len(reference), 1 / len(reference)), np.zeros(len(window))]
        )
        steps_g = np.concatenate([np.zeros(len(reference)), np.full(len(window), 1 / len(window))])
        pooled, steps_f, steps_g = pooled[order], steps_f[order], steps_g[order]
        found = f = g = 0.0
        count = len(pooled)
        for k in range(count - 1):
            f += steps_f[k]
            g += steps_g[k]
            if pooled[k] == pooled[k + 1]:
                continue
            height = abs(f - g)
            if metric == "ks":
                found = max(found, height)
            elif metric == "cvm":
                found += height
            else:
                found += height / ((k + 1) * (count - k - 1)) ** 0.5
        return found

    return lambda reference, window: [one(a, b) for a, b in zip(reference.T, window.T, strict=True)]


def print_table(rows: list[dict[str, Any]]) -> None:
    print(f"{'case':<38} {'ours':>10} {'peer':>13} {'ratio':>8}  which peer")
    for row in rows:
        peer = f"{row['peer_s'] * 1e6:>10,.0f} us" if row["peer_s"] else f"{'-':>13}"
        ratio = f"{row['ratio']:,.1f}" if row["ratio"] else "-"
        reason = f" ({row['reason']})" if row.get("reason") else ""
        ours = f"{row['ours_s'] * 1e6:>7,.1f} us"
        print(f"{row['case']:<38} {ours} {peer} {ratio:>8}  {row['peer']}{reason}")


if __name__ == "__main__":
    main()
