"""Packages in which git would start a command of theirs when it is asked what was committed.

The command stands in the configuration of a repository. An object that is not there is fetched from
where that configuration says, with the program that it says (a partial clone).
"""

from __future__ import annotations

import shutil
from collections.abc import Callable
from pathlib import Path

from tests.checkouts import git
from tests.data_files import data_text
from tests.hostile.world import World

EDITED = "README.md"
"""A generated file that is not as it was made: git is asked whether a merge made it."""
SHA = "1234567890" * 4
CONFIG = data_text("hostile/git_config.txt")


def bare_look_alike(world: World) -> None:
    """Plain files, which survive a clone: the package's folder looks like a bare repository."""
    _edit(world)
    _look_alike(world, world.package)
    with (world.package / "config").open("a") as file:
        file.write("[core]\n\tworktree = .\n")  # without it git knows no names that begin with ./


def named_look_alike(world: World) -> None:
    """The same elsewhere in the package, named by a ``.git`` file: an archive can hold one."""
    _edit(world)
    _look_alike(world, world.package / "data")
    (world.package / ".git").write_text("gitdir: data\n")


def real_repository(world: World) -> None:
    """An archive of a workspace, with ``.git``."""
    _real(world, str(world.work))


def real_repository_by_ssh(world: World) -> None:
    """The same with another way to fetch."""
    _real(world, "ssh://nobody@localhost/")


def repository_that_names_an_object_of_nobody(world: World) -> None:
    """A repository whose ``HEAD`` is in no store: the commit itself would be fetched."""
    _edit(world)
    _look_alike(world, world.work / ".git")


BUILDERS: tuple[Callable[[World], None], ...] = (
    bare_look_alike,
    named_look_alike,
    real_repository,
)
OTHERS: tuple[Callable[[World], None], ...] = (
    real_repository_by_ssh,
    repository_that_names_an_object_of_nobody,
)
"""More of the same kind, for tests of what reads a repository."""


def _edit(world: World) -> None:
    with (world.package / EDITED).open("a") as file:
        file.write("edited\n")


def _look_alike(world: World, folder: Path) -> None:
    for name in ("objects", "refs"):
        (folder / name).mkdir(parents=True)
        (folder / name / "keep").touch()
    (folder / "HEAD").write_text(f"{SHA}\n")
    _configure(world, folder, str(world.work))


def _real(world: World, url: str) -> None:
    git(world.work, "init", "--quiet", "--initial-branch=main")
    git(world.work, "add", "--all")
    git(world.work, "commit", "--quiet", "--message", "All")
    name = git(world.work, "rev-parse", "HEAD:packages/conserta/.eddi/manifest").strip()
    objects = world.work / ".git" / "objects"
    (objects / name[:2] / name[2:]).unlink()
    _edit(world)
    shutil.rmtree(world.work / ".git" / "hooks", ignore_errors=True)
    _configure(world, world.work / ".git", url)


def _configure(world: World, git_dir: Path, url: str) -> None:
    (git_dir / "config").write_text(CONFIG.format(mark=world.mark, url=url))
