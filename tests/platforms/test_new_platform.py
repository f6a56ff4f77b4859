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
from tests.checkouts import HERE, Checkout, checkout, git, run, tree, without_origin

pytestmark = pytest.mark.slow

TOY = Path(__file__).with_name("toy")
TEMPLATES = ("robot", "fleet")
PLATFORM = "eddi_scaffold/platforms/amiga_500/"
TRANSPORT = "runtime_lib/src/eddi_runtime/transports/floppy/"
ADDED = (PLATFORM, TRANSPORT, *(f"copier_templates/{name}/" for name in TEMPLATES))
WORKSPACE = Path("ws", "src", "eddi_monitor")
STAGED = ".eddi/new/{{ stage }}"
HAND = "        self.hand = 'mine'\n"


@pytest.fixture(scope="module")
def clone(tmp_path_factory: pytest.TempPathFactory) -> Checkout:
    """Return a checkout in which somebody added a platform."""
    made = checkout(tmp_path_factory.mktemp("toy") / "eddi-scaffold", "v0.0.1")
    skip = shutil.ignore_patterns("__pycache__")
    for name in (PLATFORM, TRANSPORT):
        shutil.copytree(TOY / Path(name).name, made.path / name, ignore=skip)
    for name in TEMPLATES:
        shutil.copytree(TOY / name, made.path / "copier_templates" / name)
    link = made.path / "copier_templates" / "robot" / STAGED / "eddi_runtime"
    link.symlink_to("../../../../../runtime_lib/src/eddi_runtime")
    git(made.path, "add", "--all")
    git(made.path, "commit", "--quiet", "--message", "Monitors for the Amiga 500")
    return made


@pytest.fixture(scope="module")
def world(clone: Checkout) -> Path:
    """Return a folder with a workspace in which ROS 1 and the new platform have a monitor each."""
    folder = clone.path.parent
    (folder / "ws" / "src").mkdir(parents=True)
    for path in clone.example.iterdir():
        if path.is_file():
            shutil.copy(path, folder)
    generate(clone, "a", "ros1")
    return folder


def generate(clone: Checkout, letter: str, platform: str) -> str:
    model = ("-m", "two_conserts.xml", "-c", f"consert_{letter}_config.yml")
    return clone.eddi("generate", "-w", "ws", *model, "--platform", platform)


def transports(runtime: Path) -> set[str]:
    return {path.parent.name for path in runtime.glob("transports/*/__init__.py")}


def test_nothing_else_is_touched(clone: Checkout) -> None:
    changed = git(clone.path, "diff", "--name-status", "HEAD~", "HEAD").splitlines()
    assert changed
    for line in changed:
        status, _, path = line.partition("\t")
        assert status == "A"
        assert path.startswith(ADDED)


def test_it_is_offered(clone: Checkout) -> None:
    help_text = run(
        [sys.executable, "-m", "eddi_scaffold", "generate", "--help"],
        clone.path,
        {"PYTHONPATH": str(clone.path), "COLUMNS": "200", "TERM": "dumb"},
    ).stdout
    assert "amiga_500 or dds or plain or ros1 or ros2" in help_text
    said = clone.eddi("generate", "--platform", "atari", "-o", ".", "-m", "nothing.xml", status=2)
    assert "platforms: amiga_500, dds, plain, ros1, ros2" in said
    model = clone.example / "two_conserts.xml"
    said = clone.eddi("generate", "--platform", "amiga_500", "-w", "no", "-m", model, status=2)
    assert "there is no such box of floppy disks" in said


def test_it_lives_beside_ros1(clone: Checkout, world: Path) -> None:
    said = generate(clone, "b", "amiga_500")
    assert "switch on consertb" in said
    packages = world / WORKSPACE
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
    answer = run([sys.executable, "-c", code], packages, {"PYTHONPATH": ""}).stdout
    assert answer.startswith("([{'id': 'System_A_G0_c2', 'active': False}"), answer
    assert "missing" in answer

    clone.eddi("status", "-w", "ws")  # another exit status when a package differs


def test_plain_copier_renders_the_same(clone: Checkout, world: Path, tmp_path: Path) -> None:
    generate(clone, "b", "amiga_500")
    words = ("-m", "two_conserts.xml", "-c", "consert_b_config.yml", "--platform", "amiga_500")
    clone.eddi("answers", *words, "-w", "ws", "--all", "-o", tmp_path)
    for name in ("consertb", "all_robots"):
        answers = ("--data-file", f"{name}.yml")
        where = ("--vcs-ref", "HEAD", *answers, clone.path, f"copied/{name}")
        clone.copier("copy", "--trust", "--defaults", *where, cwd=tmp_path)
        got, wanted = tree(tmp_path / "copied" / name), tree(world / WORKSPACE / name)
        file = ".copier-answers.yml"
        assert without_origin(got.pop(file)[1]) == without_origin(wanted.pop(file)[1])
        assert got == wanted


def test_it_is_upgraded(clone: Checkout, world: Path) -> None:
    generate(clone, "b", "amiga_500")
    written = world / WORKSPACE / "consertb" / "EDDIInput.py"
    text = written.read_text("utf-8")
    end = text[text.index("        '''-----Manual edit end") :].splitlines()[0]
    written.write_text(text.replace(end, HAND + end, 1), "utf-8")

    model = world / "newer.xml"
    old = (world / "two_conserts.xml").read_text("utf-8")
    newer = old.replace("sensor of system B", "camera of system B")
    assert newer != old
    model.write_text(newer, "utf-8")
    template = clone.path / "copier_templates" / "robot" / STAGED / "node.py.jinja"
    template.write_text(template.read_text("utf-8").replace("One step", "Each step"), "utf-8")
    clone.eddi("upgrade", world / WORKSPACE / "consertb", "-m", model, cwd=world)
    git(clone.path, "checkout", "--quiet", "--", ".")

    assert written.read_text("utf-8").count(HAND) == 1
    robot = written.parent
    assert "Each step" in (robot / "node.py").read_text("utf-8")
    clone.eddi("upgrade", "-w", "ws")
    assert written.read_text("utf-8").count(HAND) == 1
    assert "One step" in (robot / "node.py").read_text("utf-8")


def test_every_template_has_one_platform() -> None:
    """Asked of the platforms, which are called as their folders are."""
    assert list(platforms()) == [one.name for one in platforms().values()] == list(names())
    folders = [path.parent.name for path in (HERE / "copier_templates").glob("*/about.jinja")]
    owners = {name: [p for p in platforms().values() if p.owns(name)] for name in folders}
    assert {name: [owner_of(name)] for name in folders} == owners
    declared = [
        name for p in platforms().values() for name in (p.templates.monitor, *p.templates.support)
    ]
    assert sorted(declared) == sorted(folders)
