"""The pedestrian example on a real ROS 1: speed and distance in, the risk out."""

import subprocess

import pytest

from tests.e2e.robot import Run
from tests.e2e.workspace import Workspace
from tests.ros1.world import until

pytestmark = [pytest.mark.ros, pytest.mark.slow]
RISK = "/pedestrian/risk"
PATIENCE_S = 30.0


class NetworkRun(Run):
    TOPICS = (RISK, f"{RISK}/status")

    def send(self, topic, value):
        """Leave ``rostopic pub`` repeating a number, faster than it grows too old."""
        self._start("rostopic", "pub", "-r", "20", topic, "std_msgs/Float64", f"data: {value}")

    def risks(self):
        """Return the probability of Critical=Yes in each message."""
        return [
            message["output_nodes"][0]["outcomes"][0]["outcome_value"]
            for message in self.messages(RISK)
        ]

    def wait_for_risk(self, value):
        def came():
            assert self.launch.popen.poll() is None, self.launch_text()
            last = self.risks()[-1:]
            return bool(last) and abs(last[0] - value) < 1e-6

        until(came, PATIENCE_S, f"a risk of {value}")


@pytest.fixture(scope="module")
def workspace(generator, folder, home):
    example = generator.path / "examples" / "pedestrian"
    made = Workspace(folder / "pedestrian", home)
    generator.generate(made.path, example / "pedestrian.xml", example / "eddi_config.yml")
    output = made.catkin_make()
    assert "CMake Warning" not in output, output
    return made


def test_speed_and_distance_become_a_risk(workspace, roscore, tmp_path):
    with NetworkRun(roscore, workspace.devel_env(), tmp_path / "run") as run:
        run.wait_for_risk(0.3385)  # nothing is observed: the prior
        run.send("/vehicle/speed", 4 / 3.6)
        run.wait_for_risk(0.36)
        run.send("/pedestrian/distance", 0.4)
        run.wait_for_risk(0.7)
        run.processes[-1].destroy()
        run.wait_for_risk(0.36)  # the last distance is too old
        run.send("/pedestrian/distance", 5.3)
        run.wait_for_risk(0.2)
        message = run.messages(RISK)[-1]
        assert [node["title"] for node in message["output_nodes"]] == ["Critical"]
        assert [one["outcome_name"] for one in message["output_nodes"][0]["outcomes"]] == [
            "Yes",
            "No",
        ]
        states = [one["status"] for one in run.messages(f"{RISK}/status")]
        assert states[0] == 2  # PRIOR
        assert {1, 0} <= set(states)  # PARTIAL, then OK
        said = run.launch_text()
        assert "Traceback" not in said, said


def test_the_package_of_the_network_passes_its_own_test(workspace):
    subprocess.run(
        ["/usr/bin/python3", "-m", "unittest", "discover", "-s", "test"],
        cwd=workspace.packages / "pedestrian_prediction_example",
        env=workspace.devel_env(),
        check=True,
    )
