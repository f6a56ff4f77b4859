"""One stage for each transport, on which all scenarios run one after the other."""

import os

import pytest

from tests.contract.stages import STAGES


@pytest.fixture(scope="module", params=[pytest.param("ros1", marks=pytest.mark.ros), "dds", "ros2"])
def stage(request, tmp_path_factory):
    make, why_not = STAGES[request.param]
    reason = why_not()
    had = request.param != "ros2"  # Debian, on which all must run, has no rclpy
    if reason is not None and had and os.environ.get("EDDI_REQUIRE_ROS") == "1":
        pytest.fail(reason)
    if reason is not None:
        pytest.skip(reason)
    made = make(tmp_path_factory.mktemp(request.param))
    made.begin()
    made.robot = made.start()
    yield made
    made.destroy()
