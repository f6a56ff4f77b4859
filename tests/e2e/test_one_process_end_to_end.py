"""``generate --single-process``, built by catkin and launched: what a person sees is the same."""

import os
import signal

import pytest

from tests.e2e import figure46
from tests.e2e.robot import STARTED, end, sourced
from tests.e2e.workspace import Workspace
from tests.ros1.world import until

pytestmark = [pytest.mark.ros, pytest.mark.slow]
NODE = "eddi_monitor_launcher"


@pytest.fixture(scope="module")
def built(generator, folder, home):
    workspace = Workspace(folder / "one_process", home)
    examples = generator.examples
    configs = [
        word for letter in "ab" for word in ("-c", examples / f"consert_{letter}_config.yml")
    ]
    model = ("-m", examples / "two_conserts.xml")
    generator.run("generate", "-w", workspace.path, *model, *configs, "--single-process")
    workspace.catkin_make("install")
    return workspace


@pytest.mark.parametrize("space", ["devel", "install"])
def test_both_monitors_run_and_come_back(built, launched, home, space):
    with launched(sourced(built.path / space / "setup.bash", home)) as run:
        evidence = figure46.demonstrate(run, steady=False)
        for name in ("/conserta", "/consertb"):
            run.wait_for_input(name, "RtE_A_E0", 10.0)
        assert f"/{NODE}" in run.command("rosnode", "list").split()
        ((_, pid),) = (one for one in STARTED.findall(run.launch_text()) if one[0] == NODE)
        nothing, everything = (figure46.all_of(figure46.SYSTEM_A, active=x) for x in (False, True))
        end(evidence)  # what runs again must not hear it before a person can see that it is missing
        run.wait_for(figure46.SYSTEM_A, nothing, 30.0)
        before = len(run.states(figure46.SYSTEM_A))
        os.kill(int(pid), signal.SIGKILL)
        until(lambda: len(STARTED.findall(run.launch_text())) == 2, 30.0, "the respawn")
        until(lambda: run.states(figure46.SYSTEM_A)[before:], 30.0, "the first word")
        run.wait_for(figure46.SYSTEM_B, figure46.all_of(figure46.SYSTEM_B, active=True), 30.0)
        assert all(state == nothing for state in run.states(figure46.SYSTEM_A)[before:])
        run.publish(figure46.EVIDENCE_A)
        run.wait_for(figure46.SYSTEM_A, everything, 30.0)
        assert "Traceback" not in run.launch_text()
