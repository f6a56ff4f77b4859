"""Files that are not editable files: of a person, or generated and edited all the same."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

from tests.updates.inputs import elements
from tests.updates.templates import ADDED, ADDED_TEXT, Templates, git
from tests.updates.world import Result, World, fresh_world, operations_of, snapshot

pytestmark = pytest.mark.slow

OWN = "calibration = 1.5\n"
MONITOR = "EDDIMonitor.py"
LATIN_1 = "# M\xf6we\n".encode("latin-1")


@pytest.fixture
def world(templates: Templates, folder: Path) -> World:
    world = fresh_world(templates, folder, inputs=elements("alpha", "beta"))
    world.edit("alpha")
    world.commit()
    return world


def run(world: World, operation: str, capfd: pytest.CaptureFixture[str]) -> Result:
    """Run an operation; return its words, and those of the tasks that Copier started."""
    capfd.readouterr()
    result: Result = getattr(world, operation)()
    assert result.status == (3 if operation in {"generate", "upgrade"} else 0), result
    world.settle()
    world.check()
    return Result(result.status, result.words + capfd.readouterr().err)


def kept(world: World, path: str) -> bytes:
    return (world.package / f".eddi/rejects/{path}.edited").read_bytes()


@pytest.mark.parametrize(
    ("ignored", "operation"), [(k == 1, one) for k in (0, 1) for one in operations_of(k)]
)
def test_own_file_whose_name_the_template_takes(
    world: World, operation: str, ignored: bool, capfd: pytest.CaptureFixture[str]
) -> None:
    path = world.package / ADDED
    path.write_text(OWN)
    if ignored:
        (world.workspace / ".gitignore").write_text(f"{path.name}\n")
    world.version += 1
    result = run(world, operation, capfd)
    assert path.read_text() == ADDED_TEXT
    assert kept(world, ADDED) == OWN.encode()
    assert f"your text is kept in .eddi/rejects/{ADDED}.edited" in result.words


@pytest.mark.parametrize("operation", operations_of(0))
def test_edit_of_a_generated_file(
    world: World, operation: str, capfd: pytest.CaptureFixture[str]
) -> None:
    path = world.package / MONITOR
    generated, edited = path.read_text(), path.read_text() + "\n# hand-written\n"
    path.write_text(edited)
    result = run(world, operation, capfd)
    assert path.read_text() == generated
    assert kept(world, MONITOR) == edited.encode()
    assert MONITOR in result.words


@pytest.mark.parametrize("operation", operations_of(0))
def test_edited_file_that_the_template_drops(
    world: World, operation: str, capfd: pytest.CaptureFixture[str]
) -> None:
    world.version += 1
    assert world.copy().status == 0
    path = world.package / ADDED
    assert path.read_text() == ADDED_TEXT
    path.write_text(ADDED_TEXT + OWN)
    world.version += 1
    result = run(world, operation, capfd)
    assert not path.exists()
    assert kept(world, ADDED) == (ADDED_TEXT + OWN).encode()
    assert ADDED in result.words


@pytest.mark.parametrize("operation", operations_of(1))
def test_file_that_the_template_drops(world: World, operation: str) -> None:
    world.version += 1
    assert world.copy().status == 0
    world.version += 1
    assert getattr(world, operation)().status == 0
    assert not (world.package / ADDED).exists()
    assert not (world.package / ".eddi/rejects").exists()


@pytest.mark.parametrize("operation", operations_of(1))
def test_both_change_a_generated_file(
    world: World, operation: str, capfd: pytest.CaptureFixture[str]
) -> None:
    """What git would merge to a conflict is the new rendering, and the person's text is kept."""
    world.change(*elements("alpha", "beta", "gamma"))
    path = world.package / "compiled.py"
    edited = path.read_text().replace("class Monitor", "MINE = 1\n\n\nclass Monitor")
    edited = edited.replace("beta", "mine")
    path.write_text(edited)
    run(world, operation, capfd)
    assert "gamma" in path.read_text()
    assert "MINE" not in path.read_text()
    assert kept(world, "compiled.py") == edited.encode()


@pytest.mark.parametrize("operation", operations_of(0))
def test_conflict_that_git_left(
    world: World, operation: str, capfd: pytest.CaptureFixture[str]
) -> None:
    path = world.package / MONITOR
    generated = path.read_text()
    path.write_text(f"<<<<<<< HEAD\n{generated}=======\n>>>>>>> other\n")
    result = run(world, operation, capfd)
    assert path.read_text() == generated
    assert kept(world, MONITOR).startswith(b"<<<<<<< HEAD\n")
    assert MONITOR in result.words


@pytest.mark.parametrize("operation", [*operations_of(0), *operations_of(1)[1:]])
def test_replacement_over_all_files(
    world: World, operation: str, capfd: pytest.CaptureFixture[str]
) -> None:
    """A line that is replaced in the records, too, looks generated."""
    for path in world.package.rglob("*"):
        if path.is_file():
            data = path.read_bytes()
            path.write_bytes(data.replace(b"self.beta = None", b"self.beta = False"))
    mine = (world.package / world.main).read_bytes()
    assert b"self.beta = False" in mine
    world.commit()
    world.change(*elements("alpha", "beta", "gamma"))
    if operation == "update":
        before = snapshot(world.package)
        assert world.update().status == 1
        assert snapshot(world.package) == before
        operation = "recopy"
    result = run(world, operation, capfd)
    assert kept(world, world.main) == mine
    assert f"kept in .eddi/rejects/{world.main}.edited" in result.words


@pytest.mark.parametrize("operation", operations_of(1))
def test_own_python_that_is_none(world: World, operation: str) -> None:
    files = {
        "tools/old.py": b"print 'Python 2'\n",
        "templates/new.py": b"{% for x in y %}\n",
        "tools/latin.py": LATIN_1,
    }
    for name, data in files.items():
        (world.package / name).parent.mkdir(exist_ok=True)
        (world.package / name).write_bytes(data)
    world.version += 1
    assert getattr(world, operation)().status == 0
    assert {name: (world.package / name).read_bytes() for name in files} == files


@pytest.mark.parametrize("operation", operations_of(0))
def test_formatted_files_were_not_edited(world: World, operation: str) -> None:
    """Not even in a layout that is far from the generator's."""
    words = [sys.executable, "-m", "ruff", "format", "--line-length", "60", "--isolated"]
    subprocess.run([*words, str(world.package)], check=True, capture_output=True)
    assert git(world.workspace, "diff", "--stat", "--", "*.py")
    world.change(*elements("alpha", "beta", "gamma"))
    world.version += 1
    assert getattr(world, operation)().status == 0
    world.settle()
    world.check()
    assert not (world.package / ".eddi/rejects").exists()


@pytest.mark.parametrize("own", ["README.md", "EDDIInput.py"])
def test_first_copy_into_a_folder_with_files(
    templates: Templates, folder: Path, own: str, capfd: pytest.CaptureFixture[str]
) -> None:
    world = World(folder, templates, "plain", elements("alpha"))
    world.package.mkdir(parents=True)
    (world.package / own).write_text("mine = 1\n")
    assert world.copy().status == 0
    rejects = [path for path in (world.package / ".eddi/rejects").iterdir() if path.is_file()]
    assert [path.name.startswith(own) for path in rejects] == [True]
    assert "mine = 1" in rejects[0].read_text()
    assert own in capfd.readouterr().err
    world.settle()
    world.check()
