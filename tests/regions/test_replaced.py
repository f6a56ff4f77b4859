"""A replacement over many files, records too: what a person wrote by it is kept when it goes."""

from __future__ import annotations

import json
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import pytest

from eddi_scaffold.regions import __main__ as command
from eddi_scaffold.regions.bases import read_bases, write_bases
from eddi_scaffold.regions.check import list_regions
from eddi_scaffold.regions.sync import SyncReport, sync_package
from tests.regions.rendering import INPUT, NETWORK, Package, elements, render, snapshot
from tests.regions.test_sync import git

A, B, C = elements("a", "b", "c")
COPY = f".eddi/rejects/{INPUT}.edited"
BODY = ("self.a = message.data", "self.a = message.data * 1000")
OUTSIDE = ("super().__init__()", "super().__init__(unit='mm')")
NAME = ("EDDIInput", "Inputs")  # in the record as well
ONLY_CASE = ("message.data", "message.DATA")


@pytest.fixture
def root(tmp_path: Path) -> Path:
    root = tmp_path / "work" / "pkg"
    render(root, Package((A, B)))
    assert sync_package(root) == SyncReport()
    return root


def replace_all(root: Path, old: str, new: str) -> None:
    for path in root.rglob("*"):
        if path.is_file():
            path.write_bytes(path.read_bytes().replace(old.encode(), new.encode()))


def in_doubt(root: Path) -> list[str]:
    return [one.file for one in list_regions(root) if "not what was recorded" in str(one.notes)]


NEXT = {
    "nothing new": Package((A, B)),
    "another model": Package((C, B)),
    "another template": Package((A, B), 3),
    "file gone": Package((A, B), 1, (NETWORK,)),
}


@pytest.mark.parametrize("package", NEXT.values(), ids=NEXT)
@pytest.mark.parametrize("change", [BODY, OUTSIDE, NAME, ONLY_CASE])
def test_what_goes_is_kept_and_told(root: Path, package: Package, change: tuple[str, str]) -> None:
    replace_all(root, *change)
    assert in_doubt(root) == [INPUT]
    mine = (root / INPUT).read_text()
    render(root, package)
    report = sync_package(root)
    assert (root / COPY).read_text() == mine
    assert [(n.file, n.attention) for n in report.notes if COPY in n.text] == [(INPUT, True)]
    assert not in_doubt(root)
    before = snapshot(root)
    assert sync_package(root) == SyncReport()
    assert snapshot(root) == before


def test_where_nothing_goes_there_is_no_copy(root: Path) -> None:
    bases = read_bases(root)
    write_bases(root, {**bases, INPUT: bases[INPUT].replace(*BODY)})
    assert in_doubt(root) == [INPUT]
    assert not sync_package(root).notes, "there is no rendering"
    assert in_doubt(root) == [INPUT]
    render(root, Package((A, B)))
    assert not sync_package(root).notes
    assert not in_doubt(root)
    assert not (root / ".eddi/rejects").exists()


def formatted(root: Path) -> None:
    words = [sys.executable, "-m", "ruff", "format", "--isolated", "-q", "--line-length", "40"]
    subprocess.run([*words, str(root), str(root / ".eddi")], check=True)


def without_record(root: Path) -> None:
    place = root / ".eddi/manifest.json"
    place.write_text(json.dumps({**json.loads(place.read_text()), "base": {}}))
    replace_all(root, *OUTSIDE)


HARMLESS: dict[str, Callable[[Path], None]] = {
    "formatter": formatted,
    "line ends": lambda root: replace_all(root, "\n", "\r\n"),
    "made before there was a record": without_record,
    "record lost": lambda root: (root / ".eddi/manifest.json").unlink(),
    "records put back by git": lambda root: git(root, "checkout", "--", ".eddi"),
}


@pytest.mark.parametrize("harmless", HARMLESS.values(), ids=HARMLESS)
def test_what_is_no_replacement_gives_no_alarm(
    root: Path, harmless: Callable[[Path], None]
) -> None:
    git(root.parent, "init", "-q")
    git(root, "add", "-A", ".")
    git(root, "commit", "-qm", "work")
    before = snapshot(root)
    harmless(root)
    assert (snapshot(root) == before) == (harmless is HARMLESS["records put back by git"])
    assert not in_doubt(root)
    render(root, Package((A, B, C), 2))
    assert not any("recorded" in note.text for note in sync_package(root).notes)
    assert not list((root / ".eddi").glob("rejects/**/*.edited"))


def test_damaged_file_stays_in_doubt_until_it_is_whole(root: Path) -> None:
    replace_all(root, *OUTSIDE)
    whole = (root / INPUT).read_text()
    (root / INPUT).write_text(whole.replace("Manual edit end", "Manual Edit", 1))
    render(root, Package((A, B), 3))
    assert sync_package(root).refused
    assert not (root / COPY).exists()
    (root / INPUT).write_text(whole)
    sync_package(root)
    assert (root / COPY).read_text() == whole


def test_update_does_not_begin(root: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """Copier would take the changed rendering for the old one with a person's edits."""
    (root / ".copier-answers.yml").write_text("a: 1\n")
    (root / ".eddi/bases").unlink()
    render(root, Package((A, B)))
    sync_package(root)
    git(root.parent, "init", "-q")
    replace_all(root, *ONLY_CASE)
    git(root, "add", "-A", ".")
    git(root, "commit", "-qm", "work")
    before = snapshot(root)
    assert command.main(["check"], root) == 1
    assert snapshot(root) == before
    assert "changed by hand" in capsys.readouterr().err
