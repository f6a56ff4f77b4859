"""What lies in a workspace does not say what is written: journals are this user's, or not used."""

from __future__ import annotations

import hashlib
import json
import os
import shutil
from collections.abc import Callable
from pathlib import Path

import pytest

from eddi_scaffold.packages import transaction
from eddi_scaffold.packages.transaction import FileState, apply, recover, tree_of
from tests.cli.command import Result, example, files_below, run

pytestmark = pytest.mark.slow

MODEL, CONFIG = "two_conserts.xml", "consert_b_config.yml"
OLD = {"a": FileState(b"old a"), "d/b": FileState(b"old b")}
NEW = {"a": FileState(b"new a"), "d/b": FileState(b"new b")}


def digest(data: bytes) -> str:
    return hashlib.sha256(data).hexdigest()


def plant(root: Path, steps: list[list[object]], name: str = "x", **staged: bytes) -> Path:
    """Plant what a killed run of an earlier release left: paths, new texts, digests."""
    folder = root / f".eddi-transaction-{name}"
    folder.mkdir(parents=True)
    (folder / "journal.json").write_text(json.dumps(steps))
    for number, data in staged.items():
        (folder / number.removeprefix("n")).write_bytes(data)
    return folder


@pytest.fixture(scope="module")
def generated(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = example(tmp_path_factory.mktemp("made"))
    made = run("generate", "--platform", "plain", "-o", "ws", "-m", MODEL, "-c", CONFIG, cwd=folder)
    assert made.status == 0, made.err
    return folder


@pytest.fixture
def workspace(generated: Path, tmp_path: Path) -> Path:
    """A workspace with one package, as one gets it from somebody."""
    return Path(shutil.copytree(generated, tmp_path / "clone"), "ws")


def upgrade(workspace: Path) -> Result:
    return run("upgrade", "-w", workspace, cwd=workspace.parent)


def generate(workspace: Path) -> Result:
    words = ("generate", "--platform", "plain", "-o", workspace, "-m", MODEL, "-c", CONFIG)
    return run(*words, cwd=workspace.parent)


@pytest.mark.parametrize("path", ["{home}/.bashrc", "../../home/.bashrc", "link/.bashrc"])
def test_a_planted_journal_writes_nothing(workspace: Path, tmp_path: Path, path: str) -> None:
    home = tmp_path / "home"
    home.mkdir()
    (workspace / "link").symlink_to(home)
    folder = plant(workspace, [[path.format(home=home), "0", None, None]], n0=b"harm")
    before = files_below(folder)
    for command in (upgrade, generate):
        result = command(workspace)
        assert result.status == 0, result.err
        assert result.err.count(f"{folder} is left alone") == 1
    assert list(home.iterdir()) == []
    assert files_below(folder) == before


@pytest.mark.parametrize("path", ["{home}/known", "../../home/known", "consertb/../../../known"])
def test_a_planted_journal_deletes_nothing(workspace: Path, tmp_path: Path, path: str) -> None:
    known = tmp_path / "home" / "known"
    known.parent.mkdir()
    for file in (known, tmp_path / "known"):
        file.write_bytes(b"of known digest")
    step = [path.format(home=known.parent), None, digest(b"of known digest"), None]
    plant(workspace, [step])
    result = upgrade(workspace)
    assert result.status == 0, result.err
    assert known.read_bytes() == (tmp_path / "known").read_bytes() == b"of known digest"


def test_a_planted_journal_changes_no_file_of_the_workspace(workspace: Path) -> None:
    mine = workspace / "consertb" / "EDDIInput.py"
    before = mine.read_bytes()
    plant(workspace, [["consertb/EDDIInput.py", "0", digest(before), None]], n0=b"harm = 1\n")
    result = upgrade(workspace)
    assert result.status == 0, result.err
    assert mine.read_bytes() == before


@pytest.mark.parametrize("text", ["", "[", "{}", "[[]]", '[["a", "9", null, null, null]]'])
def test_a_damaged_one_stops_nothing(workspace: Path, text: str) -> None:
    folder = plant(workspace, [])
    (folder / "journal.json").write_text(text)
    result = upgrade(workspace)
    assert result.status == 0, result.err
    assert (folder / "journal.json").read_text() == text


def test_staged_texts_are_no_package(workspace: Path) -> None:
    folder = plant(workspace, [])
    (folder / ".copier-answers.yml").write_text("{")
    assert upgrade(workspace).status == 0


def test_many_are_said_in_a_few_lines(workspace: Path) -> None:
    for number in range(8):
        plant(workspace, [], f"{number}\n")
    result = upgrade(workspace)
    assert result.err.count(r"0\n' is left alone: it looks like") == 1
    assert result.err.count("note: ") == 6
    assert "note: 3 more of this kind are left alone\n" in result.err


def test_a_folder_without_journal_is_no_rubbish_of_ours(workspace: Path) -> None:
    folder = workspace / ".eddi-transaction-mine"
    folder.mkdir()
    (folder / "notes.txt").write_text("mine")
    assert upgrade(workspace).err.count(f"{folder} is left alone") == 1
    assert (folder / "notes.txt").read_text() == "mine"


def test_what_looks_like_one_and_is_none_is_left_alone(workspace: Path, tmp_path: Path) -> None:
    elsewhere = plant(tmp_path / "elsewhere", [["a", "0", None, None]], n0=b"harm")
    (workspace / ".eddi-transaction-link").symlink_to(elsewhere)
    (workspace / ".eddi-transaction-file").write_text("no folder")
    os.mkfifo(workspace / ".eddi-transaction-fifo")
    result = upgrade(workspace)
    assert result.status == 0, result.err
    assert result.err.count("is left alone") == 3
    assert (elsewhere / "0").read_bytes() == b"harm"
    assert not (workspace / "a").exists()


# runs of this user, killed ------------------------------------------------------------------------
class Killed(BaseException):
    """The process ends here."""


@pytest.fixture
def killed(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A folder in which a run was killed when all was decided and nothing done."""
    monkeypatch.setenv("XDG_STATE_HOME", str(tmp_path / "state"))
    root = tmp_path / "root"
    apply(root, OLD, {})

    def never(*_: object) -> None:
        raise Killed

    with monkeypatch.context() as patch:
        patch.setattr(transaction, "_finish", never)
        with pytest.raises(Killed):
            apply(root, NEW, OLD)
    return root


def staging(root: Path) -> Path:
    (folder,) = root.glob(".eddi-transaction-*")
    return folder


def record(root: Path) -> Path:
    (file,) = (root.parent / "state").rglob("*.json")
    return file


def test_the_next_run_finishes_it(killed: Path) -> None:
    assert recover(killed) == [f"{killed}: what an interrupted run had begun is finished"]
    assert tree_of(killed) == NEW
    assert not list(killed.glob(".eddi-*"))
    assert not list((killed.parent / "state").rglob("*.json"))
    assert recover(killed) == []


def test_it_is_found_by_another_path_to_the_same_folder(killed: Path) -> None:
    (killed.parent / "link").symlink_to(killed)
    assert recover(killed.parent / "link")
    assert tree_of(killed) == NEW


def test_only_this_user_can_write_a_record(killed: Path) -> None:
    file = record(killed)
    assert file.stat().st_mode & 0o777 == 0o600
    assert file.parent.stat().st_mode & 0o777 == 0o700


def share_the_record(root: Path) -> None:
    record(root).chmod(0o666)


def share_the_folder_of_records(root: Path) -> None:
    record(root).parent.chmod(0o777)


def give_the_record_away(root: Path) -> None:
    os.chown(record(root), 12345, 12345)


def give_the_texts_away(root: Path) -> None:
    os.chown(staging(root), 12345, 12345)


def damage_the_record(root: Path) -> None:
    record(root).write_text(record(root).read_text()[:-9])


def lead_the_record_out(root: Path) -> None:
    file = record(root)
    file.write_text(file.read_text().replace('"d/b"', '"../b"'))


def link_the_record(root: Path) -> None:
    file = record(root)
    file.rename(root.parent / "elsewhere")
    file.symlink_to(root.parent / "elsewhere")


@pytest.mark.parametrize(
    "spoil",
    [
        share_the_record,
        share_the_folder_of_records,
        pytest.param(give_the_record_away, marks=pytest.mark.skipif(os.geteuid() != 0, reason="")),
        pytest.param(give_the_texts_away, marks=pytest.mark.skipif(os.geteuid() != 0, reason="")),
        damage_the_record,
        lead_the_record_out,
        link_the_record,
    ],
)
def test_a_record_that_another_one_may_have_written_is_none(
    killed: Path, spoil: Callable[[Path], None]
) -> None:
    spoil(killed)
    before = tree_of(killed)
    (said,) = recover(killed)
    assert said.startswith(f"{staging(killed)} is left alone")
    assert tree_of(killed) == before


@pytest.mark.parametrize("how", ["moved", "copied"])
def test_a_folder_that_was_moved_is_another_one(killed: Path, how: str) -> None:
    other = killed.parent / "other"
    if how == "moved":
        killed.rename(other)
    else:
        shutil.copytree(killed, other)
    before = tree_of(other)
    (said,) = recover(other)
    assert said.startswith(f"{staging(other)} is left alone")
    assert tree_of(other) == before


@pytest.mark.parametrize("how", ["text", "link"])
def test_new_texts_are_those_that_were_staged(killed: Path, how: str) -> None:
    staged = next(file for file in staging(killed).iterdir() if file.read_bytes() == b"new b")
    if how == "text":
        staged.write_bytes(b"harm")
    else:
        (killed.parent / "new b").write_bytes(b"new b")
        staged.unlink()
        staged.symlink_to(killed.parent / "new b")
    said = recover(killed)
    assert f"{killed / 'd/b'} is left alone: its new text was changed since" in said
    assert tree_of(killed) == {"a": NEW["a"], "d/b": OLD["d/b"]}
    assert not (killed / "d/b").is_symlink()


def test_no_link_is_followed_that_came_meanwhile(killed: Path) -> None:
    (killed / "d").rename(killed.parent / "d")
    (killed / "d").symlink_to(killed.parent / "d")
    said = recover(killed)
    assert f"{killed / 'd/b'} is left alone: a link is in the way" in said
    assert (killed.parent / "d/b").read_bytes() == b"old b"
    assert (killed / "a").read_bytes() == b"new a"


@pytest.mark.parametrize("state", ["a file", "no home"])
def test_without_a_place_for_records_the_change_is_made_all_the_same(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, state: str
) -> None:
    (tmp_path / "file").touch()
    if state == "a file":
        monkeypatch.setenv("XDG_STATE_HOME", str(tmp_path / "file"))
    else:
        monkeypatch.setenv("XDG_STATE_HOME", "")
        monkeypatch.setenv("HOME", "relative")
    (said,) = apply(tmp_path / "root", OLD, {}).notes
    assert said.startswith("killed, this run could not have been finished: no journal at ")
    assert tree_of(tmp_path / "root") == OLD
    assert recover(tmp_path / "root") == []


def test_without_a_place_for_records_upgrade_says_so(
    workspace: Path, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    (tmp_path / "file").touch()
    monkeypatch.setenv("XDG_STATE_HOME", str(tmp_path / "file"))
    (workspace / "consertb" / "README.md").unlink()
    result = upgrade(workspace)
    assert result.status == 0
    assert result.err.count("could not have been finished: no journal at") == 1
    assert (workspace / "consertb" / "README.md").exists()


@pytest.mark.parametrize("words", [["status"], ["upgrade", "--dry-run"], ["regions"]])
def test_who_only_looks_finishes_nothing(
    workspace: Path, words: list[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    def never(*_: object) -> None:
        raise Killed

    monkeypatch.setattr(transaction, "_finish", never)
    with pytest.raises(Killed):
        apply(workspace, {"a": FileState(b"new")}, {})
    monkeypatch.undo()
    before = files_below(workspace)
    place = [workspace] if words == ["regions"] else ["-w", workspace]
    run(*words, *place, cwd=workspace.parent)
    assert files_below(workspace) == before
    assert upgrade(workspace).status == 0
    assert (workspace / "a").read_bytes() == b"new"
