"""A person saves a file while a command runs, or starts another command in the same workspace."""

from __future__ import annotations

import shutil
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from unittest.mock import patch

import pytest

from eddi_scaffold.cli.console import console
from eddi_scaffold.regions.package import locked
from tests.cli.command import Result, example, files_below, run, scaffold
from tests.diagnosed import assert_reported

pytestmark = pytest.mark.slow

MODEL = "two_conserts.xml"
CONFIG_A, CONFIG_B = "consert_a_config.yml", "consert_b_config.yml"
GENERATE = ("generate", "-w", "ws", "-m", MODEL, "-c", CONFIG_B)
UPGRADE = ("upgrade", "-w", "ws", "-m", MODEL, "-c", CONFIG_B)
ROOT = Path("ws/src/eddi_monitor")
PACKAGE = ROOT / "consertb"
INPUT = PACKAGE / "src/consertb/EDDIInput.py"
MINE = "# written while the command was running\n"


@pytest.fixture(scope="module")
def generated(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A workspace that a newer configuration has not reached yet."""
    folder = example(tmp_path_factory.mktemp("made"))
    assert run(*GENERATE, cwd=folder).status == 0
    config = folder / CONFIG_B
    config.write_text(config.read_text().replace("std_msgs.Bool", "std_msgs.Int8"))
    return folder


def run_while(person: Callable[[], object], *words: str, cwd: Path) -> Result:
    """Run a command; the person acts when the package of the monitor is merged, none written."""

    def progress(package: str) -> None:
        if package == "eddi_runtime":
            person()

    with patch.object(console, "progress", progress):
        return run(*words, cwd=cwd)


def saved(folder: Path) -> int:
    texts = (path.read_text() for path in (folder / PACKAGE).rglob("*") if path.is_file())
    return "".join(texts).count(MINE)


def append(path: Path) -> None:
    path.write_text(path.read_text() + MINE)


def test_what_is_saved_during_a_run_stays(folder: Path) -> None:
    before = files_below(folder)
    result = run_while(lambda: append(folder / INPUT), *GENERATE, cwd=folder)
    assert result.status == 2
    assert_reported("F013", result.err)
    before[str(INPUT)] += MINE.encode()
    assert files_below(folder) == before
    assert run(*UPGRADE, cwd=folder).status in {0, 3}
    assert saved(folder) == 1


def test_any_other_file_that_is_saved_stays(folder: Path) -> None:
    paths = [folder / PACKAGE / name for name in ("src/consertb/EDDIMonitor.py", "test/new.py")]
    paths[1].touch()
    run_while(lambda: [append(path) for path in paths], *GENERATE, cwd=folder)
    assert saved(folder) == 2


def test_a_file_of_ours_that_a_person_makes_during_the_run_stays(folder: Path) -> None:
    shutil.rmtree(folder / PACKAGE)
    path = folder / INPUT
    result = run_while(
        lambda: (path.parent.mkdir(parents=True), path.write_text(MINE)), *GENERATE, cwd=folder
    )
    assert result.status == 2
    assert path.read_text() == MINE


def test_what_is_saved_while_its_package_gets_another_name_moves_along(folder: Path) -> None:
    config, model = folder / CONFIG_B, folder / MODEL
    config.write_text(config.read_text().replace("id: ConSertB", "id: Rover"))
    model.write_text(model.read_text().replace('name="ConSertB"', 'name="Rover"'))
    notes = folder / PACKAGE / "notes.txt"
    notes.write_text("of before\n")
    rename = (*GENERATE, "--rename", "ConSertB=Rover")
    result = run_while(lambda: notes.write_text(MINE), *rename, cwd=folder)
    assert result.status in {0, 3}, result.err
    assert (folder / ROOT / "rover/notes.txt").read_text() == MINE


def test_a_second_run_is_refused_but_not_a_look(folder: Path) -> None:
    before = files_below(folder)
    (folder / "link").symlink_to(PACKAGE)  # the same folder by another path
    hold = (
        "import sys, time, pathlib\nfrom eddi_scaffold.regions.package import locked\n"
        "with locked(pathlib.Path(sys.argv[1])): print('held', flush=True); time.sleep(60)"
    )
    words = [sys.executable, "-c", hold, str(folder / "link")]
    accept = ("regions", "--accept", "process_RtE_A_E0", "ws")
    with subprocess.Popen(words, stdout=subprocess.PIPE, text=True) as first:
        assert first.stdout is not None
        assert first.stdout.readline() == "held\n"
        for command in (GENERATE, ("upgrade", str(PACKAGE)), accept):
            result = run(*command, cwd=folder)
            assert result.status == 2
            assert_reported("F012", result.err)
        for command in (("status", "-w", "ws"), (*GENERATE, "--dry-run"), ("regions", "ws")):
            assert run(*command, cwd=folder).status in {0, 1, 3}  # 3: an input lost its source
        assert files_below(folder) == before
        first.kill()
    assert run(*GENERATE, cwd=folder).status in {0, 3}  # a lock of the dead holds nobody


def test_two_monitors_at_once_are_both_launched_or_one_is_refused(tmp_path: Path) -> None:
    example(tmp_path)
    commands = [("generate", "-w", "ws", "-m", MODEL, "-c", c) for c in (CONFIG_A, CONFIG_B)]
    runs = [scaffold(*words, cwd=tmp_path) for words in commands]
    said = [process.communicate()[1] for process in runs]
    for words, process, text in zip(commands, runs, said, strict=True):
        if process.returncode == 2:
            assert "[F012]" in text
            assert run(*words, cwd=tmp_path).status == 0
        else:
            assert process.returncode == 0, text
    launched = (tmp_path / ROOT / "eddi_monitor_launcher/launch/eddi.launch").read_text()
    assert "consertb" in launched
    assert "conserta" in launched


def test_a_folder_that_is_not_there_has_no_lock(tmp_path: Path) -> None:
    with locked(tmp_path / "none"), locked(tmp_path / "none"):
        pass
