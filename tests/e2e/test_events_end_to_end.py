"""Events on a real ROS 1, without a hand edit: two topics, an event, the evidence of a ConSert."""

import pytest

from tests.e2e.robot import Run
from tests.e2e.workspace import Workspace
from tests.ros1.world import until

pytestmark = [pytest.mark.ros, pytest.mark.slow]
EVENTS, DRIVE = "/motor/events", "/drive/guarantees"
UNKNOWN, TRUE, FALSE = 1, 2, 0


class MotorRun(Run):
    TOPICS = (EVENTS, DRIVE)

    def feed(self, topic, value):
        """Let a value come ten times a second; return the process."""
        command = ("rostopic", "pub", "-r", "10", topic, "std_msgs/Float32", f"data: {value}")
        return self._start(*command)

    def verdict(self):
        return [message["verdict"] for message in self.messages(EVENTS)[-1:]]

    def full_speed(self):
        """Return what the last message says of the guarantee that needs the event."""
        return [
            {item["id"]: item["active"] for item in message["guarantees"]}["FullSpeed"]
            for message in self.messages(DRIVE)[-1:]
        ]


@pytest.fixture(scope="module")
def built(generator, folder, home):
    workspace = Workspace(folder / "motor", home)
    example = generator.path / "examples" / "motor-watch"
    configs = (example / "motor_config.yml", example / "drive_config.yml")
    generator.generate(workspace.path, example / "drive.yml", *configs)
    workspace.catkin_make()
    return workspace


def test_from_two_topics_to_the_guarantee(built, roscore, tmp_path):
    with MotorRun(roscore, built.devel_env(), tmp_path / "run") as run:
        until(lambda: run.verdict() == [UNKNOWN], 30.0, "the first word")
        assert run.full_speed() in ([], [False])
        current = run.feed("/motor/current", 6)
        cool = run.feed("/motor/temperature", 55)
        until(lambda: run.verdict() == [TRUE], 30.0, "the event")
        until(lambda: run.full_speed() == [True], 10.0, "the guarantee")
        cool.end()
        hot = run.feed("/motor/temperature", 95)
        until(lambda: run.verdict() == [FALSE], 30.0, "the end of the event")
        until(lambda: run.full_speed() == [False], 10.0, "the end of the guarantee")
        hot.end()
        cool = run.feed("/motor/temperature", 55)
        until(lambda: run.full_speed() == [True], 30.0, "the guarantee again")
        current.end()  # silence is no evidence
        until(lambda: run.verdict() == [UNKNOWN], 10.0, "the silence")
        until(lambda: run.full_speed() == [False], 10.0, "the guarantee without the event")
        messages = run.messages(EVENTS)
        said = run.launch_text()
        assert "died" not in said, said
        assert "Traceback" not in said, said
    assert {message["id"] for message in messages} == {"MotorFit"}
    assert {tuple(sorted(set(message) - {"header"})) for message in messages} == {
        ("accepted", "active", "cleared", "id", "raised", "verdict")
    }
    assert sum(message["raised"] for message in messages) == 2
    assert all(message["active"] == (message["verdict"] == TRUE) for message in messages)
