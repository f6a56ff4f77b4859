"""The main job on a real ROS 1: from the EDDI to running monitors whose hand edits survive.

Two workspaces, both really built: the example as it ships, in one process on an installed runtime;
and one with the hand edits of D7.2.
"""

import ast
import os
import shutil
import signal
import sys
from concurrent.futures import ThreadPoolExecutor

import pytest

from tests.checkouts import HERE, git, run
from tests.cli.command import EXAMPLE
from tests.e2e import changes, figure46
from tests.e2e.robot import STARTED, Run, clean_env, end
from tests.e2e.workspace import Workspace
from tests.interpreters import old_python
from tests.quick_copier import copier_here
from tests.ros1.world import PYTHON, until

pytestmark = [pytest.mark.ros, pytest.mark.slow]
MONITORS = ("conserta", "consertb")
PACKAGES = (*MONITORS, "eddi_messages", "eddi_monitor", "eddi_monitor_launcher", "eddi_runtime")
EVIDENCE_OF_TWO = {**figure46.EVIDENCE_B, "/rte/e1b": "RtE_A_E1"}
NODE = "eddi_monitor_launcher"
MODEL = EXAMPLE / "two_conserts.xml"
CONFIGS = [EXAMPLE / f"consert_{letter}_config.yml" for letter in "ab"]


@pytest.fixture(scope="module")
def shipped(folder, home):
    """The example as it is, in one process on an installed runtime: no hand edit is needed."""
    workspace = Workspace(folder / "shipped", home, languages=True)
    workspace.generate(MODEL, *CONFIGS, words=("--single-process", "--runtime", "installed"))
    return workspace


@pytest.fixture(scope="module")
def site(shipped):
    """Where pip has installed the runtime."""
    sources, site = shipped.path / "runtime_lib", shipped.path / "site"
    shutil.copytree(HERE / "runtime_lib", sources, ignore=shutil.ignore_patterns("__pycache__"))
    pip = [sys.executable, "-m", "pip", "install", "--quiet", "--no-deps", "--no-build-isolation"]
    run([*pip, "--target", str(site), str(sources)], shipped.path)
    return site


@pytest.fixture(scope="module")
def joined(clone, folder, home):
    """The two steps of D7.2 4.2.5: the workspace, what was there before system B, and after."""
    workspace = Workspace(folder / "edited", home)
    contents = []
    for config, change in zip(CONFIGS, (changes.config_of_d72, changes.of_each_robot), strict=True):
        (folder / config.name).write_text(change(config.read_text()))
        clone.eddi("generate", "-w", workspace.path, "-m", MODEL, "-c", folder / config.name)
        contents.append(workspace.contents())
    return workspace, *contents


@pytest.fixture(scope="module")
def edited(joined):
    """The workspace with the hand edits, in git."""
    workspace = joined[0]
    changes.write_by_hand(*map(workspace.eddi_input, MONITORS))
    git(workspace.path, "init", "--quiet")
    git(workspace.path, "add", "--all")
    git(workspace.path, "commit", "--quiet", "--message", "Generated, with hand edits")
    return workspace


@pytest.fixture(scope="module")
def built(shipped, edited):
    """What both builders said, side by side on two cores: catkin build, catkin_make."""
    with ThreadPoolExecutor() as pool:
        builds = [pool.submit(shipped.catkin_build), pool.submit(edited.catkin_make)]
        return [build.result() for build in builds]


@pytest.fixture(scope="module")
def updated(clone, edited, built, folder):
    """Model and template have changed, `copier update` has run, all is built, tested, installed."""
    model, config = folder / MODEL.name, folder / CONFIGS[1].name
    model.write_text(changes.second_model(MODEL.read_text()))
    config.write_text(changes.second_config(CONFIGS[1].read_text()))
    clone.eddi("answers", "-m", model, "-c", config, "-o", folder / "answers.yml")
    changes.release_second_version(clone)
    words = ("update", "--trust", "--defaults")
    assert copier_here(*words, "conserta", cwd=edited.packages).returncode == 0
    git(edited.path, "commit", "--quiet", "--all", "--message", "Update system A")
    data = ("--data-file", folder / "answers.yml")
    assert copier_here(*words, *data, "consertb", cwd=edited.packages).returncode == 0
    no_rostest = "-DCMAKE_DISABLE_FIND_PACKAGE_rostest=TRUE"
    return edited, edited.catkin_make(no_rostest, "run_tests", "install")


