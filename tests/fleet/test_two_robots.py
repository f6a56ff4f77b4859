"""A guarantee that rests on another robot falls with that one, and comes back with it."""

import signal
import time

import pytest

from tests.contract.stages import why_no_dds
from tests.fleet.worlds import DdsRobots, Ros1Robots, why_no_namespaces
from tests.ros1.world import demand, until, why_no_ros

pytestmark = pytest.mark.slow


@pytest.fixture(scope="module", params=[pytest.param("ros1", marks=pytest.mark.ros), "dds"])
def robots(request, tmp_path_factory):
    ros1 = request.param == "ros1"
    if ros1:
        demand(why_no_ros())
    elif reason := why_no_dds() or why_no_namespaces():
        pytest.skip(reason)
    made = (Ros1Robots if ros1 else DdsRobots)(tmp_path_factory.mktemp(request.param))
    try:
        made.begin()
        made.cart = made.start("cart", "cart")
        made.arm = made.start("arm", "arm1")
        made.braked()
        made.entered(yes=True)
        yield made
    finally:
        made.destroy()


def test_it_falls_with_the_sensor_of_the_other_robot(robots):
    robots.silent()
    robots.entered(yes=False)
    robots.braked()
    robots.entered(yes=True)
    robots.silent()
    robots.braked(False)
    robots.entered(yes=False)
    robots.silent()
    robots.braked()
    robots.entered(yes=True)


def test_it_falls_with_the_other_robot_and_comes_back(robots):
    started = time.monotonic()
    robots.arm.send(signal.SIGKILL)
    robots.entered(yes=False)
    assert time.monotonic() - started < 5.0
    robots.why("robot arm1 silent ")
    robots.arm = robots.start("arm", "arm1")
    robots.entered(yes=True)


def test_another_robot_takes_over(robots):
    other = robots.start("arm", "arm2")
    robots.braked(robot="arm2")
    time.sleep(2.0)
    robots.arm.send(signal.SIGKILL)
    time.sleep(2.0)
    robots.entered(yes=True)
    other.send(signal.SIGKILL)
    robots.entered(yes=False)
    robots.arm = robots.start("arm", "arm1")
    robots.entered(yes=True)
    robots.silent("arm2")


def test_two_robots_of_one_name_are_not_trusted(robots):
    if isinstance(robots, Ros1Robots):
        pytest.skip("a ROS 1 master ends the first of two nodes with one name")
    twin = robots.start("arm", "arm1")
    robots.entered(yes=False)
    robots.why("two nodes call themselves arm1")
    twin.send(signal.SIGKILL)
    robots.entered(yes=True)


def test_it_falls_when_the_network_is_cut(robots):
    if isinstance(robots, Ros1Robots):
        pytest.skip("two robots on one master have one network")
    for seconds in (0.0, 6.0):  # the second is longer than the lease of DDS
        robots.cut()
        robots.entered(yes=False)
        time.sleep(seconds)
        robots.join()
        robots.entered(yes=True, timeout=40.0)
    until(lambda: robots.arm.popen.poll() is None, what="the arm runs on")
