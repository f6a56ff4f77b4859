"""The platform ros2: packages of ament, with what people write as on ROS 1."""

from __future__ import annotations

import ast
import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest
import yaml

from eddi_scaffold.packages.assembly import monitors_of
from eddi_scaffold.platforms import platforms
from eddi_scaffold.platforms import ros_packages as package_names
from tests.cli.command import EXAMPLE, ROOT, run
from tests.kinds.examples import EXAMPLES

CONTRACT = ROOT / "tests" / "contract"
MODEL = EXAMPLE / "two_conserts.xml"
XML_END, HASH_END = "<!-- Manual edit end | region: ", "# -----Manual edit end-----  # region: "
EDITED = {
    "consertb/consertb/EDDIInput.py": ("RtE_A_E0 = RtE_E0.data", "RtE_A_E0 = RtE_E0.data is True"),
    "consertb/config/parameters.yaml": ("diagnostics: true", "diagnostics: false  # mine"),
    "consertb/launch/eddi_monitor.launch.py": ("respawn_delay=2.0", "respawn_delay=5.0"),
    "consertb/package.xml": (
        f"{XML_END}package.own",
        f"<depend>mine</depend>\n  {XML_END}package.own",
    ),
    "eddi_messages/CMakeLists.txt": (f"{HASH_END}cmake.own", f"# mine\n{HASH_END}cmake.own"),
}
DOCSTRINGS = ("--convention", "google", "--add-ignore", "D101", "D102", "D107", "D300", "D415")
"""Ament's own convention asks for none of the first three; the last two are the markers of D7.2:
texts at the beginning of a method, in single quotes."""
NAMES = ("--exclude", "compiled.py")
"""Its lines are as long as the names in the model."""
LINTERS = {"flake8": NAMES, "pep257": DOCSTRINGS, "lint_cmake": (), "xmllint": ()}


