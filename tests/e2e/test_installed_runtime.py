"""Monitors of a workspace without a copy of the runtime: the wheel is on Python's path."""

import os
import shutil
import subprocess
import sys

import pytest

from tests.checkouts import HERE
from tests.e2e import figure46
from tests.e2e.workspace import Workspace
from tests.ros1.world import until

pytestmark = [pytest.mark.ros, pytest.mark.slow]


@pytest.fixture(scope="module")
def site(folder):
    """Return a folder with the distribution `eddi-runtime`, installed from its wheel."""
    sources = folder / "runtime_lib"
    shutil.copytree(HERE / "runtime_lib", sources, ignore=shutil.ignore_patterns("__pycache__"))
    pip = [sys.executable, "-m", "pip", "install", "--quiet", "--no-deps", "--no-compile"]
    subprocess.run([*pip, "--target", str(folder / "site"), str(sources)], check=True)
    return folder / "site"


@pytest.fixture(scope="module")
def built(generator, folder, home):
    """Return a workspace that was generated and built without the runtime."""
    workspace = Workspace(folder / "installed", home)
    examples = generator.examples
    configs = [("-c", examples / f"consert_{letter}_config.yml") for letter in "ab"]
    model = ("-m", examples / "two_conserts.xml", *configs[0], *configs[1])
    generator.run("generate", "-w", workspace.path, *model, "--runtime", "installed")
    assert not (workspace.packages / "eddi_runtime").exists()
    workspace.catkin_build()
    return workspace


def test_the_monitors_run_on_it(built, site, launched):
    env = built.devel_env()
    path = os.pathsep.join([env["PYTHONPATH"], str(site)])
    with launched({**env, "PYTHONPATH": path}) as run:
        until(lambda: run.diagnosis("/consertb"), 30.0, "the first diagnosis")
        figure46.demonstrate(run, steady=False)
        assert "Traceback" not in run.launch_text()


def test_without_it_the_log_says_what_to_run(built, launched):
    with launched(built.devel_env()) as run:
        said = 'run `python3 -m pip install --upgrade "eddi-runtime>='
        until(lambda: run.launch_text().count(said) >= 2, 60.0, "both nodes say what to run")
