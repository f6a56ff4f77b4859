"""Two robots on one real ROS master, each in its namespace: neither hears what is of the other.

Topics between monitors are relative; so are those of the sensors here.
"""

import pytest

from tests.e2e.robot import Run, end
from tests.e2e.workspace import Workspace
from tests.ros1.world import until

pytestmark = [pytest.mark.ros, pytest.mark.slow]
NONE = {"System_A_G0": False, "System_A_G1": False}
ALL = {"System_A_G0": True, "System_A_G1": True}
OWN = {"System_A_G0": True, "System_A_G1": False}


def of(robot):
    """Return a class of runs of one robot's monitors."""

    class RobotRun(Run):
        A, B = f"/{robot}/conserta/guarantees", f"/{robot}/consertb/guarantees"
        TOPICS = (A, B)
        LAUNCH = ("robot.launch", f"ns:={robot}")

        def feed(self):
            """Start the sensors of this robot; return the one of ConSertB."""
            self.publish(f"/{robot}/rte/e0a")
            return self.publish(f"/{robot}/rte/e0b")

    return RobotRun


@pytest.fixture(scope="module")
def built(generator, folder, home):
    workspace = Workspace(folder / "robots", home)
    configs = []
    for name in ("consert_a_config.yml", "consert_b_config.yml"):
        text = (generator.examples / name).read_text().replace("topic: /rte", "topic: rte")
        configs.append(folder / name)
        configs[-1].write_text(text)
    generator.generate(workspace.path, generator.examples / "two_conserts.xml", *configs)
    workspace.catkin_make()
    return workspace


def test_two_robots_do_not_hear_each_other(built, roscore, tmp_path):
    env = built.devel_env()
    with (
        of("robot1")(roscore, env, tmp_path / "one") as one,
        of("robot2")(roscore, env, tmp_path / "two") as two,
    ):
        one.wait_for(one.A, NONE, 60.0)
        two.wait_for(two.A, NONE, 60.0)
        sensor = one.feed()
        one.wait_for(one.A, ALL, 30.0)
        assert all(state == NONE for state in two.states(two.A)), "robot 1's sensors count for both"
        two.feed()
        two.wait_for(two.A, ALL, 30.0)
        seen = len(two.states(two.A))
        end(sensor)  # robot 1 loses what ConSertB rests on
        one.wait_for(one.A, OWN, 30.0)
        end(one.launch)  # and then all its monitors
        until(lambda: len(two.states(two.A)) > seen + 20, 30.0, "two seconds of robot 2")
        assert all(state == ALL for state in two.states(two.A)[seen:])
