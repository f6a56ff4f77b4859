"""Two versions of eddi-scaffold beside each other: each generates the examples by itself."""

from __future__ import annotations

import argparse
import os
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
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
"""Kind of a monitor -> example, model and configuration."""


def parser(description: str | None) -> argparse.ArgumentParser:
    """Return the options that a benchmark of two versions has."""
    options = argparse.ArgumentParser(
        description=description, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    options.add_argument("--quick", action="store_true", help="fewer and shorter runs")
    options.add_argument("--json", action="store_true")
    options.add_argument("--old", default=BEFORE, metavar="COMMIT", help="the other version")
    return options


@dataclass(frozen=True)
class Version:
    """A checkout, and what it generates.

    Attributes:
        path: the checkout.
        scratch: where it generates.
    """

    path: Path
    scratch: Path

    def workspace(self, kind: str) -> Path:
        """Generate the monitor of a kind for ROS 1; return the folder of all its packages."""
        folder = self.scratch / kind / "workspace"
        (folder / "src").mkdir(parents=True)
        self._generate(kind, "-w", folder)
        return folder / "src" / "eddi_monitor"

    def plain(self, kind: str) -> Path:
        """Generate the monitor of a kind as a plain package; return the package."""
        folder = self.scratch / kind / "plain"
        folder.mkdir(parents=True)
        self._generate(kind, "--platform", "plain", "-o", folder)
        return next(folder.glob("*/EDDIMonitor.py")).parent

    def _generate(self, kind: str, *words: object) -> None:
        example, model, config = EXAMPLES[kind]
        files = self.path / "examples" / example
        given = [*words, "-m", files / model, "-c", files / config]
        command = [sys.executable, "-m", "eddi_scaffold", "-q", "generate", *map(str, given)]
        runtime = self.path / "runtime_lib" / "src"
        environment = {**os.environ, "PYTHONPATH": f"{self.path}:{runtime}"}
        subprocess.run(
            command, check=True, cwd=self.path, env=environment, stdout=subprocess.DEVNULL
        )


@contextmanager
def versions(old: str) -> Iterator[tuple[Version, Version]]:
    """Yield the version that is committed here, and an older one."""
    with tempfile.TemporaryDirectory() as scratch:
        place = Path(scratch)
        yield (
            Version(_checkout("HEAD", place / "new"), place / "by-new"),
            Version(_checkout(old, place / "old"), place / "by-old"),
        )


def _checkout(commit: str, folder: Path) -> Path:
    subprocess.run(["git", "clone", "--quiet", "--shared", str(ROOT), str(folder)], check=True)
    subprocess.run(["git", "-C", str(folder), "checkout", "--quiet", commit], check=True)
    return folder
