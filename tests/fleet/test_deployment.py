"""The example with two robots, from its deployment file to real nodes on one ROS 1 master."""

import shutil

import pytest

from tests.cli.command import ROOT, run
from tests.fleet.worlds import BOOL, Ros1Robots
from tests.ros1.world import PYTHON, demand, why_no_ros

pytestmark = [pytest.mark.slow, pytest.mark.ros]

SENSORS = ("/arm/joints/at_rest", "/arm/joints/braked")


class Cell(Ros1Robots):
    """An arm, a cart and a control station, each of a workspace of its own."""

    def begin(self):
        shutil.copytree(ROOT / "examples" / "two-robots", self.folder / "two-robots")
        deployment = self.folder / "two-robots" / "deployment.yml"
        done = run("generate", deployment, "-o", self.folder / "cell", cwd=self.folder)
        assert done.status == 0, done.err
        self.ear, self.source, self.joints = (self.new_probe() for _ in range(3))
        self.ear.subscribe("/diagnostics", "diagnostic_msgs/DiagnosticArray")
        for robot in ("cart", "station"):
            self.ear.subscribe(f"/{robot}/guarantees")
        self.feed(self.source, "/cart/scanner/free", BOOL, True, connected=False)

    def start(self, robot):
        """Start the node of a robot in its namespace, as its launch file does."""
        package = self.folder / "cell" / robot / "src" / "eddi_monitor" / robot
        env = self.env(self.core)
        env["PYTHONPATH"] = f"{package / 'src'}:{env['PYTHONPATH']}"
        return self.process([PYTHON, str(package / "scripts/RosNode.py"), f"__ns:=/{robot}"], env)

    def park(self, *sensors):
        """Have some sensors of the arm say that it is parked, and the others nothing."""
        for topic in SENSORS:
            if topic in sensors:
                self.feed(self.joints, topic, BOOL, True, connected=False)
            else:
                self.joints.do("stop", topic=topic)

    def shows(self, *, parked):
        """Wait until cart and station know whether the arm is parked."""
        drive, told = (["Drive"], ["arm_Parked", "cart_Drive"]) if parked else ([], [])
        self.until("Wait", *drive, name="/cart", timeout=20.0)
        self.until("cart_Wait", *told, name="/station", timeout=20.0)


@pytest.fixture(scope="module")
def cell(tmp_path_factory):
    demand(why_no_ros())
    made = Cell(tmp_path_factory.mktemp("cell"))
    try:
        made.begin()
        for robot in ("cart", "station", "arm"):
            made.start(robot)
        made.park(*SENSORS)
        made.shows(parked=True)
        yield made
    finally:
        made.destroy()


def test_the_cart_stops_while_a_sensor_of_the_arm_is_silent(cell):
    cell.park(SENSORS[0])
    cell.shows(parked=False)
    cell.park(*SENSORS)
    cell.shows(parked=True)
