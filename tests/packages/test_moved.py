"""A package that was moved or removed by hand: its hand edits are not lost without a word."""

from __future__ import annotations

import re
import shlex
import shutil
import subprocess
from collections.abc import Callable
from pathlib import Path

import pytest

from tests.checkouts import git
from tests.cli.command import Result, example, run

pytestmark = pytest.mark.slow

MODEL, CONFIG = "two_conserts.xml", "consert_a_config.yml"
PLAIN = ("generate", "--platform", "plain", "-o", "mon", "-m", MODEL, "-c", CONFIG)
CATKIN = ("generate", "-w", "ws", "-m", MODEL, "-c", CONFIG)
OURS = Path("ws/src/eddi_monitor")
BODY, HAND = "self.RtE_A_E0 = RtE_E0.data\n", "self.RtE_A_E0 = RtE_E0.data and True\n"


@pytest.fixture(scope="module")
def made(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Packages of both platforms with hand edits, committed."""
    folder = example(tmp_path_factory.mktemp("made"))
    (folder / "ws/src").mkdir(parents=True)
    for words, file in ((PLAIN, plain(folder)), (CATKIN, catkin(folder))):
        assert run(*words, cwd=folder).status == 0
        text = file.read_text()
        assert BODY in text
        file.write_text(text.replace(BODY, HAND))
    git(folder, "init", "-q")
    git(folder, "add", "-A")
    git(folder, "commit", "-qm", "with hand edits")
    return folder


@pytest.fixture
def folder(made: Path, tmp_path: Path) -> Path:
    return Path(shutil.copytree(made, tmp_path / "clone"))


def plain(folder: Path) -> Path:
    return folder / "mon/conserta/EDDIInput.py"


def catkin(folder: Path) -> Path:
    return folder / OURS / "conserta/src/conserta/EDDIInput.py"


def follow(text: str, folder: Path) -> None:
    """Do what a report says between backticks."""
    (command,) = re.findall("`([^`]*)` bring", text)
    for one in command.split(" && "):
        subprocess.run(shlex.split(one), cwd=folder, check=True, capture_output=True)


def removed(folder: Path) -> None:
    shutil.rmtree(folder / "mon/conserta")
    shutil.rmtree(folder / OURS / "conserta")


def removed_and_committed(folder: Path) -> None:
    removed(folder)
    git(folder, "commit", "-qam", "removed")
    (folder / "later").touch()
    git(folder, "add", "later")
    git(folder, "commit", "-qm", "later")


def moved(folder: Path) -> None:
    git(folder, "mv", "mon/conserta", "mon/old")
    git(folder, "mv", f"{OURS}/conserta", f"{OURS}/old")


def moved_without_git(folder: Path) -> None:
    moved(folder)
    shutil.rmtree(folder / ".git")


@pytest.mark.parametrize("change", [removed, removed_and_committed, moved, moved_without_git])
@pytest.mark.parametrize(("words", "file"), [(PLAIN, plain), (CATKIN, catkin)])
def test_hand_edits_of_a_package_that_is_gone_are_told(
    folder: Path,
    change: Callable[[Path], None],
    words: tuple[str, ...],
    file: Callable[[Path], Path],
) -> None:
    change(folder)
    result = run(*words, cwd=folder)
    assert result.status == 3, result.err
    (note,) = [line for line in result.err.splitlines() if "is gone" in line]
    assert "conserta was here and is gone" in note
    assert ("moved to" in note) == change.__name__.startswith("moved")
    assert BODY in file(folder).read_text()
    follow(note, folder)
    assert HAND in file(folder).read_text()
    again = run(*words, cwd=folder)
    assert (again.status, "is gone" in again.err) == (0, False), again.err
    assert HAND in file(folder).read_text()


def test_a_package_without_hand_edits_may_go(folder: Path) -> None:
    for file, _ in ((plain(folder), 0), (catkin(folder), 0)):
        file.write_text(file.read_text().replace(HAND, BODY))
    git(folder, "commit", "-qam", "as it was generated")
    removed(folder)
    for words in (PLAIN, CATKIN):
        result = run(*words, cwd=folder)
        assert (result.status, "is gone" in result.err) == (0, False), result.err


def test_a_package_that_a_rename_has_moved_is_not_missed(folder: Path) -> None:
    model = (folder / MODEL).read_text()
    config = (folder / CONFIG).read_text()
    (folder / MODEL).write_text(model.replace("ConSertA", "Rover"))
    (folder / CONFIG).write_text(config.replace("ConSertA", "Rover"))
    result = run(*PLAIN, "--rename", "ConSertA=Rover", cwd=folder)
    assert (result.status, "is gone" in result.err) == (0, False), result.err
    assert HAND in (folder / "mon/rover/EDDIInput.py").read_text()
    (folder / MODEL).write_text(model)
    (folder / CONFIG).write_text(config)
    result = run(*PLAIN, cwd=folder)
    assert "is gone" not in result.err


def check_refused(result: Result, folder: Path) -> None:
    assert result.status == 2, result.err
    assert "this is the package that eddi-scaffold generated for conserta; it was moved" in (
        result.err
    )
    assert "choose another" not in result.err
    status = run("status", "-w", "ws", cwd=folder)
    assert status.status in {1, 2}
    assert "was moved" in status.out + status.err
    (line,) = [line for line in result.err.splitlines() if "hint: move it back: " in line]
    command = line.partition("back: ")[2]
    assert command in status.out + status.err
    subprocess.run(shlex.split(command), cwd=folder, check=True)
    assert run(*CATKIN, cwd=folder).status == 0
    assert HAND in catkin(folder).read_text()
    assert run("status", "-w", "ws", cwd=folder).status == 0


def test_a_package_that_was_moved_out_of_our_folder_is_recognised(folder: Path) -> None:
    (folder / "ws/src/vehicle").mkdir()
    git(folder, "mv", f"{OURS}/conserta", "ws/src/vehicle/conserta")
    check_refused(run(*CATKIN, cwd=folder), folder)


def test_our_folder_under_another_name_is_recognised(folder: Path) -> None:
    git(folder, "mv", f"{OURS}", "ws/src/monitors")
    check_refused(run(*CATKIN, cwd=folder), folder)
