"""Two branches of a package: what a merge with git's own means leaves, and what tells of it."""

from __future__ import annotations

import subprocess
from pathlib import Path

import pytest

from eddi_scaffold.regions.check import RegionStatus, accept, list_regions
from eddi_scaffold.regions.store import write_file
from eddi_scaffold.regions.sync import sync_package
from tests.regions.rendering import INPUT, Package, elements, render
from tests.regions.test_sync import body, git, write_hand

A, B, C, D = elements("a", "b", "c", "d")
IMPORT = "from eddi_runtime import EDDIInputBase\n"


def unfit(root: Path) -> list[RegionStatus]:
    return [one for one in list_regions(root) if one.state == "unfit"]


def generate(root: Path, package: Package) -> None:
    render(root, package)
    assert not sync_package(root).refused


def commit(root: Path, message: str = "work") -> None:
    git(root, "add", "-A", ".")
    git(root, "commit", "-qm", message)


@pytest.fixture
def root(tmp_path: Path) -> Path:
    """A package in version 1 on two branches, of which `side` has edits outside of regions."""
    root = tmp_path / "work" / "pkg"
    write_file(root, ".eddi/.gitignore", b"")  # a template that has the renderings in git
    generate(root, Package((A, B)))
    git(root.parent, "init", "-q", "-b", "main")
    commit(root)
    git(root, "checkout", "-qb", "side")
    write_hand(root, "input:a", "self.a = 'by hand'")
    text = (root / INPUT).read_text()
    text = text.replace(
        "        super().__init__()\n", "        super().__init__()\n        self.x = 1\n"
    )
    (root / INPUT).write_text(text.replace(IMPORT, f"{IMPORT}import by_hand\n"))
    commit(root)
    git(root, "checkout", "-q", "main")
    return root


def merge(root: Path, side: str) -> None:
    """Merge, and take the conflicting editable file from one side as a whole."""
    words = ["git", "-c", "user.name=T", "-c", "user.email=t@example.org", "merge", "-q", "side"]
    done = subprocess.run(words, cwd=root, capture_output=True, check=False)
    if done.returncode:
        assert [one.state for one in list_regions(root)].count("broken") >= 1
        git(root, "checkout", f"--{side}", INPUT)
        commit(root)


@pytest.mark.parametrize("changed", [Package((A, B, C)), Package((A, B), 3)])
@pytest.mark.parametrize("side", ["ours", "theirs"])
def test_a_file_of_one_side_with_the_base_of_the_other_is_seen(
    root: Path, side: str, changed: Package
) -> None:
    generate(root, changed)
    text = (root / INPUT).read_text()
    (root / INPUT).write_text(text.replace("super().__init__()\n", "super().__init__()  # mine\n"))
    commit(root)
    merge(root, side)
    found = unfit(root)
    if side == "ours":
        assert not found
        return
    assert [one.file for one in found] == [INPUT]
    assert found[0].review
    cure = found[0].notes[-1]
    assert "git checkout" in cure
    git(root, *cure.split("git ")[1].split("'")[0].split())
    generate(root, changed)
    text = (root / INPUT).read_text()
    assert not unfit(root)
    assert "import by_hand" in text
    assert body(root, "input:a") == "self.a = 'by hand'"
    assert text.count("self.process_c,") == (C in changed.elements)


def test_without_history_a_missing_input_is_seen(root: Path, tmp_path: Path) -> None:
    old = (root / INPUT).read_text()
    generate(root, Package((A, B, C)))
    (root / INPUT).write_text(old)
    subprocess.run(["rm", "-r", str(root.parent / ".git")], check=True)
    (found,) = unfit(root)
    assert "region 'input:c' of the newest rendering is not in the file" in found.notes
    assert "'process_c' is called by the newest rendering" in found.notes[-1]


@pytest.mark.parametrize("changed", [Package((A, B, C)), Package((A, B), 3)])
def test_a_file_that_was_resolved_by_hand_is_accepted_until_its_base_changes(
    root: Path, changed: Package
) -> None:
    generate(root, changed)
    commit(root)
    git(root, "checkout", "side", "--", INPUT)
    assert unfit(root)
    assert accept(root, [INPUT, "other.py"]) == (INPUT,)
    assert not unfit(root)
    assert accept(root, [INPUT]) == ()
    write_hand(root, "input:b", "self.b = 'by hand'")
    assert not unfit(root)
    text = (root / INPUT).read_text()
    (root / INPUT).write_text(text.replace("self.process_b,", "None,"))
    assert "'process_b' is called" in " ".join(unfit(root)[0].notes)  # nobody accepted that
    (root / INPUT).write_text(text)
    generate(root, changed)
    assert not unfit(root)
    generate(root, Package((A, B, C, D), 3))
    assert not (root / ".eddi/accepted").exists()


def test_hand_edits_are_no_misfits(root: Path) -> None:
    git(root, "checkout", "-q", "side")
    assert not unfit(root)
    generate(root, Package((A, B, C), 2))
    commit(root)
    text = (root / INPUT).read_text()
    for old, new in (
        ("from eddi_runtime import by_id\n", ""),  # one line of the newest version
        ("super().__init__()", "super().__init__()  # mine"),
        ("self.b = False", "self.b = True"),
        ("    def processing(", "    def own(self):\n        return 1\n\n    def processing("),
        ("self.update('b', self.process_b,", "self.update('b', lambda m: self.process_b(m),"),
    ):
        assert old in text
        text = text.replace(old, new)
    (root / INPUT).write_text(text)
    assert not unfit(root)


def test_records_of_two_renderings_are_seen(root: Path) -> None:
    pristine = root / ".eddi/pristine" / INPUT
    text = pristine.read_text()
    pristine.write_text(text.replace("monitor", "other"))
    assert "has not been merged" in unfit(root)[0].notes[0]
    pristine.write_text(text[:-10])
    assert "not whole" in unfit(root)[0].notes[0]