def check_launched(running):
    """Check what a person looks at beside the guarantees."""
    assert set(running.command("rosnode", "list").split()) >= {"/conserta", "/consertb", "/rosout"}
    assert set(running.command("rostopic", "list").split()) >= {
        *figure46.GUARANTEES, "/conserta/guarantees/status", "/consertb/guarantees/status",
        "/diagnostics", "/rte/e0a", "/rte/e0b",
    }  # fmt: skip
    said = running.launch_text()
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


def test_what_was_generated_pleases_the_tools_of_ros(shipped, built):
    """No manifest has a warning, no package one of catkin_lint, each launch file one."""
    clean = clean_env(shipped.home)
    run(["catkin_lint", "--strict", str(shipped.packages)], shipped.path, clean)
    program = (
        "import sys\nfrom catkin_pkg.package import parse_package\n"
        "from roslaunch.rlutil import check_roslaunch  # which roslaunch-check calls\n"
        "for path in sys.argv[1:]:\n    found = []\n"
        "    if path.endswith('launch'):\n        found.append(check_roslaunch(path))\n"
        "    else:\n        parse_package(path, warnings=found)\n"
        "    print(path, found)"
    )
    launch = sorted(map(str, shipped.packages.glob("*/launch/*.launch")))
    manifests = sorted(map(str, shipped.packages.glob("*/package.xml")))
    assert len(manifests) == len(PACKAGES) - 1  # no runtime
    said = run(
        [PYTHON, "-c", program, *launch, *manifests], shipped.path, shipped.devel_env()
    ).stdout
    expected = [*(f"{path} [None]" for path in launch), *(f"{path} []" for path in manifests)]
    assert said.splitlines() == expected


@pytest.mark.parametrize("find", [lambda: PYTHON, old_python], ids=["system", "3.8"])
def test_the_generated_tests_pass(shipped, site, find):
    for name in MONITORS:
        tests = [find(), "-m", "unittest", "discover", "-s", "test"]
        run(tests, shipped.packages / name, {"PYTHONPATH": str(site)})


def test_the_example_runs_without_a_hand_edit_and_says_what_is_missing_and_comes_back(
    shipped, site, built, launched
):
    env = shipped.devel_env()
    with launched(env, "without") as running:
        said = 'run `python3 -m pip install --upgrade "eddi-runtime>='
        until(lambda: said in running.launch_text(), 60.0, "what to run")
    with launched({**env, "PYTHONPATH": f"{env['PYTHONPATH']}:{site}"}) as running:
        until(lambda: running.diagnosis("/consertb"), 30.0, "the first diagnosis")
        assert running.diagnosis("/consertb")["RtE_A_E0"] == "waiting"
        said = running.diagnosis("/consertb")["guarantee.System_A_G0_c2"]
        assert said.startswith("inactive: System_A_G0_c2 <- RtE_A_E0 <- /rte/e0b: no message yet")
        # The example ends a guarantee after half a second of silence: a busy machine may pass that.
        evidence = figure46.demonstrate(running, steady=False)
        for name in ("/conserta", "/consertb"):
            running.wait_for_input(name, "RtE_A_E0", 10.0)
        assert f"/{NODE}" in running.command("rosnode", "list").split()
        ((_, pid),) = (one for one in STARTED.findall(running.launch_text()) if one[0] == NODE)
        nothing, everything = (figure46.all_of(figure46.SYSTEM_A, active=x) for x in (False, True))
        end(evidence)  # what runs again must not hear it before a person can see that it is missing
        running.wait_for(figure46.SYSTEM_A, nothing, 30.0)
        before = len(running.states(figure46.SYSTEM_A))
        os.kill(int(pid), signal.SIGKILL)
        until(lambda: len(STARTED.findall(running.launch_text())) == 2, 30.0, "the respawn")
        until(lambda: running.states(figure46.SYSTEM_A)[before:], 30.0, "the first word")
        running.wait_for(figure46.SYSTEM_B, figure46.all_of(figure46.SYSTEM_B, active=True), 30.0)
        assert all(state == nothing for state in running.states(figure46.SYSTEM_A)[before:])
        running.publish(figure46.EVIDENCE_A)
        running.wait_for(figure46.SYSTEM_A, everything, 30.0)
        assert "Traceback" not in running.launch_text()


