"""Evidence from expressions on a real ROS 1: no hand-written line, and it fails safe."""

import pytest

from tests.e2e.robot import Run
from tests.e2e.workspace import Workspace

pytestmark = [pytest.mark.ros, pytest.mark.slow]
GUARANTEES = "/rover/guarantees"
PATIENCE_S = 30.0


class RoverRun(Run):
    TOPICS = (GUARANTEES, "/diagnostics")

    def send(self, topic, of, data, rate=20):
        """Leave ``rostopic pub`` repeating a message; return the process."""
        return self._start("rostopic", "pub", "-r", str(rate), topic, of, data)


@pytest.fixture(scope="module")
def workspace(generator, folder, home):
    example = generator.path / "examples" / "rover-events"
    made = Workspace(folder / "events", home)
    generator.generate(made.path, example / "Rover.yml", example / "eddi_config.yml")
    made.catkin_make()
    return made


def test_battery_and_motor_become_evidence(workspace, roscore, tmp_path):
    text = workspace.eddi_input("rover").read_text()
    assert text.count("self.expression(") == 2
    with RoverRun(roscore, workspace.devel_env(), tmp_path / "run") as run:
        run.wait_for(GUARANTEES, {"MayDrive": False}, PATIENCE_S)
        run.send("/battery", "sensor_msgs/BatteryState", "{present: true, percentage: 0.8}")
        motor = run.send("/motor/temperature", "std_msgs/Float32", "data: 40.0")
        run.wait_for(GUARANTEES, {"MayDrive": True}, PATIENCE_S)
        motor.destroy()
        run.wait_for(GUARANTEES, {"MayDrive": False}, PATIENCE_S)  # nobody knows how hot it is
        motor = run.send("/motor/temperature", "std_msgs/Float32", "data: 40.0")
        run.wait_for(GUARANTEES, {"MayDrive": True}, PATIENCE_S)
        # Not at the other's rate: the monitor takes the last message of a step, and of two that
        # keep in step it could be the same one for ever.
        hot = run.send("/motor/temperature", "std_msgs/Float32", "data: 90.0", rate=97)
        run.wait_for(GUARANTEES, {"MayDrive": False}, PATIENCE_S)
        hot.destroy()
        run.wait_for(GUARANTEES, {"MayDrive": True}, PATIENCE_S)  # two seconds without heat
        assert "Traceback" not in run.launch_text(), run.launch_text()
