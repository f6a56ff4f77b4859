"""The main job on a real ROS 1: from the EDDI to running monitors whose hand edits survive."""

import ast
import contextlib
import os
import subprocess
from pathlib import Path

import pytest

from tests.e2e import edits, figure46
from tests.e2e.robot import clean_env
from tests.e2e.workspace import MONITORS, PACKAGES
from tests.ros1.world import PYTHON, until

pytestmark = [pytest.mark.ros, pytest.mark.slow]
EVIDENCE_OF_TWO = {**figure46.EVIDENCE_B, "/rte/e1b": "RtE_A_E1"}


def python38():
    """Return an interpreter of Python 3.8, or skip."""
    pyenv = Path(os.environ.get("PYENV_ROOT", Path.home() / ".pyenv"))
    for command in ("python3.8", *map(str, pyenv.glob("versions/3.8*/bin/python"))):
        with contextlib.suppress(OSError, subprocess.CalledProcessError):
            subprocess.run([command, "-c", "pass"], check=True, capture_output=True)
            return command
    return pytest.skip("no Python 3.8 here")


def check_launched(run):
    """Check what a person looks at beside the guarantees."""
    assert set(run.command("rosnode", "list").split()) >= {"/conserta", "/consertb", "/rosout"}
    assert set(run.command("rostopic", "list").split()) >= {
        *figure46.GUARANTEES, "/conserta/guarantees/status", "/consertb/guarantees/status",
        "/diagnostics", "/rte/e0a", "/rte/e0b",
    }  # fmt: skip
    said = run.launch_text()
    assert "died" not in said, said
    assert "Traceback" not in said, said


def test_the_first_monitor_creates_all_and_the_second_joins(joined):
    _, before, after = joined
    assert set(before) == {*PACKAGES} - {"consertb"}
    assert set(after) == {*PACKAGES}
    changed = {name for name in before if before[name] != after[name]}
    assert changed == {"eddi_monitor", "eddi_monitor_launcher"}


def test_both_builders_build_every_package_without_a_word(shipped, edited, built):
    for workspace, output in zip((shipped, edited), built, strict=True):
        assert "CMake Warning" not in output, output
        assert "CMake Error" not in output, output
        for name in MONITORS:
            assert (workspace.path / "devel" / "lib" / name / "RosNode.py").exists()


def test_the_example_runs_without_a_hand_edit(shipped, built, launched):
    with launched(shipped.devel_env()) as run:
        until(lambda: run.diagnosis("/consertb"), 30.0, "the first diagnosis")
        assert run.diagnosis("/consertb")["RtE_A_E0"] == "waiting"
        assert run.diagnosis("/consertb")["RtE_A_E0.blocks"] == "System_A_G0_c2"
        # The example ends a guarantee after half a second of silence: a busy machine may pass that.
        figure46.demonstrate(run, steady=False)
        check_launched(run)
        for node in ("/conserta", "/consertb"):
            run.wait_for_input(node, "RtE_A_E0", 10.0)


def test_a_monitor_that_says_false_is_found_out(shipped, built, launched):
    """The check itself is checked: a spoilt monitor must not pass."""
    path = shipped.packages / "consertb" / "src" / "consertb" / "EDDIMonitor.py"
    text = path.read_text()
    old = "return self.monitor.execute_step(eddi_input, t_ns)"
    assert old in text
    new = "return [{**row, 'active': False} for row in self.monitor.execute_step(eddi_input, t_ns)]"
    path.write_text(text.replace(old, new))
    try:
        with launched(shipped.devel_env()) as run:
            run.wait_for(figure46.SYSTEM_B, figure46.all_of(figure46.SYSTEM_B, active=False), 30.0)
            with pytest.raises(AssertionError, match=r"/consertb/guarantees: .*_c2': True}; last"):
                figure46.demonstrate(run, patience=4.0)
    finally:
        path.write_text(text)


