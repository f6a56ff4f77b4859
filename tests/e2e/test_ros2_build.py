"""A generated workspace of ROS 2, built and tested by colcon, and run as a person runs it."""

import signal
import subprocess
from xml.etree import ElementTree as ET

import pytest

from tests.contract.stages import free_domain, on_loopback, ros_args
from tests.e2e.robot import clean_env
from tests.ros1.world import PROBES, World
from tests.ros2.world import RELEASE, shared

pytestmark = [pytest.mark.slow, pytest.mark.ros]

BOOL = "std_msgs/Bool"


@pytest.fixture(scope="module")
def workspace(tmp_path_factory):
    """Return a built workspace with both monitors of the example."""
    RELEASE.demand()
    RELEASE.workspace(shared(tmp_path_factory))
    return shared(tmp_path_factory)


def test_everything_is_installed(workspace):
    installed = workspace / "install"
    for name in ("conserta", "consertb"):
        share = installed / name / "share" / name
        found = {str(path.relative_to(share)) for path in share.rglob("*") if path.is_file()}
        assert {
            f"config/ConSert{name[-1].upper()}.yml",
            "config/parameters.yaml",
            "launch/eddi_monitor.launch.py",
            "package.xml",
        } <= found
        assert (installed / name / "lib" / name / "ros_node").is_file()
        marker = f"{name}/share/ament_index/resource_index/packages/{name}"
        assert (installed / marker).is_file()
    assert (installed / "eddi_monitor_launcher/share/eddi_monitor_launcher/launch").is_dir()
    headers = {path.name for path in (installed / "eddi_messages").rglob("*.hpp")}
    assert {"con_sert_output.hpp", "guarantee.hpp"} <= headers


def test_a_node_without_rclpy_says_so_in_one_line(workspace):
    sources = workspace / "src" / "eddi_monitor"
    environment = clean_env(workspace) | {
        "PYTHONPATH": f"{sources / 'consertb'}:{sources / 'eddi_runtime'}",
        "PYTHONDONTWRITEBYTECODE": "1",
    }
    node = ["/usr/bin/python3", "-m", "consertb.RosNode"]
    done = subprocess.run(node, env=environment, capture_output=True, text=True, check=False)
    assert done.returncode == 1
    assert done.stderr.startswith("consertb: error: No module named 'rclpy': source the setup.bash")
    assert done.stderr.count("\n") == 1


def test_colcon_test_runs_the_tests_of_monitors_and_of_the_node(workspace):
    lock, domain = free_domain()
    env = {**RELEASE.sourced(workspace), **on_loopback(domain)}
    said = RELEASE.colcon(workspace, "test", "--packages-select", "consertb", env=env)
    lock.close()
    assert "failed" not in said
    suite = ET.parse(workspace / "build" / "consertb" / "pytest.xml").getroot()
    cases = {case.get("name"): case for case in suite.iter("testcase")}
    wanted = {"test_vectors", "test_publishes_at_once_and_ends_with_status_0"}
    assert wanted <= cases.keys()
    counted = suite.find("testsuite")
    assert [counted.get(one) for one in ("failures", "errors", "skipped")] == ["0", "0", "0"]


class Robots(World):
    """Robots on one graph, each in its namespace, with both monitors of the example."""

    def __init__(self, workspace, folder):
        super().__init__(folder, None)
        self.workspace = workspace
        self.lock, domain = free_domain()
        self.around = {**RELEASE.sourced(workspace), **on_loopback(domain)}
        self.probe = self.probe_of([RELEASE.python, str(PROBES / "ros2.py")], self.around)

    def robot(self, name):
        """Start the monitors of a robot; what they would read of all robots is its own."""
        self.probe.subscribe(f"{name}/conserta/guarantees")
        own = [word for one in "ab" for word in ("-r", f"/rte/e0{one}:={name}/rte/e0{one}")]
        nodes = []
        for package in ("conserta", "consertb"):
            node = self.workspace / "install" / package / "lib" / package / "ros_node"
            command = [str(node), *ros_args(name, ["diagnostics:=false"]), *own]
            nodes.append(self.process(command, self.around))
        return nodes

    def feed(self, *topics):
        for topic in topics:
            self.probe.do("every", topic=topic, kind=BOOL, fields={"data": True}, hz=10)

    def until(self, name, *active):
        self.probe.active(f"{name}/conserta/guarantees", set(active), 20.0)

    def destroy(self):
        super().destroy()
        self.lock.close()


@pytest.fixture
def robots(workspace, tmp_path):
    made = Robots(workspace, tmp_path)
    yield made
    made.destroy()


def test_two_robots_do_not_hear_each_other(robots):
    one, two = robots.robot("/robot1"), robots.robot("/robot2")
    robots.until("/robot1")
    robots.until("/robot2")
    mark = robots.probe.mark()
    robots.feed("/robot1/rte/e0a", "/robot1/rte/e0b")
    robots.until("/robot1", "System_A_G0", "System_A_G1")
    heard = robots.probe.outputs("/robot2/conserta/guarantees", mark)
    assert not [one for one in heard if "active': True" in str(one)], "robot 1 counts for both"
    robots.feed("/robot2/rte/e0a", "/robot2/rte/e0b")
    robots.until("/robot2", "System_A_G0", "System_A_G1")
    robots.probe.do("stop", topic="/robot1/rte/e0b")  # what ConSertB rests on
    robots.until("/robot1", "System_A_G0")
    for node in one:  # and then all its monitors
        assert node.end(signal.SIGTERM)[0] == 0, node.text
    robots.until("/robot2", "System_A_G0", "System_A_G1")
    for node in two:
        assert node.end(signal.SIGINT)[0] == 0, node.text
