"""A ``byte`` as rclpy delivers it, in a package for ROS 2: by field, expression and map."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path

import pytest

from tests.cli.command import ROOT, run

pytestmark = pytest.mark.slow

FIELD = ROOT / "tests" / "data" / "oracles" / "field" / "byte-field-ros2"
BY_FIELD = "type: int, requires: [diag], field: level"
BY_EXPRESSION = 'type: int, expression: "diag.level"'
NETWORK = """\
network pump { }
variable Level { type discrete [ 2 ] { good, bad }; }
variable Fault { type discrete [ 2 ] { no, yes }; }
probability ( Level ) { table 0.5, 0.5; }
probability ( Fault | Level ) { (good) 1.0, 0.0; (bad) 0.0, 1.0; }
"""
MAPPED = """\
Model:
  id: pump
  type: Bayesian Network
  discretisation:
    Level: {input: level, map: {0: good, 2: bad}}
  outputs: [Fault]
SimulatorOutputs: [{id: diag, type: diagnostic_msgs.DiagnosticStatus, topic: /pump/status}]
EDDIInputs: [{id: level, type: int, requires: [diag], field: level, max_age: 0.5}]
EDDIOutputs: [{id: out, topic: pump/network}]
"""
TRY = """
import json
from types import SimpleNamespace
from pump.EDDIInput import EDDIInput
from pump.EDDIMonitor import EDDIMonitor
for level in (0, 2, bytes([0]), bytes([2])):
    monitor, inputs = EDDIMonitor(), EDDIInput()
    inputs.processing({"diag": SimpleNamespace(level=level)})
    print(json.dumps(monitor.execute_step(inputs), default=repr))
"""


def outputs(folder: Path, model: str) -> list[list[dict[str, object]]]:
    """Return what the monitor says of the levels 0 and 2, as numbers and as bytes."""
    (folder / "ws" / "src").mkdir(parents=True)
    words = ("generate", "--platform", "ros2", "-w", "ws", "-c", "pump.yml", "-m", model)
    done = run(*words, cwd=folder)
    assert done.status == 0, done.err
    source = folder / "ws" / "src" / "eddi_monitor"
    code = f"import sys; sys.path[:0] = {[str(source / 'pump'), str(source / 'eddi_runtime')]}"
    shown = subprocess.run(
        [sys.executable, "-c", code + TRY], check=True, capture_output=True, text=True
    )
    return [json.loads(line) for line in shown.stdout.splitlines()]


@pytest.mark.parametrize("way", [BY_FIELD, BY_EXPRESSION])
def test_events(way: str, tmp_path: Path) -> None:
    (tmp_path / "pump.events").write_bytes((FIELD / "pump.events").read_bytes())
    config = (FIELD / "pump.yml").read_text("utf-8")
    assert BY_FIELD in config
    (tmp_path / "pump.yml").write_text(config.replace(BY_FIELD, way), "utf-8")
    found = outputs(tmp_path, "pump.events")
    assert [one[0]["verdict"] for one in found] == [True, False, True, False]


def test_a_map(tmp_path: Path) -> None:
    (tmp_path / "pump.bif").write_text(NETWORK, "utf-8")
    (tmp_path / "pump.yml").write_text(MAPPED, "utf-8")
    good, bad, *as_bytes = outputs(tmp_path, "pump.bif")
    assert good != bad
    assert as_bytes == [good, bad]
