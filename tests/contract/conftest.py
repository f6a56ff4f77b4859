"""One stage for each transport, on which all scenarios run one after the other."""

import os

import pytest

from tests.contract.stages import STAGES
from tests.ros2.world import REQUIRED, shared


@pytest.fixture(
    scope="module",
    params=[pytest.param(one, marks=pytest.mark.ros) for one in ("ros1", "ros2")] + ["dds"],
)
def stage(request, tmp_path_factory):
    make, why_not = STAGES[request.param]
    reason = why_not()
    required = REQUIRED if request.param == "ros2" else os.environ.get("EDDI_REQUIRE_ROS") == "1"
    if reason is not None and required:
        pytest.fail(reason)
    if reason is not None:
        pytest.skip(reason)
    more = {"below": shared(tmp_path_factory)} if request.param == "ros2" else {}
    made = make(tmp_path_factory.mktemp(request.param), **more)
    made.begin()
    made.robot = made.start("/", "startup_grace:=2.0")
    yield made
    made.destroy()
