"""A person saves a file while a command runs, or starts another command in the same workspace."""

from __future__ import annotations

import os
import re
import shutil
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Callable
from pathlib import Path
from unittest.mock import patch

import pytest

from eddi_scaffold.cli.console import console
from eddi_scaffold.packages import transaction
from eddi_scaffold.regions import __main__ as command
from eddi_scaffold.regions.__main__ import main as regions_tool
from eddi_scaffold.regions.bases import read_bases
from eddi_scaffold.regions.lock import BusyError, locked
from eddi_scaffold.regions.state import key_of
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


@pytest.mark.parametrize("package", ["consertb", "rover"])
def test_what_is_saved_while_its_package_gets_another_name_stays(
    folder: Path, package: str
) -> None:
    config, model = folder / CONFIG_B, folder / MODEL
    config.write_text(config.read_text().replace("id: ConSertB", "id: Rover"))
    model.write_text(model.read_text().replace('name="ConSertB"', 'name="Rover"'))
    place = folder / ROOT / package / "notes.txt"

    def person() -> None:
        place.parent.mkdir(exist_ok=True)
        place.write_text(MINE)

    (folder / PACKAGE / "notes.txt").write_text("of before\n")
    result = run_while(person, *GENERATE, "--rename", "ConSertB=Rover", cwd=folder)
    assert result.status == 2, result.err
    assert "[F013]" in result.err
    assert place.read_text() == MINE
    assert (folder / INPUT).exists()


# another run --------------------------------------------------------------------------------------
ROOT = PACKAGE.parent
_HOLD = """
import sys, time
from pathlib import Path
from eddi_scaffold.regions.lock import locked
with locked(Path(sys.argv[1])):
    print("held", flush=True)
    time.sleep(float(sys.argv[2]))
"""


def holder(folder: Path, seconds: float = 60) -> subprocess.Popen[str]:
    """Start a process that holds the lock as a command does."""
    words = [sys.executable, "-c", _HOLD, str(folder), str(seconds)]
    process = subprocess.Popen(words, stdout=subprocess.PIPE, text=True)
    assert process.stdout is not None
    assert process.stdout.readline() == "held\n"
    return process


WRITING = (
    GENERATE,
    UPGRADE,
    ("upgrade", str(PACKAGE)),
    ("regions", "--accept", "input:RtE_A_E0", "ws"),
)


@pytest.mark.parametrize("words", WRITING)
def test_a_second_run_is_refused_with_the_first_one_named(
    folder: Path, words: tuple[str, ...]
) -> None:
    before = files_below(folder)
    (folder / "link").symlink_to(ROOT)  # the same folder by another path
    with holder(folder / "link") as first:
        result = run(*words, cwd=folder)
        first.kill()
    assert result.status == 2
    said = re.sub(r"since [-0-9]+ [:0-9]+", "since 2026-11-22 21:00:00", result.err)
    said = said.replace(f"process {first.pid}", "process 4711").replace(f"{folder}/", "")
    assert_example("F012", said)
    assert files_below(folder) == before
    assert run(*words, cwd=folder).status in {0, 3}  # a lock of the dead holds nobody


@pytest.mark.parametrize(
    "words",
    [("status", "-w", "ws"), (*GENERATE, "--dry-run"), ("upgrade", "-w", "ws", "--dry-run"),
     ("regions", "ws"), ("check", MODEL, CONFIG_B)],
)  # fmt: skip
def test_who_only_looks_takes_no_lock_and_waits_for_none(
    folder: Path, words: tuple[str, ...]
) -> None:
    with holder(folder / ROOT) as first:
        assert run(*words, cwd=folder).status in {0, 1, 3}  # 3: an input lost its source
        first.kill()


def test_another_workspace_is_not_locked(folder: Path) -> None:
    with holder(folder / "elsewhere") as first:
        assert run(*GENERATE, cwd=folder).status in {0, 3}
        first.kill()


def scaffold(*words: str, cwd: Path) -> subprocess.Popen[str]:
    code = (
        "import sys; from pathlib import Path; from eddi_scaffold.packages import rendering; "
        "from tests.cli.command import template; rendering.own_template = template; "
        "from eddi_scaffold.cli import main; main()"
    )
    environment = {**os.environ, "PYTHONPATH": str(Path(__file__).parents[2])}
    return subprocess.Popen(
        [sys.executable, "-c", code, *words],
        cwd=cwd, env=environment, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
    )  # fmt: skip


