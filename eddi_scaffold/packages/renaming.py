"""Packages that get another name: they move, with everything that a person wrote in them."""

from __future__ import annotations

import os
import re
import shutil
from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path, PurePosixPath

from eddi_scaffold.common.identifiers import package_name
from eddi_scaffold.common.problems import EddiError, Place, problem
from eddi_scaffold.packages.rendering import ANSWERS_FILE
from eddi_scaffold.packages.workspace import existing
from eddi_scaffold.regions.check import list_regions
from eddi_scaffold.regions.package import EDDI, entries, manifest_of, read_file
from eddi_scaffold.regions.sync import Plan


@dataclass(frozen=True)
class Renames:
    """Packages of one command that get other names; all are renamed at once, so names may swap."""

    former: Mapping[str, str]  # new folder -> old folder
    places: Mapping[str, str]  # new folder -> where the package lies, if a run was killed as well

    @property
    def involved(self) -> frozenset[str]:
        """All folders that change."""
        return frozenset([*self.former, *self.former.values(), *self.places.values()])

    @property
    def regions(self) -> dict[str, str]:
        """Regions of other packages that are about these: the new id of each -> the old one."""
        pairs = self.former.items()
        return {f"launcher.include_{new}": f"launcher.include_{old}" for new, old in pairs}

    def place(self, root: Path, folder: str) -> Path:
        """Return where the package is that gets a folder."""
        # one of the old name that is made anew begins with nothing
        leaves = folder in self.places.values() and folder not in self.places
        return root / (f".{folder}" if leaves else self.places.get(folder, folder))

    def move(self, root: Path, *, back: bool = False) -> None:
        """Give all folders their new names, or take that back.

        Raises:
            EddiError: something was written meanwhile into one that makes room (G025).
        """
        left = {new: old for new, old in self.places.items() if new != old}
        left = {old: new for new, old in left.items()} if back else left
        while left:
            new = next((one for one in left if one not in left.values()), None)
            if new is not None:
                _check_room(root / new)
                shutil.rmtree(root / new, ignore_errors=True)  # what was made is made again
                (root / left.pop(new)).rename(root / new)
                continue
            new = next(iter(left))  # names in a circle: one steps aside
            (root / new).rename(root / aside(new))
            left = {one: aside(new) if old == new else old for one, old in left.items()}

    def move_inside(self, root: Path) -> None:
        """Move a person's files out of folders of generated files that have the old name."""
        for folder, old in self.former.items():
            files = manifest_of(root / folder).files
            made = {str(parent) for name in files for parent in PurePosixPath(name).parents}
            for name in list(_names(root / folder)):
                parts = name.split("/")
                renamed = [folder if part == old else part for part in parts]
                new = root / folder / "/".join(renamed)
                last = max((at for at, part in enumerate(parts[:-1]) if part == old), default=None)
                if last is None or "/".join(renamed[: last + 1]) not in made or parts[0] == EDDI:
                    continue
                if os.path.lexists(new):
                    continue
                new.parent.mkdir(parents=True, exist_ok=True)
                (root / folder / name).rename(new)

    def notes(self, plans: Mapping[str, Plan]) -> list[str]:
        """Return what is to be said of packages that have moved."""
        return [
            f"{old} is called {new} now; all in it moved along"
            for new, old in self.former.items()
            if new in plans
        ]

    def mentions(self, root: Path, plans: Mapping[str, Plan]) -> list[str]:
        """Return where a person's lines still have the old name of a package that has moved."""
        moved = ((new, old) for new, old in self.former.items() if new in plans)
        return [line for new, old in moved for line in _mentions(root / new, old)]


NO_RENAMES = Renames({}, {})


def aside(folder: str) -> str:
    """Return where a package waits for its new name, while names go round in a circle."""
    return f".{folder}.renamed"


def _names(package: Path) -> Iterator[str]:
    return (name for name, kind in entries(package, {".git"}) if kind is None)


def _mentions(package: Path, old: str) -> Iterator[str]:
    """Report the lines of a person that still have the old name of the package in them."""
    word = re.compile(rf"(?<![\w/~]){re.escape(old)}(?![\w/])")
    generated = manifest_of(package).files
    for name in sorted(_names(package)):
        if name.startswith((ANSWERS_FILE, f"{EDDI}/")):
            continue
        file = read_file(package, name)
        if file is None:
            continue
        texts = [region.body for region in file.sides[0].regions.values()]
        if any(word.search(text) for text in (texts if name in generated else [file.text])):
            yield f"{package.name}/{name}: the name {old!r} of the package is still in it"


def read_renames(words: Sequence[str], root: Path, made: Collection[str]) -> Renames:
    """Read ``OLD=NEW``: ids of models, or names of packages.

    Args:
        words: as given.
        root: folder of all packages.
        made: the packages that the command makes.

    Raises:
        EddiError: one of them cannot be made (G025).
    """
    former: dict[str, str] = {}
    places: dict[str, str] = {}
    present = existing(root, made) if words else {}
    # a package knows its name: it tells how far a run came that moved several, and was killed
    names = {folder: answers.get("package") for folder, answers in present.items()}
    for word in words:
        old, new = (package_name(part) for part in word.partition("=")[::2])
        if not (old and new):
            raise _refused(f"{word!r} is not OLD=NEW", "--rename ConSertA=ConSertB")
        there = (folder for folder in (new, old, aside(old)) if names.get(folder) == old)
        place = next(there, new if new in present else None)
        if place is None:
            known = ", ".join(sorted(present)) or "none"
            raise _refused(f"there is no package {old!r} to rename", f"there are: {known}", root)
        if new not in made:
            hint = "give the model of the new name, and its configuration"
            raise _refused(f"this command makes no package {new!r}", hint)
        if old == new or new in former or old in former.values():
            raise _refused(f"{word!r} renames a package twice, or not at all", "give each once")
        former[new], places[new] = old, place
    for new, place in places.items():
        _check_movable(root / place)
        if place != new and new not in places.values():
            _check_room(root / new)
    return Renames(former, places)


def _check_room(package: Path) -> None:
    """Refuse to put a package where something is by hand.

    Raises:
        EddiError: that is so (G025).
    """
    made = {*manifest_of(package).files, ANSWERS_FILE}
    own = (name for name, _ in entries(package) if name not in made)
    is_as_made = all(name.startswith(f"{EDDI}/") for name in own) and all(
        region.state == "untouched" for region in list_regions(package)
    )
    if not is_as_made:
        message = f"{package.name!r} is there already, and something in it was written by hand"
        hint = "move what you need of it away, remove the folder, and run this again"
        raise _refused(message, hint, package)


def _refused(message: str, hint: str, place: Path | None = None) -> EddiError:
    where = Place(str(place) if place is not None else "")
    return EddiError(problem("G025.rename", where, hint=hint, message=message))


def _check_movable(package: Path) -> None:
    """Refuse a package with what no new text can be written for: links, repositories.

    Raises:
        EddiError: it has such an entry (G025).
    """
    if os.path.lexists(package / ".git"):
        message = "'.git' cannot move along: the package is a repository of its own"
        hint = (
            "move '.git' away, run this again, and move it into the new folder; of a submodule,"
            " write the new path into .gitmodules and into the core.worktree of its repository"
        )
        raise _refused(message, hint, package)
