"""What a package takes out of messages, and publishes, passes the shapes of the answers."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.cli.command import run

pytestmark = pytest.mark.slow

MODEL = """\
guarantees: [{id: Go, dimensions: [{Binary: {type: T}}]}]
demands: []
evidence:
  - {id: P, dimension: {Numeric: {type: P, covered: [{Inclusive: {start: 0, end: 1}}],
     subset: Demand, uom: rad}}}
  - {id: Q, dimension: {Numeric: {type: Q, covered: [{Inclusive: {start: 0, end: 1}}],
     subset: Demand, uom: ""}}}
gates: [{id: A, function: And}]
tree_propagations: [{from: P, to: A}, {from: Q, to: A}, {from: A, to: Go}]
required_services: []
provided_services: []
"""
CONFIG = """\
Model: {id: robo, type: ConSert}
SimulatorOutputs:
  - {id: js, type: sensor_msgs.JointState, topic: js}
  - {id: dg, type: diagnostic_msgs.DiagnosticArray, topic: dg}
EDDIInputs:
  - {id: P, type: float, requires: [js], field: 'position[arm]', max_age: 1}
  - {id: Q, type: float, requires: [dg], field: 'status["/Power: battery"].level', max_age: 1}
EDDIOutputs: [{id: o, topic: robo/out}, {id: p, topic: robo/go, field: 'guarantees[Go].active'}]
"""


def test_elements_by_name_and_by_key(tmp_path: Path) -> None:
    (tmp_path / "robo.yml").write_text(MODEL, "utf-8")
    (tmp_path / "config.yml").write_text(CONFIG, "utf-8")
    (tmp_path / "ws" / "src").mkdir(parents=True)
    done = run("generate", "-w", "ws", "-m", "robo.yml", "-c", "config.yml", cwd=tmp_path)
    assert done.status == 0, done.err
    package = tmp_path / "ws" / "src" / "eddi_monitor" / "robo" / "src" / "robo"
    text = (package / "EDDIInput.py").read_text("utf-8")
    assert "self.P = by_name(js.position, js.name, 'arm')" in text
    assert "self.Q = by_key(dg.status, 'name', '/Power: battery').level" in text
