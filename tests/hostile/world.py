"""A really generated workspace with all that is around it, for hostile files to be put in."""

from __future__ import annotations

import shutil
from dataclasses import dataclass
from pathlib import Path

from tests.adopting.old_packages import write_old_ros_package
from tests.cli.command import ROOT, example, run
from tests.hostile.watch import Seen, look


@dataclass(frozen=True)
class World:
    """One folder that holds all that a command could reach."""

    folder: Path

    @property
    def home(self) -> Path:  # the person's home folder
        return self.folder / "home"

    @property
    def precious(self) -> Path:  # a file of the person's that no workspace has a right to
        return self.folder / "outside" / "precious.txt"

    @property
    def scratch(self) -> Path:  # where temporary folders are made, beside another precious file
        return self.folder / "tmp"

    @property
    def mark(self) -> Path:  # what a command out of a package makes when it runs
        return self.folder / "outside" / "MARK"

    @property
    def work(self) -> Path:  # the workspace that others made: the person's working directory
        return self.folder / "work"

    @property
    def package(self) -> Path:  # the generated package in it
        return self.work / "packages" / "conserta"

    @property
    def eddi(self) -> Path:  # the records of the package
        return self.package / ".eddi"

    def look(self) -> dict[str, Seen]:
        """Return all that must stay; in the folder of temporary ones, names come and go."""
        return {path: seen for path, seen in look(self.folder).items() if path != "tmp"}

    def copy(self, folder: Path) -> World:
        """Return another one that is the same."""
        shutil.copytree(self.folder, folder, symlinks=True)
        return World(folder)


def build(folder: Path) -> World:
    """Make a world in which nobody wants any harm."""
    world = World(folder)
    for path in (world.home, world.precious.parent, world.scratch, world.work):
        path.mkdir(parents=True)
    for path in (world.precious, world.scratch / "precious.txt"):
        path.write_text("precious\n")
    example(world.work)
    for name in ("Rover.yml", "rover.rossystem", "eddi_config.yml", "nodes"):
        source = ROOT / "examples" / "robot-models" / name
        (shutil.copytree if source.is_dir() else shutil.copy)(source, world.work / name)
    for name in ("deployment.yml", "arm.yml", "arm_config.yml", "cart.yml", "cart_config.yml"):
        shutil.copy(ROOT / "examples" / "two-robots" / name, world.work / name)
    _run(world, "export", "two_conserts.xml", "--name", "ConSertA", "-o", "yml")
    write_old_ros_package(world.work / "old", (world.work / "yml/ConSertA.yml").read_text("utf-8"))
    files = ("-m", "two_conserts.xml", "-c", "consert_a_config.yml")
    _run(world, "generate", "--platform", "plain", "-o", "packages", *files)
    return world


def _run(world: World, *words: str) -> None:
    result = run(*words, cwd=world.work)
    assert result.status == 0, result.err
