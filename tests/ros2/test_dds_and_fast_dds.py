"""A monitor of the platform dds on the graph of a robot with rclpy on Fast DDS."""

import pytest

from tests.contract.stages import DdsStage, on_loopback, why_no_dds
from tests.ros1.world import PROBES, demand
from tests.ros2.world import RELEASE, shared

pytestmark = [pytest.mark.slow, pytest.mark.ros]


class Mixed(DdsStage):
    """The monitor uses Cyclone DDS, the robot rclpy."""

    def __init__(self, folder, below):
        super().__init__(folder)
        self._around = {**RELEASE.workspace(below), **on_loopback(self.domain)}

    def new_probe(self):
        return self.probe_of([RELEASE.python, str(PROBES / "ros2.py")], self._around)


def test_messages_with_lists_go_both_ways(tmp_path, tmp_path_factory):
    """Fast DDS describes the type of a list so that Cyclone DDS matched no reader with it."""
    RELEASE.demand()
    demand(why_no_dds())
    stage = Mixed(tmp_path, shared(tmp_path_factory))
    try:
        stage.begin()
        stage.start()
        stage.feed(stage.source, "/in/healthy", "std_msgs/Bool", True)
        stage.until("Slow", timeout=30.0)
        stage.source.do("stop", topic="/in/healthy")
        stage.feed(stage.source, "/in/healthy", "std_msgs/Bool", False)
        stage.until(timeout=30.0)
        stage.told("/in/mode", timeout=30.0)
    finally:
        stage.destroy()