NONE, ALL, OWN = (
    {"System_A_G0": own, "System_A_G1": other}
    for own, other in ((False, False), (True, True), (True, False))
)


class RobotRun(Run):
    """The monitors of one robot, in its namespace."""

    def __init__(self, robot, *parts):
        self.robot = robot
        self.out = f"/{robot}/conserta/guarantees"
        self.TOPICS = (self.out, f"/{robot}/consertb/guarantees")
        self.LAUNCH = ("robot.launch", f"ns:={robot}")
        super().__init__(*parts)

    def feed(self):
        """Start the sensors of this robot; return the one of ConSertB."""
        self.publish(f"/{self.robot}/rte/e0a")
        return self.publish(f"/{self.robot}/rte/e0b")

    def until(self, state, patience=30.0):
        self.wait_for(self.out, state, patience)


def test_two_robots_do_not_hear_each_other(edited, built, roscore, tmp_path):
    """On one master, with the hand edits: topics between monitors are relative, and the sensors."""
    env = edited.devel_env()
    with (
        RobotRun("robot1", roscore, env, tmp_path / "one") as one,
        RobotRun("robot2", roscore, env, tmp_path / "two") as two,
    ):
        one.until(NONE, 60.0)
        two.until(NONE, 60.0)
        sensor = one.feed()
        one.until(ALL)
        assert all(state == NONE for state in two.states(two.out)), (
            "robot 1's sensors count for both"
        )
        two.feed()
        two.until(ALL)
        seen = len(two.states(two.out))
        end(sensor)  # robot 1 loses what ConSertB rests on
        one.until(OWN)
        assert changes.SEEN_AT_RUN_TIME in one.launch_text()
        end(one.launch)  # and then all its monitors
        until(lambda: len(two.states(two.out)) > seen + 20, 30.0, "two seconds of robot 2")
        assert all(state == ALL for state in two.states(two.out)[seen:])


def test_copier_update_keeps_the_hand_edits(updated):
    workspace, said = updated
    changes.check_written(*map(workspace.eddi_input, MONITORS))
    for name in MONITORS:
        package = workspace.packages / name
        assert "second version" in workspace.eddi_input(name).read_text()
        assert "second version" in (package / "scripts" / "RosNode.py").read_text()
        assert "second version" in (package / "CMakeLists.txt").read_text()
        assert not [path for path in package.rglob("*.py") if "<<<<<<<" in path.read_text()]
        assert not list(package.rglob("*.rej"))
        assert not (package / ".eddi/kept").exists()
        untested = "is NOT TESTED: install rostest (Debian: librostest-dev), then build again"
        assert f"{name} {untested}" in said
    assert "def process_RtE_A_E1" in workspace.eddi_input("consertb").read_text()
    assert "RtE_A_E1" not in workspace.eddi_input("conserta").read_text()


def test_an_install_space_that_was_moved_runs_alone(updated, launched, folder):
    workspace = updated[0]
    env = workspace.move_install(folder / "robot")
    with launched(env) as running:
        figure46.demonstrate(running, EVIDENCE_OF_TWO)
        check_launched(running)
        assert changes.SEEN_AT_RUN_TIME in running.launch_text()
        assert str(workspace.path) not in running.launch_text()
    program = (
        "from types import SimpleNamespace\n"
        "from consertb.EDDIMonitor import EDDIMonitor\n"
        "print(EDDIMonitor().execute_step(SimpleNamespace(RtE_A_E0=True, RtE_A_E1=True)))"
    )
    alone = run([PYTHON, "-c", program], folder, env).stdout
    assert ast.literal_eval(alone) == [{"id": "System_A_G0_c2", "active": True}]
