"""A generated workspace of ROS 2, built and tested by colcon with what Debian has of it."""

import os
import shutil
import subprocess
from pathlib import Path
from xml.etree import ElementTree as ET

import pytest

from tests.cli.command import EXAMPLE, run
from tests.e2e.robot import clean_env, sourced
from tests.e2e.underlay import write_underlay

pytestmark = [pytest.mark.slow, pytest.mark.ros]

NEEDED = ("colcon_ros", "ament_package", "rosidl_cmake", "rosidl_generator_cpp")
NOT_TESTED = "rclpy is missing, it comes with ROS 2: the node is not tested"


@pytest.fixture(scope="module")
def workspace(tmp_path_factory):
    """Return a built workspace with both monitors of the example."""
    places = [Path("/usr/lib/python3/dist-packages"), Path("/usr/share")]
    missing = [one for one in NEEDED if not any((place / one).exists() for place in places)]
    reason = f"no colcon with ament and rosidl here: {', '.join(missing)} missing"
    if missing and os.environ.get("EDDI_REQUIRE_ROS") == "1":
        pytest.fail(reason)
    if missing:
        pytest.skip(reason)
    place = tmp_path_factory.mktemp("colcon")
    write_underlay(place / "src" / "underlay")
    configs = [word for letter in "ab" for word in ("-c", EXAMPLE / f"consert_{letter}_config.yml")]
    model = ("-m", EXAMPLE / "two_conserts.xml", *configs)
    done = run("generate", "--platform", "ros2", "-w", place, *model, cwd=place)
    assert done.status == 0, done.err
    before = contents(place)
    colcon(place, "build", "--cmake-args", "-DCMAKE_CXX_FLAGS=-O0", "-DCMAKE_C_FLAGS=-O0")
    assert contents(place) == before, "a build writes nothing into the sources"
    return place


def contents(place):
    return {path: path.read_bytes() for path in (place / "src").rglob("*") if path.is_file()}


def colcon(place, *words):
    done = subprocess.run(
        ["colcon", *words],
        cwd=place,
        env=clean_env(place),
        check=False,
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
    )
    assert done.returncode == 0, done.stdout
    return done.stdout


def test_everything_is_installed(workspace):
    installed = workspace / "install"
    for name in ("conserta", "consertb"):
        share = installed / name / "share" / name
        found = {str(path.relative_to(share)) for path in share.rglob("*") if path.is_file()}
        assert {
            "config/model.json",
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
    environment = sourced(workspace / "install" / "setup.bash", workspace)
    environment["PYTHONDONTWRITEBYTECODE"] = "1"
    if shutil.which("ros2", path=environment["PATH"]):
        pytest.skip("ROS 2 is here")
    node = workspace / "install/consertb/lib/consertb/ros_node"
    done = subprocess.run([node], env=environment, capture_output=True, text=True, check=False)
    assert done.returncode == 1
    assert done.stderr.startswith("consertb: error: No module named 'rclpy': source the setup.bash")
    assert done.stderr.count("\n") == 1


def test_colcon_test_runs_the_tests_of_monitors(workspace):
    said = colcon(workspace, "test", "--packages-select", "consertb", "eddi_runtime")
    assert "failed" not in said
    suite = ET.parse(workspace / "build" / "consertb" / "pytest.xml").getroot()
    cases = {case.get("name"): case for case in suite.iter("testcase")}
    assert "test_unknown_inputs_are_all_alike" in cases
    assert suite.find("testsuite").get("failures") == suite.find("testsuite").get("errors") == "0"
    skipped = [one.text for one in suite.iter("skipped")]
    if "test_publishes_at_once_and_ends_with_status_0" not in cases:
        assert [NOT_TESTED in one for one in skipped] == [True]
