"""Branches of a real package, merged by git with and without our driver, by any choice of side."""

from __future__ import annotations

import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from eddi_scaffold.identifiers import attribute
from tests.updates.inputs import Element, elements
from tests.updates.templates import Templates, git
from tests.updates.world import World, snapshot

pytestmark = pytest.mark.slow

START = elements("alpha", "beta", "gamma")
CHANGES = {
    "model": ((*START, Element("delta")), 0),
    "renamed": ((START[0], Element("bravo", was="beta"), START[2]), 0),
    "template": (START, 1),
    "both": ((Element("new"), *START), 1),
}
_COMMENT = 3
"""A shape of an edit that needs no look."""
DRIVER = f"{sys.executable} -m eddi_scaffold merge-driver %O %A %B %P"


@pytest.fixture
def world(templates: Templates, folder: Path) -> World:
    """A package with the branches `main` and `side`."""
    world = World(folder, templates, "plain", START)
    git(world.workspace, "checkout", "-q", "-B", "main")
    assert world.generate().status == 0
    world.settle()
    world.commit()
    git(world.workspace, "branch", "side")
    return world


def diverge(world: World, change: str, other: str | None = None) -> None:
    """Write by hand on `side`; change the model or the template, and write by hand, on `main`.

    ``other`` is a change on `side`.
    """
    git(world.workspace, "checkout", "-q", "side")
    if other is not None:
        world.change(*CHANGES[other][0])
        assert world.generate().status == 0
    world.edit("alpha", _COMMENT)
    for kind in ("import", "init", "helper"):
        assert world.edit_outside(kind)
    world.commit()
    git(world.workspace, "checkout", "-q", "main")
    inputs, versions = CHANGES[change]
    world.change(*inputs)
    world.version += versions
    assert world.generate().status == 0
    world.edit("gamma", _COMMENT)
    assert world.edit_outside("docstring")
    world.commit()


def merge(world: World, *options: str) -> bool:
    """Merge `side` into `main`; returns whether git found no conflict."""
    words = ["git", "merge", "-q", "--no-edit", *options, "side"]
    return subprocess.run(words, cwd=world.workspace, check=False).returncode == 0


def updated(world: World) -> bool:
    """Return whether `processing` updates each input of the model, and no other."""
    lines = world.text().partition("    def processing(")[2]
    called = re.findall(r"self\.process_(\w+)", lines)
    return sorted(called) == sorted(attribute(one.name) for one in world.inputs)


@pytest.mark.parametrize("change", CHANGES)
def test_with_the_driver_every_line_is_in_its_place(world: World, change: str) -> None:
    diverge(world, change)
    git(world.workspace, "config", "merge.eddi-scaffold.driver", DRIVER)
    assert merge(world)
    assert updated(world)
    world.settle()
    world.check()
    assert world.command("regions", "--check", world.package).status == 0
    before = world.text()
    assert world.generate().status == 0
    assert world.text() == before


@pytest.mark.parametrize("change", CHANGES)
@pytest.mark.parametrize("choice", ["ours", "theirs", "-Xours", "-Xtheirs", "union"])
def test_without_it_what_does_not_fit_is_said(world: World, change: str, choice: str) -> None:
    diverge(world, change)
    if choice == "union":
        file = f"{world.package.relative_to(world.workspace)}/{world.main}"
        attributes = world.workspace / ".git/info/attributes"
        attributes.parent.mkdir(exist_ok=True)
        attributes.write_text(f"{file} merge=union\n")
    clean = merge(world, *([choice] if choice.startswith("-X") else []))
    if not clean:
        assert world.command("regions", "--check", world.package).status == 3
        assert choice in {"ours", "theirs"}
        git(world.package, "checkout", f"--{choice}", world.main)
        world.commit()
    check = world.command("regions", "--check", world.package)
    if check.status == 0:
        assert updated(world), world.text()
    else:
        assert check.status == 3
        if world.generate().status == 0:  # what was missing is back
            assert updated(world)
            assert world.command("regions", "--check", world.package).status == 0


def test_what_is_said_to_do_puts_it_right(world: World) -> None:
    diverge(world, "model")
    assert not merge(world)
    git(world.package, "checkout", "--theirs", world.main)
    world.commit()
    shutil.copytree(world.package, copy := world.folder / "accepted" / "rover")
    file = copy / world.main
    assert world.command("regions", "--check", copy.parent).status == 3
    assert world.command("regions", "--check", "--accept", file, copy.parent).status == 0
    assert "U004" in world.command("regions", "--accept", file, copy.parent).words
    said = world.command("regions", "--check", world.package).words
    (cure,) = re.findall(r"run '(git checkout .*?)'", said)
    subprocess.run(cure.split(), cwd=world.package, check=True)
    assert world.upgrade().status == 0
    assert updated(world)
    assert world.command("regions", "--check", world.package).status == 0


def generate_what_both_changed(world: World) -> None:
    world.change(START[0], Element("bravo", was="beta"), START[2], Element("delta"))
    assert world.command("regions", "--check", world.package).status == 3
    assert world.generate().status == 0
    world.settle()
    world.check()
    assert updated(world)
    assert not list(world.package.glob(".eddi/rejects/*"))
    assert world.command("regions", "--check", world.package).status == 0


def test_what_both_branches_generated_is_generated_again(world: World) -> None:
    diverge(world, "model", "renamed")
    git(world.workspace, "config", "merge.eddi-scaffold.driver", DRIVER)
    assert not merge(world)
    assert b"<<<<<<<" not in b"".join(snapshot(world.package).values())
    generate_what_both_changed(world)


def test_records_in_conflict_do_not_make_generated_text_a_persons(world: World) -> None:
    """Without the driver git leaves its markers in the manifest."""
    diverge(world, "renamed", "model")
    assert not merge(world)
    conflicts = git(world.workspace, "diff", "--name-only", "--diff-filter=U")
    assert ".eddi/manifest.json" in conflicts
    git(world.package, "checkout", "--ours", world.main)
    for token in [token for token in world.lines if token not in world.text()]:
        del world.lines[token]  # the person's choice
    generate_what_both_changed(world)


def test_plain_update_after_the_merge(world: World) -> None:
    diverge(world, "both")
    git(world.workspace, "config", "merge.eddi-scaffold.driver", DRIVER)
    assert merge(world)
    world.version += 1
    assert world.update().status == 0
    world.settle()
    world.check()
    assert updated(world)
    assert "unfit" not in world.command("regions", world.package).words


def test_plain_update_of_renderings_of_two_branches_waits_for_one(
    world: World, capfd: pytest.CaptureFixture[str]
) -> None:
    """Copier would undo in the new rendering what it misses in the merged one, without a word."""
    diverge(world, "template", "renamed")
    git(world.workspace, "config", "merge.eddi-scaffold.driver", DRIVER)
    assert not merge(world)
    for name in git(world.workspace, "diff", "--name-only", "--diff-filter=U").split():
        git(world.workspace, "checkout", "--ours", name)
    for token in [token for token in world.lines if token not in world.text()]:
        del world.lines[token]  # the person's choice
    world.commit()
    world.change(*CHANGES["renamed"][0])
    assert world.command("regions", "--check", world.package).status == 3
    before = snapshot(world.package)
    assert world.update().status == 1
    assert snapshot(world.package) == before
    assert "`copier recopy --trust --force`" in capfd.readouterr().err
    for operation in (world.recopy, world.update):
        assert operation().status == 0
        world.settle()
        world.check()
        assert updated(world)
        assert "unfit" not in world.command("regions", world.package).words
        world.version += 1
