"""A monitor gets another name: its package moves, or it is said that the old one is left behind."""

from __future__ import annotations

from pathlib import Path

import pytest

from eddi_scaffold.common.problems import EddiError
from eddi_scaffold.packages.renaming import Renames
from tests.checkouts import git
from tests.cli.command import edit, example, files_below, run
from tests.diagnosed import assert_reported

pytestmark = pytest.mark.slow

MODEL, CONFIG_A, CONFIG_B = "two_conserts.xml", "consert_a_config.yml", "consert_b_config.yml"
PACKAGES = Path("ws/src/eddi_monitor")
OLD, NEW = PACKAGES / "conserta", PACKAGES / "rover"
GENERATE = ("generate", "-w", "ws", "-m", MODEL, "-c", CONFIG_A)
RENAME = (*GENERATE, "--rename", "ConSertA=Rover")
HAND = "self.RtE_A_E0 = self.RtE_A_E0  # written by hand\n"


@pytest.fixture(scope="module")
def generated(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A workspace with two monitors, hand edits and own files, whose first model has a new name."""
    folder = example(tmp_path_factory.mktemp("made"))
    assert run("generate", "-w", "ws", "-m", MODEL, "-c", CONFIG_B, cwd=folder).status == 0
    assert run(*GENERATE, cwd=folder).status == 0
    place = folder / OLD / "src/conserta/EDDIInput.py"
    edit(place, "        self.RtE_A_E0 = RtE_E0.data\n", f"        {HAND}")
    end = "  <!-- Manual edit end | region: launch.own -->"
    edit(folder / OLD / "launch/eddi_monitor.launch", end, f"  <!-- mine -->\n{end}")
    (folder / OLD / "src/conserta/own.py").write_text("CALIBRATION = 3\n")
    (folder / OLD / "data/conserta").mkdir(parents=True)
    (folder / OLD / "data/conserta/run.sh").write_bytes(b"#!/bin/sh\n\xff\n")
    (folder / OLD / "data/conserta/run.sh").chmod(0o700)
    for name in (MODEL, CONFIG_A):
        edit(folder / name, "ConSertA", "Rover")
    return folder


def test_the_same_topic_of_two_packages_is_told(folder: Path) -> None:
    result = run(*GENERATE, cwd=folder)
    assert result.status == 3
    assert "Rover and the package conserta that is there publish the same topic" in result.err
    assert "`--rename conserta=rover`" in result.err
    result = run("upgrade", "--dry-run", "-w", "ws", cwd=folder)
    assert "publish the same topic" in result.err


def test_a_second_model_of_a_file_is_no_rename(folder: Path) -> None:
    result = run("generate", "-w", "ws", "-m", MODEL, "-c", CONFIG_B, cwd=folder)
    assert "was made of" in result.err  # of the renamed one, which is in the same file
    edit(folder / MODEL, "Rover", "ConSertA")
    result = run("generate", "-w", "ws", "-m", MODEL, "-c", CONFIG_B, cwd=folder)
    assert "was made of" not in result.err


def check_moved(folder: Path) -> None:
    assert not files_below(folder / OLD)
    assert HAND in (folder / NEW / "src/rover/EDDIInput.py").read_text()
    assert "<!-- mine -->" in (folder / NEW / "launch/eddi_monitor.launch").read_text()
    assert (folder / NEW / "src/rover/own.py").read_text() == "CALIBRATION = 3\n"
    script = folder / NEW / "data/conserta/run.sh"
    assert script.read_bytes() == b"#!/bin/sh\n\xff\n"
    assert script.stat().st_mode & 0o777 == 0o700
    launch = (folder / PACKAGES / "eddi_monitor_launcher/launch/eddi.launch").read_text()
    assert "$(find rover)" in launch
    assert "$(find consertb)" in launch
    assert "conserta" not in launch
    names = [path for path in files_below(folder / NEW) if "data/" not in path]
    assert not [path for path in names if "conserta" in path]
    assert run("regions", "--check", "ws", cwd=folder).status == 0
    assert run("status", "-w", "ws", cwd=folder).status == 0


@pytest.mark.parametrize("killed", [False, True])
def test_a_package_moves_with_everything_in_it(folder: Path, killed: bool) -> None:
    before = files_below(folder)
    dry = run(*RENAME, "--dry-run", cwd=folder)
    assert dry.status == 0
    assert files_below(folder) == before
    if killed:  # a run that had moved the folder
        (folder / OLD).rename(folder / NEW)
    result = run(*RENAME, cwd=folder)
    assert result.status == 0, result.err
    assert "note: conserta is called rover now; all in it moved along" in result.err
    check_moved(folder)
    made = files_below(folder)
    assert run(*GENERATE, cwd=folder).status == 0
    assert files_below(folder) == made


def test_edits_around_the_name_move_along(folder: Path) -> None:
    """Of a generated file, and around its include in the launcher."""
    path = folder / OLD / "src/conserta/EDDIMonitor.py"
    path.write_text(path.read_text() + "# mine\n")
    launch = folder / PACKAGES / "eddi_monitor_launcher/launch/eddi.launch"
    include = '  <include file="$(find conserta)'
    edit(launch, include, f"  <!-- mine -->\n{include}")
    result = run(*RENAME, cwd=folder)
    assert result.status == 3
    kept = folder / NEW / ".eddi/kept/src/conserta/EDDIMonitor.py"
    assert kept.read_text().endswith("# mine\n")
    assert "region 'launcher.include_rover': look at it" in result.err
    assert "<!-- mine -->" in launch.read_text().partition("launcher.include_rover")[2]
    assert list((folder / PACKAGES).glob("*/.eddi/kept/*")) == [kept.parents[1]]


WRONG = {
    ("Rover",): "'Rover' is not OLD=NEW",
    ("Nothing=Rover",): "there is no package 'nothing'",
    ("ConSertA=Other",): "this command makes no package 'other'",
    ("ConSertA=Rover", "ConSertB=Rover"): "twice, or not at all",
    ("ConSertA=Rover", "Rover=ConSertA"): "twice, or not at all",
}


def test_renames_that_cannot_be_made(folder: Path) -> None:
    before = files_below(folder)
    for words, about in WRONG.items():
        options = [part for word in words for part in ("--rename", word)]
        result = run(*GENERATE, *options, cwd=folder)
        assert (result.status, about in result.err) == (2, True), result.err
        assert "[G025]" in result.err
    assert files_below(folder) == before


def test_nothing_that_was_written_is_moved_over(folder: Path) -> None:
    edit(folder / CONFIG_A, "conserta/guarantees", "rover/guarantees")
    assert run(*GENERATE, cwd=folder).status == 3
    own = folder / NEW / "src/rover/own.py"
    own.write_text("")
    result = run(*RENAME, cwd=folder)
    assert result.status == 2
    assert "something in it was written by hand" in result.err
    assert_reported("G025", result.err)


def test_what_is_written_meanwhile_into_the_folder_that_makes_room_stays(folder: Path) -> None:
    (folder / NEW).mkdir()
    renames = Renames({"rover": "conserta"}, {"rover": "conserta"})
    (folder / NEW / "own.py").write_text("")
    with pytest.raises(EddiError, match="something in it was written by hand"):
        renames.move(folder / PACKAGES)
    assert (folder / NEW / "own.py").exists()
    assert (folder / OLD).is_dir()


def commit(folder: Path) -> Path:
    git(folder, "init", "-q")
    git(folder, "add", "-A")
    git(folder, "commit", "-qm", "work")
    return folder
