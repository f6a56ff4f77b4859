"""SafeML monitors for tests, from configuration and rows to the running monitor."""

from collections.abc import Sequence
from pathlib import Path
from typing import Any

from eddi_runtime import Monitor as RuntimeMonitor

from eddi_scaffold.common.problems import Problem
from eddi_scaffold.monitors.binding import BoundMonitor
from eddi_scaffold.packages.assembly import monitors_of
from eddi_scaffold.recordings.playing import compiled

LONG_NAMES = {
    "ks": "KolmogorovSmirnovDistance",
    "cvm": "CramerVanMisesDistance",
    "ad": "AndersonDarlingDistance",
}
CONNECTED = """
Model: {id: scope, type: SafeML, frequency: 10, parameters: [{config: safeml_config.yml}]}
SimulatorOutputs: [{id: features, type: std_msgs.Float32MultiArray, topic: /features}]
EDDIInputs: [{id: sample, type: "float[]", requires: [features], field: data}]
EDDIOutputs: [{id: safeml, topic: /scope/safeml}]
"""


def lay(folder: Path, rows: Sequence[Sequence[float]], **keys: Any) -> Path:
    text = "\n".join(",".join(map(repr, row)) for row in rows)
    (folder / "reference.csv").write_text(text + "\n")
    config = {"reference_sample_file": "reference.csv", **keys}
    path = folder / "safeml_config.yml"
    path.write_text("".join(f"{key}: {value}\n" for key, value in config.items()))
    return path


def joined(
    folder: Path, rows: Sequence[Sequence[float]], connected: str = "", **keys: Any
) -> tuple[BoundMonitor, list[Problem]]:
    path = lay(folder, rows, **keys)
    if not connected:
        (monitor,), problems = monitors_of(path, [])
        return monitor, problems
    config = folder / "eddi_config.yml"
    config.write_text(connected)
    (monitor,), problems = monitors_of(None, [config])
    return monitor, problems


def running(folder: Path, rows: Sequence[Sequence[float]], **keys: Any) -> RuntimeMonitor:
    return compiled(joined(folder, rows, **keys)[0])