def test_hand_edits_are_at_work(edited, built, launched):
    with launched(edited.devel_env()) as run:
        figure46.demonstrate(run)
        assert edits.SEEN_AT_RUN_TIME in run.launch_text()


def test_copier_update_keeps_the_hand_edits(updated):
    edits.check_edits(*(updated.eddi_input(name) for name in MONITORS))
    for name in MONITORS:
        package = updated.packages / name
        assert "second version" in updated.eddi_input(name).read_text()
        assert "Second version" in (package / "scripts" / "RosNode.py").read_text()
        assert "second version" in (package / "CMakeLists.txt").read_text()
        assert not [path for path in package.rglob("*.py") if "<<<<<<<" in path.read_text()]
        assert not list(package.rglob("*.rej"))
        assert not (package / ".eddi/kept").exists()
    assert "def process_RtE_A_E1" in updated.eddi_input("consertb").read_text()
    assert "RtE_A_E1" not in updated.eddi_input("conserta").read_text()


def test_the_updated_monitors_run_in_devel_space(updated, launched):
    with launched(updated.devel_env()) as run:
        figure46.demonstrate(run, EVIDENCE_OF_TWO)
        check_launched(run)
        assert edits.SEEN_AT_RUN_TIME in run.launch_text()


def test_an_install_space_that_was_moved_runs_alone(updated, launched, folder):
    env = updated.move_install(folder / "robot")
    with launched(env) as run:
        figure46.demonstrate(run, EVIDENCE_OF_TWO)
        check_launched(run)
        assert edits.SEEN_AT_RUN_TIME in run.launch_text()
        assert str(updated.path) not in run.launch_text()
    program = (
        "from types import SimpleNamespace\n"
        "from consertb.EDDIMonitor import EDDIMonitor\n"
        "print(EDDIMonitor().execute_step(SimpleNamespace(RtE_A_E0=True, RtE_A_E1=True)))"
    )
    alone = _run([PYTHON, "-c", program], env)
    assert ast.literal_eval(alone) == [{"id": "System_A_G0_c2", "active": True}]


def test_the_manifests_have_no_warning(shipped):
    program = (
        "import sys\nfrom catkin_pkg.package import parse_package\n"
        "for path in sys.argv[1:]:\n    found = []\n    parse_package(path, warnings=found)\n"
        "    [print(path, text) for text in found]"
    )
    paths = [str(shipped.packages / name / "package.xml") for name in PACKAGES]
    assert _run([PYTHON, "-c", program, *paths], clean_env(shipped.home)) == ""


def test_catkin_lint_finds_nothing(shipped):
    _run(["catkin_lint", "--strict", str(shipped.packages)], clean_env(shipped.home))


def test_the_launch_files_pass_the_check_of_roslaunch(shipped, built):
    # The function behind roslaunch-check, whose script needs one package more.
    program = (
        "import sys\nfrom roslaunch.rlutil import check_roslaunch\n"
        "[print(path, check_roslaunch(path)) for path in sys.argv[1:]]"
    )
    files = sorted(map(str, shipped.packages.glob("*/launch/*.launch")))
    said = _run([PYTHON, "-c", program, *files], shipped.devel_env())
    assert said.splitlines() == [f"{path} None" for path in files]


def test_generated_python_is_that_of_python_38(shipped):
    for path in shipped.packages.rglob("*.py"):
        ast.parse(path.read_text(), feature_version=(3, 8))


@pytest.mark.parametrize("find", [lambda: PYTHON, python38], ids=["system", "3.8"])
def test_the_generated_tests_pass(shipped, find):
    for name in MONITORS:
        command = [find(), "-m", "unittest", "discover", "-s", "test"]
        _run(command, None, shipped.packages / name)


def _run(command, env, folder=None):
    done = subprocess.run(command, env=env, cwd=folder, check=False, capture_output=True, text=True)
    assert done.returncode == 0, f"{command}\n{done.stdout}\n{done.stderr}"
    return done.stdout