def test_two_monitors_at_once_are_both_launched_or_one_is_refused(tmp_path: Path) -> None:
    example(tmp_path)
    (tmp_path / "ws/src").mkdir(parents=True)
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


def test_a_killed_run_holds_nothing(folder: Path) -> None:
    process = scaffold(*GENERATE, cwd=folder)
    time.sleep(1.0)
    process.send_signal(signal.SIGKILL)
    process.communicate()
    assert run(*GENERATE, cwd=folder).status in {0, 3}


class Killed(BaseException):
    """The process ends here."""


def test_a_killed_run_is_finished_before_the_next_one_looks(tmp_path: Path) -> None:
    """The launcher of the next run starts what the killed one had decided to make, too."""
    example(tmp_path)
    (tmp_path / "ws/src").mkdir(parents=True)
    command_a, command_b = (
        ("generate", "-w", "ws", "-m", MODEL, "-c", config) for config in (CONFIG_A, CONFIG_B)
    )
    with patch.object(transaction, "_finish", side_effect=Killed), pytest.raises(Killed):
        run(*command_a, cwd=tmp_path)
    assert not (tmp_path / ROOT / "conserta").exists()
    result = run(*command_b, cwd=tmp_path)
    assert result.status == 0, result.err
    assert result.err.count("what an interrupted run had begun is finished") == 1
    launched = (tmp_path / ROOT / "eddi_monitor_launcher/launch/eddi.launch").read_text()
    assert "consertb" in launched
    assert "conserta" in launched


# the merge that plain Copier starts ---------------------------------------------------------------
def render_anew(package: Path) -> bytes:
    """Do what Copier does before it starts the merge; return what the file was."""
    pristine = package / ".eddi/pristine/src/consertb/EDDIInput.py"
    for name, base in read_bases(package).items():
        place = package / ".eddi/pristine" / name
        place.parent.mkdir(parents=True, exist_ok=True)
        place.write_text(f"{base}# eddi-scaffold: end of rendering\n")
    pristine.write_text(pristine.read_text().replace("One attribute", "Just one attribute"))
    return (package / "src/consertb/EDDIInput.py").read_bytes()


def test_sync_waits_for_a_run_that_ends(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    render_anew(folder / PACKAGE)
    with holder(folder / ROOT, 1.0):
        assert regions_tool(["sync"], folder / PACKAGE) == 0
    assert capsys.readouterr().err == ""
    assert "Just one attribute" in (folder / INPUT).read_text()


@pytest.mark.parametrize("word", ["sync", "check"])
def test_sync_and_check_say_who_is_at_work(
    folder: Path,
    word: str,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    before = render_anew(folder / PACKAGE)
    monkeypatch.setattr(command, "_WAIT_S", 0.1)
    with holder(folder / ROOT) as first:
        status = regions_tool([word], folder / PACKAGE)
        first.kill()
    assert status == (0 if word == "sync" else 1)
    assert f"process {first.pid} (since " in capsys.readouterr().err
    assert (folder / INPUT).read_bytes() == before
    assert regions_tool([word], folder / PACKAGE) == 0


# the lock itself ----------------------------------------------------------------------------------
def test_one_after_the_other_enters(tmp_path: Path) -> None:
    inside: list[int] = []
    most: list[int] = []

    def one() -> None:
        with locked(tmp_path, 30.0):
            inside.append(1)
            most.append(len(inside))
            time.sleep(0.05)
            inside.pop()

    threads = [threading.Thread(target=one) for _ in range(8)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert most == [1] * 8
    with locked(tmp_path), pytest.raises(BusyError), locked(tmp_path):
        pass


@pytest.mark.parametrize("state", ["file", "shared", "link"])
def test_without_a_place_for_the_lock_there_is_none(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, state: str
) -> None:
    """What others can write to decides nothing, and is not written to."""
    place = tmp_path / "state"
    shelf = place / "eddi-scaffold/locks"
    if state == "file":
        place.touch()
    else:
        shelf.mkdir(parents=True, mode=0o700)
        (tmp_path / "mine").write_text("mine")
        monkeypatch.setenv("XDG_STATE_HOME", str(place))
        (shelf / key_of(tmp_path)).symlink_to(tmp_path / "mine")
        shelf.chmod(0o777 if state == "shared" else 0o700)
    monkeypatch.setenv("XDG_STATE_HOME", str(place))
    with locked(tmp_path), locked(tmp_path):
        pass
    if state != "file":
        assert (tmp_path / "mine").read_text() == "mine"
