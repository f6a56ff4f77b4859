"""How long a monitor takes to start and to step, beside an earlier version in the same run.

One plain package of each kind, each run in a Python of its own. A start is the processor time from
the first import to the end of the first step, above bare Python: with bytecode, and without, as
where an installation cannot be written. Where a monitor needs numpy, that is imported before, and
the last row is what it takes. A step has the inputs at their defaults. Goals: a start takes at most
half of the old one, a step not more.

    python benchmarks/start.py [--quick] [--json] [--old COMMIT]
"""

from __future__ import annotations

import json
import os
import statistics
import subprocess
import sys
from pathlib import Path
from subprocess import PIPE
from typing import Any

from versions import EXAMPLES, parser, versions

WITH_NUMPY = ("SafeML",)
PROBE = """
import time
{before}
begin = time.process_time()
from {package}.EDDIInput import EDDIInput
from {package}.EDDIMonitor import EDDIMonitor
monitor, values = EDDIMonitor(), EDDIInput()
monitor.execute_step(values)
started = time.process_time() - begin
count, took = 1, 0.0
while took < {seconds}:
    count *= 2
    begin = time.process_time()
    for _ in range(count):
        monitor.execute_step(values)
    took = time.process_time() - begin
print(started, took / count)
"""
NUMPY = """
import time
begin = time.process_time()
import numpy
print(time.process_time() - begin)
"""


class Runs:
    """One monitor of both versions, which take turns.

    Args:
        packages: ours, and the peer's.
        kind: of the monitor.
        seconds: that steps are measured for.
    """

    def __init__(self, packages: list[Path], kind: str, seconds: float) -> None:
        self._packages = packages
        self._before = "import numpy" if kind in WITH_NUMPY else ""
        self._seconds = seconds

    def bare(self) -> list[float]:
        """Return the seconds of a start that finds no bytecode and leaves none."""
        return [self._run(package, "-B")[0] for package in self._packages]

    def whole(self) -> list[list[float]]:
        """Return the seconds of a start, and of a step."""
        return [self._run(package) for package in self._packages]

    def _run(self, package: Path, *options: str) -> list[float]:
        probe = PROBE.format(before=self._before, package=package.name, seconds=self._seconds)
        return probed(probe, package.parent, *options)


def main() -> None:
    options = parser(__doc__).parse_args()
    count, seconds = (3, 0.02) if options.quick else (15, 0.1)
    rows: list[dict[str, object]] = []
    with versions(options.old) as both:
        for kind in EXAMPLES:
            runs = Runs([version.plain(kind) for version in both], kind, seconds)
            bare = [runs.bare() for _ in range(count)]
            runs.whole()  # writes the bytecode
            whole = [runs.whole() for _ in range(count)]
            for name, pairs in (
                ("start without bytecode", bare),
                ("start", [[ours[0], peer[0]] for ours, peer in whole]),
                ("step", [[ours[1], peer[1]] for ours, peer in whole]),
            ):
                rows.append(row(f"{kind}, {name}", options.old, pairs))
    numpy = statistics.median(probed(NUMPY, Path())[0] for _ in range(count))
    rows.append(
        {"case": "import numpy", "ours_s": numpy, "peer": "", "peer_s": None, "ratio": None}
    )
    if options.json:
        print(json.dumps({"rows": rows}, indent=1))
    else:
        print_table(rows)


def probed(probe: str, folder: Path, *options: str) -> list[float]:
    """Return the seconds that a probe prints in a Python of its own."""
    command = [sys.executable, *options, "-c", probe]
    env = {key: value for key, value in os.environ.items() if key != "PYTHONDONTWRITEBYTECODE"}
    done = subprocess.run(command, cwd=folder, env=env, check=True, stdout=PIPE, text=True)
    return [float(word) for word in done.stdout.split()]


def row(case: str, peer: str, pairs: list[list[float]]) -> dict[str, object]:
    """Return the medians of pairs: our seconds, the peer's."""
    return {
        "case": case,
        "ours_s": statistics.median(ours for ours, _ in pairs),
        "peer": peer,
        "peer_s": statistics.median(theirs for _, theirs in pairs),
        "ratio": statistics.median(theirs / ours for ours, theirs in pairs),
    }


def print_table(rows: list[dict[str, Any]]) -> None:
    print(f"{'case':<52} {'new':>11} {'old':>11}  ratio")
    for one in rows:
        peer = f"{text(one['peer_s']):>11} {one['ratio']:>6.2f}" if one["peer"] else ""
        print(f"{one['case']:<52} {text(one['ours_s']):>11} {peer}")
    print("ratio = time of the old version / time of the new one")


def text(seconds: float) -> str:
    """Return seconds as milliseconds or microseconds."""
    return f"{seconds * 1e3:.1f} ms" if seconds > 1e-3 else f"{seconds * 1e6:.2f} us"


if __name__ == "__main__":
    main()
