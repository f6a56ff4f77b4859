"""Size and speed of what runs on the robot, beside that of an earlier version, in one run.

For one monitor of each kind: lines and files of the runtime library in a ROS 1 workspace, and of a
plain package the time from the first import to the first step, the time of a step with the inputs
at their defaults, and the resident memory, all of these above bare Python. Each version generates
the packages itself.

    python benchmarks/runtime_size.py [--quick] [--json] [--old COMMIT]
"""

from __future__ import annotations

import argparse
import json
import os
import statistics
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
BEFORE = "9439789"
"""The last version whose models were compiled when a monitor started."""

EXAMPLES = {
    "ConSert": ("two-conserts", "two_conserts.xml", "consert_a_config.yml"),
    "ConSert with an expression": ("rover-events", "Rover.yml", "eddi_config.yml"),
    "events": ("motor-watch", "motor_watch.events", "motor_config.yml"),
    "Bayesian network": ("pedestrian", "pedestrian.xml", "eddi_config.yml"),
    "SafeML": ("safeml", "safeml_config.yml", "perception_config.yml"),
    "reliability": ("drone", "drone.xml", "reliability_config.yml"),
}

PROBE = """
import time
def resident():
    with open("/proc/self/statm") as pages:
        return int(pages.read().split()[1]) * 4
before = resident(), time.perf_counter()
from {package}.EDDIInput import EDDIInput
from {package}.EDDIMonitor import EDDIMonitor
monitor, values = EDDIMonitor(), EDDIInput()
monitor.execute_step(values)
started = time.perf_counter() - before[1]
memory = resident() - before[0]
count, took = 1, 0.0
while took < {seconds}:
    count *= 2
    begin = time.perf_counter()
    for _ in range(count):
        monitor.execute_step(values)
    took = time.perf_counter() - begin
print(started, took / count, memory)
"""


@dataclass(frozen=True)
class Version:
    """A checkout, and what it generates.

    Attributes:
        name: for the table.
        path: the checkout.
        scratch: where it generates.
    """

    name: str
    path: Path
    scratch: Path

    def eddi(self, *words: object) -> None:
        """Run its command line."""
        command = [sys.executable, "-m", "eddi_scaffold", *map(str, words)]
        runtime = self.path / "runtime_lib" / "src"
        environment = {**os.environ, "PYTHONPATH": f"{self.path}:{runtime}"}
        subprocess.run(command, check=True, cwd=self.path, env=environment, capture_output=True)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--quick", action="store_true", help="fewer and shorter runs")
    parser.add_argument("--json", action="store_true")
    parser.add_argument("--old", default=BEFORE, metavar="COMMIT", help="the other version")
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as scratch:
        versions = [
            Version("old", archived(options.old, Path(scratch, "old")), Path(scratch, "by-old")),
            Version("new", archived("HEAD", Path(scratch, "new")), Path(scratch, "by-new")),
        ]
        rows = list(measured(versions, quick=options.quick))
    if options.json:
        print(json.dumps({"rows": rows}, indent=1))
    else:
        print_table(rows)


def archived(commit: str, folder: Path) -> Path:
    """Return a checkout of a commit of this repository."""
    subprocess.run(["git", "clone", "--quiet", "--shared", str(ROOT), str(folder)], check=True)
    subprocess.run(["git", "-C", str(folder), "checkout", "--quiet", commit], check=True)
    return folder


def measured(versions: list[Version], *, quick: bool) -> Iterator[dict[str, object]]:
    """Yield a row for each kind and version; the versions take turns."""
    for kind, (example, model, config) in EXAMPLES.items():
        names = {}
        for version in versions:
            folder = version.path / "examples" / example
            place = version.scratch / example
            (place / "ws" / "src").mkdir(parents=True)
            files = ["-m", folder / model, "-c", folder / config]
            version.eddi("generate", "-w", place / "ws", *files)
            version.eddi("generate", "--platform", "plain", "-o", place / "plain", *files)
            names[version.name] = next(
                path.parent.name for path in (place / "plain").glob("*/EDDIMonitor.py")
            )
        runs: dict[str, list[list[float]]] = {version.name: [] for version in versions}
        for _ in range(3 if quick else 15):
            for version in versions:
                probe = PROBE.format(package=names[version.name], seconds=0.02 if quick else 0.1)
                runs[version.name].append(probed(probe, version.scratch / example / "plain"))
        for version in versions:
            packages = version.scratch / example / "ws" / "src" / "eddi_monitor"
            texts = [path.read_text() for path in packages.glob("eddi_runtime/src/**/*.py")]
            start, step, memory = (
                statistics.median(one) for one in zip(*runs[version.name], strict=True)
            )
            yield {
                "kind": kind,
                "version": version.name,
                "lines": sum(text.count("\n") for text in texts),
                "files": len(texts),
                "all_files": sum(path.is_file() for path in packages.rglob("*")),
                "start_ms": start * 1e3,
                "step_us": step * 1e6,
                "memory_mb": memory / 1024,
            }


def probed(probe: str, folder: Path) -> list[float]:
    """Run a probe in a Python of its own, which has compiled the files before."""
    command = [sys.executable, "-c", probe]
    done = subprocess.run(command, cwd=folder, check=True, capture_output=True, text=True)
    return [float(word) for word in done.stdout.split()]


def print_table(rows: list[dict[str, object]]) -> None:
    print(
        "| kind | version | runtime, lines | files | files in the workspace "
        "| start, ms | step, us | memory, MB |"
    )
    print("|---|---|--:|--:|--:|--:|--:|--:|")
    for row in rows:
        print(
            f"| {row['kind']} | {row['version']} | {row['lines']:,} | {row['files']} "
            f"| {row['all_files']} | {row['start_ms']:.1f} | {row['step_us']:.2f} "
            f"| {row['memory_mb']:.1f} |"
        )


if __name__ == "__main__":
    main()
