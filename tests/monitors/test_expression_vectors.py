"""Test vectors of inputs that an expression computes: they pass, and tell a changed package."""

from pathlib import Path
from typing import Any

import pytest
from eddi_runtime.testing import failures

from eddi_scaffold.evidence.expressions import expression_rows
from eddi_scaffold.evidence.vectors import vectors_file
from eddi_scaffold.monitors.binding import BoundMonitor
from eddi_scaffold.packages.assembly import monitors_of
from tests.checkouts import HERE
from tests.data_files import tabled
from tests.evidence.mutants import input_class
from tests.monitors.test_expressions import config, joined, sound

OTHERS = """\
Model: {{id: power, type: Reliability, model: power.yml, frequency: 10}}
SimulatorOutputs:
  - {{id: battery, type: std_msgs/Float32, topic: /battery}}
  - {{id: drives, type: std_msgs/Int32, topic: /drives}}
EDDIInputs:
  - {{id: battery_level, expression: "{level}", max_age: 2 s}}
  - {{id: drives_available, expression: "{drives}", max_age: 2 s}}
"""


def failures_of(
    monitor: BoundMonitor, folder: Path, before: str = "", after: str = ""
) -> list[str]:
    """Return what the vectors of the expressions see of a package, perhaps a changed one."""
    about: Any = expression_rows(monitor.bound)
    assert all(runs for _, _, runs in about["expressions"])
    file = folder / "vectors.json"
    file.write_text(vectors_file(about, monitor.bound, {}, complete=True), encoding="utf-8")
    text = monitor.compiled.text
    assert before in text, text
    scope: dict[str, Any] = {"__name__": "compiled", "__file__": "no file"}
    exec(text.replace(before, after, 1), scope)
    class_ = scope["Monitor"]
    return failures(str(file), class_, input_class(class_))


@tabled
def test_expressions_pass_and_changes_are_seen(
    battery: str, motor: str, changes: dict[str, str], tmp_path: Path
) -> None:
    monitor = sound(joined(config(f"expression: '{battery}'", f"expression: '{motor}'")))
    assert failures_of(monitor, tmp_path) == []
    for before, after in changes.items():
        assert failures_of(monitor, tmp_path, before, after), before


@pytest.mark.parametrize(
    ("level", "drives", "before", "after"),
    [
        ("AVERAGE(battery.data, 1 s)", "drives.data * 0.5", " * 0.5", " * 0.501"),
        ("battery.data + 1", "MAX(drives.data, 1 s)", "Maximum(", "Minimum("),
    ],
)
def test_numbers_are_compared(
    level: str, drives: str, before: str, after: str, tmp_path: Path
) -> None:
    file = tmp_path / "c.yml"
    file.write_text(OTHERS.format(level=level, drives=drives), encoding="utf-8")
    (monitor,), _ = monitors_of(HERE / "examples" / "warehouse-robot" / "power.yml", [file])
    assert failures_of(monitor, tmp_path) == []
    assert failures_of(monitor, tmp_path, before, after)
