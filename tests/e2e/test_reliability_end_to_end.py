"""Reliability on a real ROS 1: a rotor fails, P_fail jumps, the ConSert's guarantee goes away."""

import pytest

from tests.e2e.robot import Run, end
from tests.e2e.workspace import Workspace
from tests.ros1.world import until

pytestmark = [pytest.mark.ros, pytest.mark.slow]
RELIABILITY, GUARANTEES = "/drone/reliability", "/drone/guarantees"
FLYING = {"ContinueMission": True, "Land": True}
LANDING = {"ContinueMission": False, "Land": True}


class DroneRun(Run):
    TOPICS = (RELIABILITY, GUARANTEES)

    def say(self, topic, value):
        """Publish a Boolean ten times a second."""
        data = f"data: {str(value).lower()}"
        return self._start("rostopic", "pub", "-r", "10", topic, "std_msgs/Bool", data)

    def last(self):
        return self.messages(RELIABILITY)[-1]


@pytest.fixture(scope="module")
def built(generator, folder, home):
    """The workspace of the example, without a hand edit."""
    workspace = Workspace(folder / "drone", home)
    example = generator.path / "examples" / "drone"
    configs = (example / "reliability_config.yml", example / "mission_config.yml")
    generator.generate(workspace.path, example / "drone.xml", *configs)
    workspace.catkin_make()
    return workspace


def test_from_the_rotor_to_the_guarantee(built, roscore, tmp_path):
    with DroneRun(roscore, built.devel_env(), tmp_path / "run") as run:
        rotors = run.say("/drone/rotors_ok", True)
        link = run.say("/drone/link_lost", False)
        run.wait_for(GUARANTEES, FLYING, 40.0)
        flying = run.last()
        assert (flying["valid"], flying["accepted"]) == (True, [])
        assert flying["evidence"] == [{"id": "RtE_continue", "active": True}]
        assert flying["p_fail"] == pytest.approx(5.155e-6, rel=1e-2)
        assert flying["p_fail_low"] == flying["p_fail_high"] == flying["p_fail"]
        assert flying["horizon_seconds"] == 1800.0

        end(link)  # silence: what is not known is no evidence
        run.wait_for(GUARANTEES, LANDING, 10.0)
        silent = run.last()
        assert (silent["valid"], silent["unknown_inputs"]) == (False, ["MissionLoss_Link"])
        assert silent["p_fail_high"] == 1.0
        run.say("/drone/link_lost", False)
        run.wait_for(GUARANTEES, FLYING, 10.0)

        end(rotors)
        run.say("/drone/rotors_ok", False)
        until(lambda: run.last()["valid"] and run.last()["p_fail"] > 1e-3, 10.0, "the jump")
        run.wait_for(GUARANTEES, LANDING, 10.0)
        fallen = run.last()
        assert fallen["p_fail"] > 1000 * flying["p_fail"]
        assert fallen["evidence"] == [{"id": "RtE_continue", "active": False}]
        assert "Traceback" not in run.launch_text(), run.launch_text()
        assert "died" not in run.launch_text(), run.launch_text()
