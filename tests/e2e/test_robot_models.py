"""From the models of a real robot to a built workspace: parse-rossystem, one input, generate."""

import subprocess

import pytest

from tests.e2e.workspace import Workspace
from tests.shared_data import shared

pytestmark = [pytest.mark.ros, pytest.mark.slow]
CONSERT = """guarantees:
  - id: Drives
    dimensions:
      - Binary: {type: Drives}
demands: []
evidence:
  - id: Forward
    dimension:
      Numeric: {type: Speed, covered: [Inclusive: {start: 0, end: 1}], subset: Demand, uom: m/s}
gates: []
tree_propagations:
  - {from: Forward, to: Drives}
required_services: []
provided_services: []
"""
CONFIG = """Model:
  id: Base
  type: ConSert
EDDIInputs:
  - id: Forward
    requires: [odometry_controller_odometry]
    field: twist.twist.linear.x
    max_age: 0.5
EDDIOutputs:
  - id: base
    topic: /base/guarantees
"""


def test_a_real_system_becomes_a_workspace_that_builds(generator, folder, home):
    models = shared("mros/expected/cob4_ros_tool_test.models")
    system = models / "cob4_ros_tool_test.rossystem"
    config, model = folder / "eddi_config.yml", folder / "Base.yml"
    generator.run("parse-rossystem", "-s", system, "-m", models, "-c", config)
    entries = config.read_text()
    assert entries.count("topic: ") == 41
    config.write_text(entries + CONFIG)
    model.write_text(CONSERT)
    generator.run("check", model, config, system, "--models", models)
    workspace = Workspace(folder / "rover", home)
    generator.generate(workspace.path, model, config)
    text = workspace.eddi_input("base").read_text()
    assert "self.Forward = odometry_controller_odometry.twist.twist.linear.x" in text
    assert (
        "<exec_depend>nav_msgs</exec_depend>"
        in (workspace.packages / "base" / "package.xml").read_text()
    )
    output = workspace.catkin_make()
    assert "CMake Warning" not in output, output
    subprocess.run(
        ["/usr/bin/python3", "-c", "import eddi_runtime, base.EDDIInput, base.EDDIMonitor"],
        env=workspace.devel_env(),
        check=True,
    )
