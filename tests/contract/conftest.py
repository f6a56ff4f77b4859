"""One stage for each transport, on which all scenarios run one after the other."""

import pytest

from tests.contract.stages import STAGES
from tests.ros1.world import demand
from tests.ros2.world import RELEASE, shared


@pytest.fixture(
    scope="module",
    params=[pytest.param(one, marks=pytest.mark.ros) for one in ("ros1", "ros2")] + ["dds"],
)
def stage(request, tmp_path_factory):
    make, why_not = STAGES[request.param]
    if request.param == "ros2":
        RELEASE.demand()
    demand(why_not())
    more = {"below": shared(tmp_path_factory)} if request.param == "ros2" else {}
    made = make(tmp_path_factory.mktemp(request.param), **more)
    made.begin()
    made.robot = made.start("/", "startup_grace:=2.0")
    yield made
    made.destroy()
