"""What all workspaces of ROS 1 have in common: a checkout of the generator, a home, a roscore."""

import shutil

import pytest

from tests.checkouts import checkout
from tests.e2e.changes import FIRST
from tests.e2e.robot import CLEAN_PATH, Roscore, Run
from tests.ros1.world import demand, why_no_ros

COMMANDS = ("catkin_make", "catkin", "catkin_lint", "roscore", "roslaunch", "rostopic", "rosnode")


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    missing = [name for name in COMMANDS if shutil.which(name, path=CLEAN_PATH) is None]
    demand(why_no_ros() or (f"not installed: {', '.join(missing)}" if missing else None))
    return tmp_path_factory.mktemp("e2e")


@pytest.fixture(scope="module")
def home(folder):
    (folder / "home").mkdir()
    return folder / "home"


@pytest.fixture(scope="module")
def clone(folder):
    """A released checkout that serves as the program and as the template."""
    return checkout(folder / "eddi-scaffold", FIRST)


@pytest.fixture(scope="module")
def roscore(folder):
    core = Roscore(folder / "ros").start()
    yield core
    core.stop()


@pytest.fixture
def launched(roscore, tmp_path):
    """Return a function that launches the monitors of an environment."""
    return lambda env, name="run": Run(roscore, env, tmp_path / name)
