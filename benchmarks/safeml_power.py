"""Share of windows that violate, for faults in one of 20 features: docs/explanation/safeml.md.

python benchmarks/safeml_power.py [--quick]
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

import numpy as np

ROOT = Path(__file__).resolve().parents[1]
sys.path[:0] = [str(ROOT), str(ROOT / "runtime_lib" / "src")]

from eddi_runtime.safeml.comparison import Comparison  # noqa: E402 - from the checkout

from eddi_scaffold.common.files import Source  # noqa: E402
from eddi_scaffold.kinds.safeml.plan import plan  # noqa: E402
from eddi_scaffold.kinds.safeml.scope import (  # noqa: E402
    Metric,
    Plan,
    ReferenceSample,
    SafeMLSettings,
)
from eddi_scaffold.kinds.safeml.thresholds import largest_statistics  # noqa: E402

Rows = Any
"""numpy.ndarray (rows, features)."""

FEATURES, FACTORS, WINDOW, LEVEL = 20, 10, 100, 0.1
NOISE = 0.3


def process(rows: int, phi: float, chance: np.random.Generator) -> Rows:
    """Return samples of correct behaviour; each factor is an AR(1) process of variance 1."""
    mixing = np.random.default_rng(1).normal(size=(FACTORS, FEATURES))
    mixing /= np.sqrt((mixing**2).sum(axis=0) + NOISE**2)
    factors = chance.normal(size=(rows, FACTORS))
    for t in range(1, rows):
        factors[t] = phi * factors[t - 1] + np.sqrt(1 - phi * phi) * factors[t]
    return factors @ mixing + NOISE * chance.normal(size=(rows, FEATURES)) / 3


def _outliers(rows: Rows, chance: np.random.Generator) -> Rows:
    return np.where(chance.random(len(rows)) < 0.1, rows[:, 0] + 6.0, rows[:, 0])


FAULTS: Mapping[str, Callable[[Rows, np.random.Generator], Rows]] = {
    "none": lambda rows, _: rows[:, 0],
    "shift by 0.3 sd": lambda rows, _: rows[:, 0] + 0.3 * rows[:, 0].std(),
    "shift by 0.5 sd": lambda rows, _: rows[:, 0] + 0.5 * rows[:, 0].std(),
    "shift by 1 sd": lambda rows, _: rows[:, 0] + 1.0 * rows[:, 0].std(),
    "scale x 0.5": lambda rows, _: rows[:, 0] * 0.5,
    "scale x 1.5": lambda rows, _: rows[:, 0] * 1.5,
    "10 % outliers at 6 sd": _outliers,
    "correlation lost": lambda rows, chance: chance.permutation(rows[:, 0]),
    "frozen at its mean": lambda rows, _: np.full(len(rows), rows[:, 0].mean()),
}
"""Name -> what becomes of feature 0."""


def planned(rows: Rows, metric: Metric, components: int | None, **more: Any) -> Plan:
    """Return the plan of a reference; the configuration is SESAME D7.2's but for what is given."""
    settings = SafeMLSettings(WINDOW, "", LEVEL, metric, n_components=components, **more)
    made, problems = plan(settings, ReferenceSample(Source("", b""), rows), single=False)
    assert made is not None, problems
    return made


def rate(made: Plan, stream: Rows) -> float:
    design = made.design
    comparison = Comparison(made.settings.metric, design.reference, WINDOW)
    maxima = largest_statistics(comparison, design.series(stream), stride=1, distance=WINDOW)
    return float((maxima >= made.threshold).mean())


def power(
    metric: Metric, components: int | None, fault: str, *, references: int, windows: int
) -> float:
    found = []
    for seed in range(references):
        chance = np.random.default_rng(100 + seed)
        rows = process(4000, 0.0, chance)
        stream = process(windows * WINDOW, 0.0, chance)
        stream[:, 0] = FAULTS[fault](stream, chance)
        found.append(rate(planned(rows, metric, components, calibration="iid"), stream))
    return float(np.mean(found))


METRICS: tuple[Metric, ...] = ("ks", "cvm", "ad")


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--quick", action="store_true", help="fewer windows")
    references, windows = (2, 50) if parser.parse_args().quick else (8, 250)
    columns = [(metric, components) for components in (None, 10) for metric in METRICS]
    for fault in FAULTS:
        shares = (
            power(metric, components, fault, references=references, windows=windows)
            for metric, components in columns
        )
        print(f"| {fault} | {' | '.join(f'{share:.2f}' for share in shares)} |", flush=True)


if __name__ == "__main__":
    main()
