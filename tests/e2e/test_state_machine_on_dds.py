"""The shuttle over DDS: its state machine and the ConSert behind it, as processes of their own."""

import sys

import pytest

pytest.importorskip("cyclonedds", reason="no DDS here")

from tests.checkouts import HERE
from tests.cli.command import run
from tests.contract.stages import environment, free_domain, ros_args
from tests.ros1.world import PROBES, World

pytestmark = pytest.mark.slow
EXAMPLE = HERE / "examples" / "shuttle"
FAST, SLOW, STOP = {"DriveFast", "Drive", "Stop"}, {"Drive", "Stop"}, {"Stop"}
PATIENCE_S = 20.0


class Shuttle(World):
    def __init__(self, folder):
        super().__init__(folder, None)
        configs = [word for name in ("shuttle", "driving") for word in ("-c", f"{name}_config.yml")]
        place = ("--platform", "dds", "-o", folder, "-m", "driving.yml")
        done = run("generate", *place, *configs, cwd=EXAMPLE)
        assert done.status == 0, done.err
        self.lock, domain = free_domain()
        self.environment = environment(domain, folder)
        probe = [sys.executable, str(PROBES / "dds.py")]
        self.ear, self.source = (self.probe_of(probe, self.environment) for _ in range(2))
        self.ear.subscribe("/shuttle/guarantees")
        self.nodes = {name: self.started(name) for name in ("shuttle", "driving")}

    def started(self, name):
        command = [sys.executable, "-m", name, *ros_args("/", ())]
        return self.process(command, self.environment)

    def send(self, topic, value):
        kind = "std_msgs/Bool" if isinstance(value, bool) else "std_msgs/Float32"
        self.source.do("every", topic=topic, kind=kind, fields={"data": value}, hz=10)

    def until(self, guarantees):
        self.ear.active("/shuttle/guarantees", guarantees, PATIENCE_S)

    def destroy(self):
        super().destroy()
        self.lock.close()


@pytest.fixture
def shuttle(tmp_path):
    made = Shuttle(tmp_path)
    yield made
    made.destroy()


def test_a_fail_state_and_silence_take_the_guarantee_away(shuttle):
    shuttle.send("/lidar/dirt", 0.05)
    shuttle.send("/battery/level", 0.8)
    shuttle.send("/drive/fault", False)
    shuttle.send("/wash/done", False)
    shuttle.until(FAST)
    shuttle.source.do("stop", topic="/lidar/dirt")
    shuttle.send("/lidar/dirt", 0.5)
    shuttle.until(SLOW)
    assert "limit_speed is due" in shuttle.nodes["shuttle"].text
    shuttle.source.do("stop", topic="/drive/fault")  # silence: it may have failed
    shuttle.until(STOP)
    shuttle.send("/drive/fault", False)
    shuttle.send("/desk/restarted", True)  # an order makes it certain again
    shuttle.until(SLOW)
    shuttle.nodes["shuttle"].destroy()  # the death of a monitor makes nothing active
    shuttle.until(STOP)
