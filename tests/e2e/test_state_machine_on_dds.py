"""The shuttle over DDS: its state machine and the ConSert behind it, as processes of their own."""

import shutil
import sys

import pytest

pytest.importorskip("cyclonedds", reason="no DDS here")

from tests.checkouts import HERE
from tests.cli.command import edit, run
from tests.contract.stages import environment, free_domain, ros_args
from tests.ros1.world import PROBES, World, active, until

pytestmark = pytest.mark.slow
EXAMPLE = HERE / "examples" / "shuttle"
FAST, SLOW, STOP = {"DriveFast", "Drive", "Stop"}, {"Drive", "Stop"}, {"Stop"}
PATIENCE_S = 20.0


class Shuttle(World):
    def __init__(self, folder, start):
        super().__init__(folder, None)
        example = shutil.copytree(EXAMPLE, folder / "example")
        edit(example / "shuttle_config.yml", "start: initial", f"start: {start}")
        configs = [word for name in ("shuttle", "driving") for word in ("-c", f"{name}_config.yml")]
        place = ("--platform", "dds", "-o", folder, "-m", "driving.yml")
        done = run("generate", *place, *configs, cwd=example)
        assert done.status == 0, done.err
        self.lock, domain = free_domain()
        self.environment = environment(domain, folder)
        probe = [sys.executable, str(PROBES / "dds.py")]
        self.ear, self.source = (self.probe_of(probe, self.environment) for _ in range(2))
        self.ear.subscribe("/shuttle/guarantees")
        self.sending = set()
        self.nodes = {name: self.started(name) for name in ("shuttle", "driving")}

    def started(self, name):
        command = [sys.executable, "-m", name, *ros_args("/", ())]
        return self.process(command, self.environment)

    def send(self, topic, value):
        """Publish a value again and again, in place of the one before."""
        self.silence(topic)
        self.sending.add(topic)
        kind = "std_msgs/Bool" if isinstance(value, bool) else "std_msgs/Float32"
        self.source.do("every", topic=topic, kind=kind, fields={"data": value}, hz=10)

    def silence(self, topic):
        if topic in self.sending:
            self.source.do("stop", topic=topic)
            self.sending.remove(topic)

    def until(self, guarantees):
        self.ear.active("/shuttle/guarantees", guarantees, PATIENCE_S)

    def destroy(self):
        super().destroy()
        self.lock.close()


@pytest.fixture
def shuttle(tmp_path, request):
    made = Shuttle(tmp_path, getattr(request, "param", "initial"))
    made.send("/battery/level", 0.8)
    made.send("/drive/fault", False)
    made.send("/wash/done", False)
    made.send("/lidar/dirt", 0.05)
    yield made
    made.destroy()


def test_a_fail_state_and_silence_take_the_guarantee_away(shuttle):
    shuttle.until(FAST)
    shuttle.send("/lidar/dirt", 0.5)
    shuttle.until(SLOW)
    assert "limit_speed is due" in shuttle.nodes["shuttle"].text
    shuttle.silence("/drive/fault")  # silence: it may have failed
    shuttle.until(STOP)
    shuttle.send("/drive/fault", False)
    shuttle.send("/desk/restarted", True)  # an order makes it certain again
    shuttle.until(SLOW)
    shuttle.nodes["shuttle"].destroy()  # the death of a monitor makes nothing active
    shuttle.until(STOP)


@pytest.mark.parametrize("shuttle", ["unknown"], indirect=True)
def test_a_fault_lasts_and_a_restart_activates_nothing(shuttle):
    shuttle.until(STOP)
    shuttle.send("/desk/restarted", True)  # who starts in any state is told which it is
    shuttle.until(FAST)
    shuttle.silence("/desk/restarted")
    shuttle.send("/drive/fault", True)
    shuttle.until(STOP)
    shuttle.send("/drive/fault", False)  # a fail state stays
    shuttle.nodes["shuttle"].destroy()
    mark = shuttle.ear.mark()
    node = shuttle.nodes["shuttle"] = shuttle.started("shuttle")
    shuttle.send("/lidar/dirt", 0.5)
    until(lambda: "perhaps reduced speed" in node.text, what="it steps, with all inputs")
    outputs = shuttle.ear.outputs("/shuttle/guarantees", mark)
    assert all(active(event) == STOP for event in outputs)
    shuttle.send("/desk/restarted", True)
    shuttle.until(SLOW)
