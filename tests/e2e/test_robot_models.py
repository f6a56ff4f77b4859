"""From the models of a real robot to a running monitor: connect, its TODO lines, generate."""

import pytest

from tests.connect.test_robots import consert, decided
from tests.data_files import data_file
from tests.e2e.robot import Run
from tests.e2e.workspace import Workspace

pytestmark = [pytest.mark.ros, pytest.mark.slow]
GUARANTEES = "/base/guarantees"
INPUTS = {"RightLaserStandby": None, "LeftLaserStandby": None, "DistanceAhead": "m"}
SCAN = "{range_max: 30.0, angle_increment: 0.1, angle_max: 0.2, ranges: [1.0, 1.5, 9.0]}"


class BaseRun(Run):
    TOPICS = (GUARANTEES,)

    def scan(self):
        """Let a scan come ten times a second; return the process."""
        command = ("rostopic", "pub", "-r", "10", "/base_laser_front/scan")
        return self._start(*command, "sensor_msgs/LaserScan", SCAN)


@pytest.fixture(scope="module")
def built(generator, folder, home):
    models = data_file("mros/expected/cob4_ros_tool_test.models")
    system = models / "cob4_ros_tool_test.rossystem"
    config, model = folder / "eddi_config.yml", folder / "Base.yml"
    model.write_text(consert(INPUTS))
    robot = ("--system", system, "--models", models)
    generator.run("connect", model, *robot, "-o", config)
    text, count = decided(
        config.read_text(), {"DistanceAhead": "MIN(base_laser_front_scan.ranges[*])"}
    )
    assert (text.count("topic: /"), count) == (41, 4)
    config.write_text(text)
    workspace = Workspace(folder / "cob4", home)
    generator.generate(workspace.path, model, config)
    output = workspace.catkin_make()
    assert "CMake Warning" not in output, output
    return workspace


def test_a_real_system_becomes_a_monitor_that_runs(built, roscore, tmp_path):
    with BaseRun(roscore, built.devel_env(), tmp_path / "run") as run:
        run.wait_for(GUARANTEES, {"Fine": False}, 30.0)
        for side in ("left", "right"):
            run.publish(f"/base_laser_{side}/scan_standby")
        scan = run.scan()
        run.wait_for(GUARANTEES, {"Fine": True}, 30.0)
        scan.end()
        run.wait_for(GUARANTEES, {"Fine": False}, 10.0)
