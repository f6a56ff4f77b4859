"""A third platform is files in its own folders: nothing outside of them knows it, or is changed.

It is added to a copy of the checkout, and lives there as the others do: beside ROS 1 in one
workspace, with a support package, and with names that say nothing to a parser.
"""

from __future__ import annotations

import shutil
import sys
from pathlib import Path

import pytest

from eddi_scaffold.platforms import names, owner_of, platforms
from tests.checkouts import HERE, Checkout, checkout, git, run
from tests.cli.command import example

pytestmark = pytest.mark.slow

TOY = Path(__file__).with_name("toy")
TEMPLATES = ("robot", "fleet")
PLATFORM = "eddi_scaffold/platforms/amiga_500/"
TRANSPORT = "runtime_lib/src/eddi_runtime/transports/floppy/"
ADDED = (PLATFORM, TRANSPORT, *(f"copier_templates/{name}/" for name in TEMPLATES))
STAGED = ".eddi/new/{{ stage }}"
HAND = "        self.hand = 'mine'\n"


def transports(runtime: Path) -> set[str]:
    return {path.parent.name for path in runtime.glob("transports/*/__init__.py")}


def with_the_toy(path: Path) -> Checkout:
    """Return a checkout in which somebody added a platform."""
    clone = checkout(path, "v0.0.1")
    for name in (PLATFORM, TRANSPORT):
        skip = shutil.ignore_patterns("__pycache__")
        shutil.copytree(TOY / Path(name).name, clone.path / name, ignore=skip)
    for name in TEMPLATES:
        shutil.copytree(TOY / name, clone.path / "copier_templates" / name)
    link = clone.path / "copier_templates" / "robot" / STAGED / "eddi_runtime"
    link.symlink_to("../../../../../runtime_lib/src/eddi_runtime")
    git(clone.path, "add", "--all")
    git(clone.path, "commit", "--quiet", "--message", "Monitors for the Amiga 500")
    changed = git(clone.path, "diff", "--name-status", "HEAD~", "HEAD").splitlines()
    for status, _, name in (line.partition("\t") for line in changed):
        assert status == "A", "nothing else is touched"
        assert name.startswith(ADDED)
    return clone


def test_it_lives_beside_ros1_as_the_others_do(tmp_path: Path) -> None:
    clone = with_the_toy(tmp_path / "eddi-scaffold")
    example(tmp_path)
    model = ("-m", "two_conserts.xml")
    config_a, config_b = (("-c", f"consert_{letter}_config.yml") for letter in "ab")
    amiga = (*model, *config_b, "--platform", "amiga_500")
    commands = {
        ("generate", "--platform", "atari", "-o", ".", *model): 2,
        ("generate", "--platform", "amiga_500", "-w", "no", *model): 2,
        ("generate", "-w", "ws", *model, *config_a): 0,
        ("generate", "-w", "ws", *amiga): 0,
        ("status", "-w", "ws"): 0,
    }
    unknown, nowhere, _, made, _ = clone.several(commands, tmp_path)
    assert "platforms: amiga_500, dds, plain, ros1, ros2" in unknown
    assert "there is no such box of floppy disks" in nowhere
    assert "switch on consertb" in made
    packages = tmp_path / "ws" / "src" / "eddi_monitor"
    robot = packages / "consertb"
    assert "red screen" in (robot / "node.py").read_text("utf-8")
    assert not {"about", "questions.yml", "package.xml"} & {path.name for path in robot.iterdir()}
    assert transports(robot / "eddi_runtime") == {"floppy"}
    assert transports(packages / "eddi_runtime" / "src" / "eddi_runtime") == {"ros1"}
    assert (packages / "all_robots" / "robots.txt").read_text("utf-8").split()[-1:] == ["consertb"]
    manifest = (packages / "eddi_monitor" / "package.xml").read_text("utf-8")
    assert "<exec_depend>conserta<" in manifest
    assert "consertb" not in manifest

    code = "from consertb.node import step; print(step({}))"
    answer = run([sys.executable, "-B", "-c", code], packages, {"PYTHONPATH": str(robot)}).stdout
    assert answer.startswith("([{'id': 'System_A_G0_c2', 'active': False}"), answer
    assert "missing" in answer

    written = robot / "EDDIInput.py"
    text = written.read_text("utf-8")
    end = text[text.index("        '''-----Manual edit end") :].splitlines()[0]
    written.write_text(text.replace(end, HAND + end, 1), "utf-8")
    old = (tmp_path / "two_conserts.xml").read_text("utf-8")
    assert "sensor of system B" in old
    (tmp_path / "newer.xml").write_text(old.replace("sensor of", "camera of"), "utf-8")
    template = clone.path / "copier_templates" / "robot" / STAGED / "node.py.jinja"
    template.write_text(template.read_text("utf-8").replace("One step", "Each step"), "utf-8")
    clone.several({("upgrade", robot, "-m", "newer.xml"): 0}, tmp_path)
    assert written.read_text("utf-8").count(HAND) == 1
    assert "Each step" in (robot / "node.py").read_text("utf-8")


def test_every_template_has_one_platform() -> None:
    """Asked of the platforms, which are called as their folders are."""
    assert list(platforms()) == [one.name for one in platforms().values()] == list(names())
    folders = [path.parent.name for path in (HERE / "copier_templates").glob("*/about.jinja")]
    folders.remove("start")  # of people
    owners = {name: [p for p in platforms().values() if name in p.templates] for name in folders}
    assert {name: [owner_of(name)] for name in folders} == owners
    declared = [name for p in platforms().values() for name in p.templates]
    assert sorted(declared) == sorted(folders)
