"""Packages that get another name: they move, with everything that a person wrote in them.

A model that is renamed leaves its old package behind: that is reported, a person declares it.
"""

from __future__ import annotations

import os
import shutil
from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from eddi_scaffold.common.identifiers import package_name
from eddi_scaffold.common.problems import EddiError, Place, problem
from eddi_scaffold.monitors.binding import BoundMonitor
from eddi_scaffold.monitors.loading import read_models
from eddi_scaffold.packages.rendering import ANSWERS_FILE
from eddi_scaffold.packages.workspace import existing, model_id
from eddi_scaffold.platforms import PackageAnswers
from eddi_scaffold.regions.check import list_regions
from eddi_scaffold.regions.package import EDDI, entries, manifest_of


@dataclass(frozen=True)
class Renames:
    """Packages of one command that get other names."""

    former: Mapping[str, str]  # new folder -> old folder
    places: Mapping[str, str]  # new folder -> where the package lies, if a run was killed as well

    def place(self, root: Path, folder: str) -> Path:
        """Return where the package is that gets a folder."""
        if folder in self.places.values() and folder not in self.places:
            return root / f".{folder}"  # one of the old name that is made anew begins with nothing
        return root / self.places.get(folder, folder)

    def move(self, root: Path, *, back: bool = False) -> None:
        """Give all folders their new names, or take that back (EddiError, G025: no room)."""
        moves = [(root / place, root / new) for new, place in self.places.items() if place != new]
        for _, new in moves if not back else ():
            _check_room(new)
        for old, new in moves:
            if back:
                new.rename(old)
            else:
                shutil.rmtree(new, ignore_errors=True)  # what was made is made again
                old.rename(new)

    def move_inside(self, root: Path) -> None:
        """Move a person's files out of folders of generated modules that have the old name."""
        for folder, old in self.former.items():
            for above in (root / folder, root / folder / "src"):
                for file in sorted((above / old).rglob("*")) if (above / folder).is_dir() else ():
                    new = above / folder / file.relative_to(above / old)
                    if file.is_file() and not os.path.lexists(new):
                        new.parent.mkdir(parents=True, exist_ok=True)
                        file.rename(new)


NO_RENAMES = Renames({}, {})


def read_renames(words: Sequence[str], root: Path, made: Collection[str]) -> Renames:
    """Read ``OLD=NEW``, ids of models or names of packages, of which a command makes some.

    Raises:
        EddiError: one of them cannot be made (G025).
    """
    former: dict[str, str] = {}
    places: dict[str, str] = {}
    present = existing(root, made) if words else {}
    for rename in words:
        old, new = (package_name(part) for part in rename.partition("=")[::2])
        if not (old and new):
            raise _refused(f"{rename!r} is not OLD=NEW")
        if not {old, new}.isdisjoint([*former, *former.values()]) or old == new:
            raise _refused(f"{rename!r} renames a package twice, or not at all")
        # a package knows its name: a run may have been killed when it had moved
        has_moved = present.get(new, {}).get("package") == old or old not in present
        if has_moved and new not in present:
            raise _refused(f"there is no package {old!r} to rename", root)
        if new not in made:
            raise _refused(f"this command makes no package {new!r}")
        former[new], places[new] = old, new if has_moved else old
    for new, place in places.items():
        if place != new:
            _check_room(root / new)
    return Renames(former, places)


def _check_room(package: Path) -> None:
    """Refuse to put a package where something is by hand (EddiError, G025)."""
    made = {*manifest_of(package).files, ANSWERS_FILE}
    own = [
        name for name, _ in entries(package) if not (name in made or name.startswith(f"{EDDI}/"))
    ]
    if own or any(region.state != "untouched" for region in list_regions(package)):
        message = f"{package.name!r} is there already, and something in it was written by hand"
        raise _refused(message, package)


def _refused(message: str, place: Path | None = None) -> EddiError:
    where = Place(str(place) if place is not None else "")
    return EddiError(problem("G025.rename", where, message=message))


def left_behind(
    present: Mapping[str, Mapping[str, Any]],
    packages: Sequence[PackageAnswers],
    monitors: Sequence[BoundMonitor],
    gone: Collection[str],
) -> Iterator[tuple[str, bool]]:
    """Report packages that a renamed model seems to have left behind, but for those in ``gone``.

    ``present``: package -> answers of those that were there before the command.

    Yields:
        A sentence, and whether it is news: a package was made that was not there.
    """
    made = {new.folder: new.answers for new in packages if "facts" in new.answers}
    known: set[tuple[str, str]] = set()
    for folder, answers in present.items():
        if folder in gone or folder in made:
            continue
        heirs = [heir for heir, of in made.items() if _may_be(of, answers)]
        if heirs and not known:
            sources = {monitor.model.source.name: monitor.model.source for monitor in monitors}
            models = (model for source in sources.values() for model in read_models(source).models)
            known = {(model.kind, model.name) for model in models}
        if heirs and (answers["kind"], model_id(answers)) not in known:
            new = [heir for heir in heirs if heir not in present]
            heir = (new or heirs)[0]
            old, now = model_id(answers), model_id(made[heir])
            text = (
                f"{folder} was made of {old!r}, a model that is no longer there, and its monitor "
                f"still runs; if the name is {now!r} now, repeat this with `--rename "
                f"{folder}={heir}`, which takes hand-written code along, else remove the folder "
                "and repeat this"
            )
            yield text, bool(new)


def _may_be(new: Mapping[str, Any], old: Mapping[str, Any]) -> bool:
    """Return whether two packages may be of one model: by its file, or by what it reads."""
    if "facts" not in old or new["kind"] != old["kind"]:
        return False
    topics, former = (
        {entry["id"]: entry["sources"] for entry in of["inputs"]} for of in (new, old)
    )
    return new["model_file"] == old["model_file"] or (bool(topics) and topics == former)
