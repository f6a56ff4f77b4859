"""The fast fixture: a real ROS master and real nodes, without catkin and without a compiler."""

import pytest

from eddi_scaffold.kinds.consert import MESSAGES
from tests.ros1 import models
from tests.ros1.world import World, demand, make_messages, why_no_ros


@pytest.fixture(scope="session")
def ros_here():
    demand(why_no_ros())


@pytest.fixture(scope="session")
def messages(ros_here, tmp_path_factory):
    return make_messages(tmp_path_factory.mktemp("messages"), MESSAGES)


@pytest.fixture(scope="session")
def shared_world(messages, tmp_path_factory):
    """What all tests use together: one master, one probe that hears ``/diagnostics``."""
    world = World(tmp_path_factory.mktemp("shared"), messages)
    yield world
    world.destroy()


@pytest.fixture(scope="session")
def master(shared_world):
    return shared_world.master()


@pytest.fixture(scope="session")
def probe(shared_world, master):
    probe = shared_world.probe(master)
    probe.subscribe("/diagnostics", "diagnostic_msgs/DiagnosticArray")
    return probe


@pytest.fixture
def world(messages, tmp_path):
    world = World(tmp_path, messages)
    yield world
    world.destroy()


@pytest.fixture(scope="session")
def model_files(tmp_path_factory):
    """Model files by package name."""
    folder = tmp_path_factory.mktemp("models")
    for name, model in models.MODELS.items():
        (folder / f"{name}.py").write_text(model.text())
    return {path.stem: path for path in folder.iterdir()}