@pytest.fixture(scope="module")
def workspace(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return a workspace with both monitors of the example."""
    place = tmp_path_factory.mktemp("ros2")
    (place / "src").mkdir()
    configs = [word for letter in "ab" for word in ("-c", EXAMPLE / f"consert_{letter}_config.yml")]
    done = run("generate", "--platform", "ros2", "-w", place, "-m", MODEL, *configs, cwd=place)
    assert done.status == 0, done.err
    return place


@pytest.mark.parametrize("kind", EXAMPLES)
def test_what_people_write_is_made_of_the_same_answers_as_on_ros1(kind: str) -> None:
    model, config = (ROOT / "examples" / name for name in EXAMPLES[kind])
    (monitor,), _ = monitors_of(model, [config])
    one, two = (platforms()[name].monitor(monitor)[0].answers for name in ("ros1", "ros2"))
    for name in ("inputs", "modules", "runtime_names", "aliases", "message_imports"):
        assert one[name] == two[name]


@pytest.mark.parametrize("linter", LINTERS)
def test_the_linters_of_ament_find_nothing(workspace: Path, linter: str) -> None:
    program = shutil.which(f"ament_{linter}", path="/usr/bin:/opt/ros/humble/bin")
    if program is None:
        pytest.skip(f"no ament_{linter} here")
    place = workspace / "src" / "eddi_monitor"
    done = subprocess.run(
        [program, ".", *LINTERS[linter]], cwd=place, capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stdout + done.stderr


def test_qos_and_either_spelling_of_a_type() -> None:
    (monitor,), _ = monitors_of(CONTRACT / "rover.yml", [CONTRACT / "rover_config.yml"])
    package, problems = platforms()["ros2"].monitor(monitor)
    assert problems == []
    heard = {one["id"]: one for one in package.answers["subscriptions"]}
    assert heard["'mode'"]["more"] == ", qos={'reliability': 'reliable'}"
    assert heard["'mode'"]["message_class"] == "String"
    assert "from std_msgs.msg import String" in package.answers["message_imports"]
    (published,) = package.answers["publications"]
    assert published["more"].strip() == "qos={'depth': 2, 'lifespan': 5.0},"


def test_the_readme_names_a_test_that_runs_without_ros(workspace: Path) -> None:
    package = workspace / "src/eddi_monitor/consertb"
    named = re.search(r"`python3 (-m unittest [^`]+)`", (package / "README.md").read_text("utf-8"))
    assert named is not None
    assert f"`python3 {named[1]}`" in (package / "test/test_monitor.py").read_text("utf-8")
    subprocess.run([sys.executable, *named[1].split()], cwd=package, check=True)


def test_a_life_cycle_concerns_only_what_starts_the_node(workspace: Path, tmp_path: Path) -> None:
    (tmp_path / "src").mkdir()
    config = tmp_path / "consert_b_config.yml"
    text = (EXAMPLE / config.name).read_text("utf-8")
    config.write_text(text.replace("type: ConSert", "type: ConSert\n  lifecycle: true"), "utf-8")
    words = ("-w", tmp_path, "-m", MODEL, "-c", config)
    done = run("-q", "generate", "--platform", "ros2", *words, cwd=tmp_path)
    assert done.status == 0, done.err
    assert run("check", MODEL, config, cwd=tmp_path).err.startswith("no problems in ")
    without, managed = (
        {
            str(path.relative_to(folder)): path.read_bytes()
            for path in folder.rglob("*")
            if path.is_file() and not {".eddi", "__pycache__"} & {*path.parts}
        }
        for folder in (one / "src/eddi_monitor/consertb" for one in (workspace, tmp_path))
    )
    assert without.keys() == managed.keys()
    changed = {name for name in managed if managed[name] != without[name]}
    launch, node = "launch/eddi_monitor.launch.py", "consertb/RosNode.py"
    test, readme = "test/test_node.py", "README.md"
    assert changed == {".copier-answers.yml", launch, node, test, readme}
    for name in (launch, node, test):
        ast.parse(managed[name], feature_version=(3, 8))
    assert b"import LifecycleNode\n" in managed[launch]
    assert b"'autostart', default_value='true'" in managed[launch]
    assert b"{'autostart': LaunchConfiguration('autostart')}" in managed[launch]
    assert b"import ManagedMonitorNode as MonitorNode" in managed[node]
    assert b"autostart" not in b"".join(without[name] for name in (launch, node, test, readme))
    for place, travels in ((workspace, False), (tmp_path, True)):
        runtime = place / "src/eddi_monitor/eddi_runtime/eddi_runtime"
        for part in ("node/life_cycle.py", "transports/ros2/lifecycle.py"):
            assert (runtime / part).is_file() is travels, part


@pytest.mark.parametrize(
    ("platform", "name", "refused"),
    [
        ("ros1", "nsecs", ""),
        ("ros2", "nanosec", ""),
        ("dds", "nanosec", ""),
        ("ros1", "nanosec", "time has no field 'nanosec'"),
        ("ros2", "nsecs", "builtin_interfaces/Time has no field 'nsecs'"),
        ("dds", "nsecs", "builtin_interfaces/Time has no field 'nsecs'"),
    ],
)
def test_parts_of_a_time_are_those_of_the_platform(
    tmp_path: Path, platform: str, name: str, refused: str
) -> None:
    config = yaml.safe_load((CONTRACT / "rover_config.yml").read_text("utf-8"))
    config["SimulatorOutputs"][1]["type"] = "sensor_msgs/Range"
    config["EDDIInputs"][1]["field"] = f"header.stamp.{name}"
    path = tmp_path / "config.yml"
    path.write_text(yaml.safe_dump(config, sort_keys=False), "utf-8")
    (monitor,), _ = monitors_of(CONTRACT / "rover.yml", [path])
    _, problems = platforms()[platform].monitor(monitor)
    errors = [one.message for one in problems if one.level == "error"]
    assert [one.partition(";")[0] for one in errors] == ([refused] if refused else [])


def test_names_of_packages_that_are_installed(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    folder = tmp_path / "opt/share/rover"
    folder.mkdir(parents=True)
    text = "<package><name>rover</name><version>1.0.0</version></package>"
    (folder / "package.xml").write_text(text)
    monkeypatch.setenv("AMENT_PREFIX_PATH", str(tmp_path / "opt"))
    taken = platforms()["ros2"].taken_names(tmp_path / "ws" / "src" / "eddi_monitor")
    assert {"rover", "rclpy", "json", package_names.LAUNCHER} <= taken.keys()


def test_hand_edits_survive_an_upgrade(workspace: Path) -> None:
    packages = workspace / "src" / "eddi_monitor"
    mine = {}
    for name, (old, new) in EDITED.items():
        path = packages / name
        text = path.read_text("utf-8")
        assert text.count(old) == 1
        path.write_text(text.replace(old, new), "utf-8")
        mine[name] = path.read_bytes()
    newer = workspace / "newer.xml"
    text = MODEL.read_text("utf-8")
    newer.write_text(text.replace("sensor of system B", "camera of system B"), "utf-8")
    done = run("upgrade", "-w", workspace, "-m", newer, cwd=workspace)
    assert done.status == 0, done.err
    text = mine["consertb/consertb/EDDIInput.py"].decode()
    mine["consertb/consertb/EDDIInput.py"] = text.replace("sensor of", "camera of").encode()
    assert {name: (packages / name).read_bytes() for name in EDITED} == mine
    assert run("status", "-w", workspace, cwd=workspace).status == 0
    listed = run("regions", packages / "consertb", cwd=workspace)
    assert "process_RtE_A_E0" in listed.out
    assert "edited" in listed.out
    traced = run("trace", "-w", workspace, cwd=workspace)
    assert traced.status == 0, traced.err
    assert "consertb" in traced.out
