"""The pedestrian example on a real ROS 1: speed and distance in, the risk and evidence out.

A ConSert rests on that evidence: its guarantee goes away when the sensors of the network die.
"""

import subprocess
import time

import pytest

from tests.e2e.robot import Run
from tests.e2e.workspace import Workspace
from tests.ros1.world import until

pytestmark = [pytest.mark.ros, pytest.mark.slow]
RISK = "/pedestrian/risk"
LOW = f"{RISK}/low"
PATIENCE_S = 30.0
NETWORK, CONSERT = "/pedestrian_prediction_example", "/crossing"
GUARANTEES = "/crossing/guarantees"
PERIOD_S = 0.1
MAX_AGE_S = 0.5
SLACK_S = 0.5  # transport and a machine that others use as well
EVIDENCE = f'{{id: RiskIsLow, node: Critical, state: "Yes", at_most: 0.35, topic: {LOW}}}'
CROSSING = """\
guarantees: [{id: Cross, dimensions: [{Binary: {type: SafeCrossing}}]}]
demands: []
evidence: [{id: RiskIsLow, dimension: {Binary: {type: LowRisk}}}]
gates: []
tree_propagations: [{from: RiskIsLow, to: Cross}]
required_services: []
provided_services: []
"""
CONFIG = """\
Model: {id: Crossing, type: ConSert, parameters: [{model: crossing.yml}]}
SimulatorOutputs:
  - {id: risk, type: eddi_messages.BayesianNetworkEvidence, topic: pedestrian/risk/evidence}
EDDIInputs:
  - {id: RiskIsLow, type: bool, requires: [risk], field: "evidence[RiskIsLow].active"}
EDDIOutputs:
  - {id: crossing, topic: crossing/guarantees}
"""


class NetworkRun(Run):
    TOPICS = (
        RISK, f"{RISK}/status", f"{RISK}/evidence", LOW,
        GUARANTEES, f"{GUARANTEES}/status", "/diagnostics",
    )  # fmt: skip

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

    def verdicts(self):
        """Return (time of the step, verdict) in each status of the ConSert."""
        return [
            (_seconds(one["header"]["stamp"]), one["guarantees"][0]["verdict"])
            for one in self.messages(f"{GUARANTEES}/status")
        ]


def _seconds(stamp):
    return stamp["secs"] + stamp["nsecs"] / 1e9


@pytest.fixture(scope="module")
def workspace(generator, folder, home):
    example = generator.path / "examples" / "pedestrian"
    made = Workspace(folder / "pedestrian", home)
    config = folder / "eddi_config.yml"
    text = (example / "eddi_config.yml").read_text()
    config.write_text(text.replace("Simulator", f"  evidence: [{EVIDENCE}]\nSimulator", 1))
    (folder / "crossing.yml").write_text(CROSSING)
    crossing = folder / "crossing_config.yml"
    crossing.write_text(CONFIG)
    generator.generate(made.path, example / "pedestrian.xml", config, crossing)
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
        sensors_die_under_the_guarantee(run)
        states = [one["status"] for one in run.messages(f"{RISK}/status")]
        assert states[0] == 2  # PRIOR
        assert {1, 0} <= set(states)  # PARTIAL, then OK
        said = run.launch_text()
        assert "Traceback" not in said, said


def sensors_die_under_the_guarantee(run):
    """Kill both sensors while a guarantee rests on them: it ends in time, and they are named."""
    for topic, value in (("/vehicle/speed", 4 / 3.6), ("/pedestrian/distance", 5.3)):
        run.send(topic, value)
    run.wait_for(GUARANTEES, {"Cross": True}, PATIENCE_S)
    for sensor in run.processes[-2:]:
        sensor.popen.kill()
    dead = time.time()
    run.wait_for(GUARANTEES, {"Cross": False}, PATIENCE_S)

    def named():
        said = run.diagnosis(NETWORK)
        return said.get("threshold.RiskIsLow", "").count(" is late, ") == 2 and said

    said = until(named, PATIENCE_S, "a diagnosis")
    why = said["threshold.RiskIsLow"]
    assert why.startswith("inactive: vehicleSpeed: /vehicle/speed is late, "), why
    assert "; pedestrianDistance: /pedestrian/distance is late, " in why
    assert (said["vehicleSpeed"], said["pedestrianDistance"]) == ("stale", "stale")
    # the last status that is TRUE is of a step before the limit, and a period of each monitor
    last = max(at for at, verdict in run.verdicts() if verdict == 2)
    assert last - dead <= MAX_AGE_S + 2 * PERIOD_S + SLACK_S

    def blamed():
        text = run.diagnosis(CONSERT).get("guarantee.Cross")
        return text == "inactive: RiskIsLow: unknown there"

    until(blamed, PATIENCE_S, "a diagnosis of the guarantee")


def test_the_package_of_the_network_passes_its_own_test(workspace):
    subprocess.run(
        ["/usr/bin/python3", "-m", "unittest", "discover", "-s", "test"],
        cwd=workspace.packages / "pedestrian_prediction_example",
        env=workspace.devel_env(),
        check=True,
    )
