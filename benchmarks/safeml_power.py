"""Share of windows that violate, for faults in one of 20 features: docs/explanation/safeml.md.

python benchmarks/safeml_power.py [--quick]
"""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
sys.path[:0] = [str(ROOT), str(ROOT / "runtime_lib" / "src")]

from tests.kinds.safeml.test_simulation import FAULTS, METRICS, power  # noqa: E402 - the checkout


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
