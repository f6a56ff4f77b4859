"""The pedestrian example on a real ROS 1: speed and distance in, the risk and evidence out."""

import subprocess

import pytest

from tests.e2e.robot import Run
from tests.e2e.workspace import Workspace
from tests.ros1.world import until

pytestmark = [pytest.mark.ros, pytest.mark.slow]
RISK = "/pedestrian/risk"
LOW = f"{RISK}/low"
PATIENCE_S = 30.0
EVIDENCE = f'{{id: RiskIsLow, node: Critical, state: "Yes", at_most: 0.35, topic: {LOW}}}'


class NetworkRun(Run):
    TOPICS = (RISK, f"{RISK}/status", f"{RISK}/evidence", LOW)

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

    def wait_for_low(self, *, active):
        """Wait until the evidence and its own topic say the same."""

        def came():
            rows = [one["evidence"][0]["active"] for one in self.messages(f"{RISK}/evidence")[-1:]]
            return rows == [active] == [one["data"] for one in self.messages(LOW)[-1:]]

        until(came, PATIENCE_S, f"evidence {active}")


@pytest.fixture(scope="module")
def workspace(generator, folder, home):
    example = generator.path / "examples" / "pedestrian"
    made = Workspace(folder / "pedestrian", home)
    config = folder / "eddi_config.yml"
    text = (example / "eddi_config.yml").read_text()
    config.write_text(text.replace("Simulator", f"  evidence: [{EVIDENCE}]\nSimulator", 1))
    generator.generate(made.path, example / "pedestrian.xml", config)
    output = made.catkin_make()
    assert "CMake Warning" not in output, output
    return made


def test_speed_and_distance_become_a_risk(workspace, roscore, tmp_path):
    with NetworkRun(roscore, workspace.devel_env(), tmp_path / "run") as run:
        run.wait_for_risk(0.3385)  # nothing is observed: the prior
        run.send("/vehicle/speed", 4 / 3.6)
        speed = run.processes[-1]
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
        run.wait_for_low(active=True)
        run.processes[-1].destroy()
        run.wait_for_low(active=False)  # 0.36 is what the prior says of the distance
        speed.destroy()
        run.wait_for_risk(0.3385)  # below the limit, because both sensors died
        last = run.messages(f"{RISK}/evidence")[-1]
        assert last["unknown_inputs"] == ["vehicleSpeed", "pedestrianDistance"]
        (low,) = last["evidence"]
        assert (low["id"], low["active"], low["reason"]) == ("RiskIsLow", False, "unknown inputs")
        assert (low["low"], low["high"]) == (0.05, 0.95)
        assert run.messages(LOW)[-1] == {"data": False}
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
