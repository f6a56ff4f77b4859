"""The fast fixture: a real ROS master and real nodes, without catkin and without a compiler."""

import pytest

from eddi_scaffold.kinds.consert import MESSAGES
from runtime_lib.tests.conserts import consert
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


def reads(topic, max_age=None):
    return {"requires": [topic], "max_age": max_age}


def tester(max_age):
    """Return the tester's model with an age limit of the input F."""
    specs = {"E": reads("how"), "F": reads("flag", max_age)}
    edges = ["E>G_E", "F>G_F"]
    return consert(["E", "F"], guarantees=["G_E", "G_F"], edges=edges, specs=specs, name="Tester")


@pytest.fixture(scope="session")
def model_files(tmp_path_factory):
    """Models of the tester by name; `wide` has outputs of 60 kB."""
    ids = [f"G{number}_{'x' * 1000}" for number in range(60)]
    edges = [f"F>{name}" for name in ids]
    wide = consert(["F"], guarantees=ids, edges=edges, specs={"F": reads("flag")}, name="Wide")
    folder = tmp_path_factory.mktemp("models")
    models = {"wide": wide, "tester": tester(None), "tester_half": tester(0.5)}
    for name, model in models.items():
        (folder / f"{name}.py").write_text(model.text())
    return {path.stem: path for path in folder.iterdir()}
