"""A person saves a file while a command runs, or starts another command in the same workspace."""

from __future__ import annotations

import shutil
from collections.abc import Callable
from pathlib import Path
from unittest.mock import patch

import pytest

from eddi_scaffold.cli.console import console
from tests.cli.command import Result, example, files_below, run
from tests.diagnosed import assert_example

pytestmark = pytest.mark.slow

MODEL = "two_conserts.xml"
CONFIG_A, CONFIG_B = "consert_a_config.yml", "consert_b_config.yml"
GENERATE = ("generate", "-w", "ws", "-m", MODEL, "-c", CONFIG_B)
UPGRADE = ("upgrade", "-w", "ws", "-m", MODEL, "-c", CONFIG_B)
PACKAGE = Path("ws/src/eddi_monitor/consertb")
INPUT = PACKAGE / "src/consertb/EDDIInput.py"
MINE = "# written while the command was running\n"


@pytest.fixture(scope="module")
def generated(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A workspace that a newer configuration has not reached yet."""
    folder = example(tmp_path_factory.mktemp("made"))
    (folder / "ws/src").mkdir(parents=True)
    assert run(*GENERATE, cwd=folder).status == 0
    config = folder / CONFIG_B
    config.write_text(config.read_text().replace("std_msgs.Bool", "std_msgs.Int8"))
    return folder


@pytest.fixture
def folder(generated: Path, tmp_path: Path) -> Path:
    return Path(shutil.copytree(generated, tmp_path / "clone"))


# a file that is saved -----------------------------------------------------------------------------
def run_while(person: Callable[[], object], *words: str, cwd: Path) -> Result:
    """Run a command; the person acts when the package of the monitor is merged, none written."""

    def progress(package: str) -> None:
        if package == "eddi_runtime":
            person()

    with patch.object(console, "progress", progress):
        return run(*words, cwd=cwd)


def append(path: Path) -> None:
    path.write_text(path.read_text() + MINE)


@pytest.mark.parametrize("words", [GENERATE, UPGRADE])
def test_what_is_saved_during_a_run_stays(folder: Path, words: tuple[str, ...]) -> None:
    before = files_below(folder)
    result = run_while(lambda: append(folder / INPUT), *words, cwd=folder)
    assert result.status == 2
    assert_example("F013", result.err)
    before[str(INPUT)] += MINE.encode()
    assert files_below(folder) == before
    assert run(*words, cwd=folder).status in {0, 3}
    assert (folder / INPUT).read_text().count(MINE) == 1


@pytest.mark.parametrize(
    "name", ["README.md", "src/consertb/EDDIMonitor.py", "package.xml", "test/new.py"]
)
def test_any_other_file_that_is_saved_stays(folder: Path, name: str) -> None:
    path = folder / PACKAGE / name
    path.parent.mkdir(exist_ok=True)
    path.touch()
    run_while(lambda: append(path), *GENERATE, cwd=folder)
    saved = "".join(file.read_text() for file in (folder / PACKAGE).rglob("*") if file.is_file())
    assert saved.count(MINE) == 1


def test_a_file_of_ours_that_a_person_makes_during_the_run_stays(folder: Path) -> None:
    shutil.rmtree(folder / PACKAGE)
    path = folder / INPUT
    result = run_while(
        lambda: (path.parent.mkdir(parents=True), path.write_text(MINE)), *GENERATE, cwd=folder
    )
    assert result.status == 2
    assert path.read_text() == MINE


def test_a_file_that_a_person_removes_during_the_run_is_said(folder: Path) -> None:
    result = run_while((folder / INPUT).unlink, *GENERATE, cwd=folder)
    assert result.status == 2
    assert not (folder / INPUT).exists()
