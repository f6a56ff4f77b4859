"""A package that is a submodule, or lies in a linked worktree: its ``.git`` is a file."""

from __future__ import annotations

import shutil
from functools import partial
from pathlib import Path

import pytest

from eddi_scaffold.regions.git import committed_text
from eddi_scaffold.regions.store import load_orphans
from eddi_scaffold.regions.sync import sync_package
from tests.updates.templates import Templates, git
from tests.updates.world import CHANGED, World, edited_world, operations_of, snapshot

pytestmark = pytest.mark.slow

OWN = {
    ".clang-format": "BasedOnStyle: Google\n",
    ".vscode/settings.json": "{}\n",
    ".env": "ROS_MASTER_URI=here\n",
    "test/.own": "mine\n",
}


@pytest.fixture
def world(templates: Templates, folder: Path) -> World:
    world = edited_world(templates, folder)
    for name, text in OWN.items():
        (world.package / name).parent.mkdir(exist_ok=True)
        (world.package / name).write_text(text)
    world.commit()
    return world


def make_submodule(world: World) -> None:
    alone = world.folder / "alone"
    world.package.rename(alone)
    git(alone, "init", "-q")
    git(alone, "add", "-A")
    git(alone, "commit", "-q", "-m", "start")
    git(world.workspace, "rm", "-rq", "--cached", "rover")
    allowed = ("-c", "protocol.file.allow=always")
    git(world.workspace, *allowed, "submodule", "add", "-q", str(alone), "rover")
    world.commit()


def make_worktree(world: World) -> None:
    bare = world.folder / "main"
    world.workspace.rename(bare)
    git(bare, "worktree", "add", "-q", "-b", "work", str(world.workspace))


def make_package_a_worktree(world: World) -> None:
    """The package is a repository, of which one more branch is checked out in the workspace."""
    alone = world.folder / "alone"
    world.package.rename(alone)
    git(alone, "init", "-q")
    git(alone, "add", "-A")
    git(alone, "commit", "-q", "-m", "start")
    git(alone, "worktree", "add", "-q", "-b", "work", str(world.package))


KINDS = {
    "submodule": make_submodule,
    "worktree": make_worktree,
    "package worktree": make_package_a_worktree,
}


@pytest.mark.parametrize(
    ("kind", "operation"), [(k, one) for n, k in enumerate(KINDS) for one in operations_of(n)]
)
def test_git_and_dot_files_stay(world: World, kind: str, operation: str) -> None:
    KINDS[kind](world)
    entry = (world.workspace if kind == "worktree" else world.package) / ".git"
    before = entry.read_text()
    assert before.startswith("gitdir: ")
    world.change(*CHANGED)
    world.version += 1
    if kind != "worktree":
        git(world.package, "add", "-A")
        git(world.package, "commit", "-q", "--allow-empty", "-m", "work")
    result = getattr(world, operation)()
    assert result.status in {0, 3}, result
    world.settle()
    world.check()
    assert entry.read_text() == before
    assert git(world.package, "rev-parse", "HEAD")
    assert {name: (world.package / name).read_text() for name in OWN} == OWN


@pytest.mark.parametrize("kind", KINDS)
def test_a_file_that_copier_removed_is_read_from_that_repository(world: World, kind: str) -> None:
    KINDS[kind](world)
    (world.package / world.main).unlink()
    (world.package / ".eddi/pristine").mkdir()  # rendered without that file
    sync_package(world.package, partial(committed_text, world.package))
    saved = "".join(orphan.body for orphan in load_orphans(world.package).values())
    assert all(saved.count(line.token) == 1 for line in world.lines.values())


@pytest.mark.parametrize("operation", ["generate", "upgrade"])
def test_a_git_file_that_leads_nowhere_stays(world: World, operation: str) -> None:
    shutil.rmtree(world.workspace / ".git")
    (world.package / ".git").write_text("gitdir: ../gone\n")
    world.change(*CHANGED)
    assert getattr(world, operation)().status in {0, 3}
    world.settle()
    world.check()
    assert snapshot(world.package)[".git"] == b"gitdir: ../gone\n"
