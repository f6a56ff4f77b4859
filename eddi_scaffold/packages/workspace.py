"""Which generated packages lie in a workspace."""

from __future__ import annotations

import os
from collections.abc import Container, Iterable, Iterator, Mapping
from contextlib import ExitStack, contextmanager
from pathlib import Path, PurePosixPath
from typing import Any

from eddi_scaffold import __version__
from eddi_scaffold.common.problems import EddiError, Place, problem
from eddi_scaffold.config.file import from_data
from eddi_scaffold.kinds import kinds
from eddi_scaffold.monitors.compiling import from_json as facts_of
from eddi_scaffold.packages.rendering import ANSWERS_FILE, is_newer, read_answers
from eddi_scaffold.platforms import Platform, owner_of
from eddi_scaffold.regions.package import MANIFEST, BusyError, locked

_OF_INPUTS = ("id", "attribute", "title", "sources", "region")


def existing(root: Path, renewed: Container[str] = ()) -> dict[str, dict[str, Any]]:
    """Return folder name -> answers of the generated packages directly below ``root``.

    Those in ``renewed`` get new answers: they are left out where theirs are damaged.

    Raises:
        EddiError: the answers of another package are damaged (T005), or not there (H012).
    """
    packages = {}
    for folder in sorted(root.iterdir()) if root.is_dir() else []:
        if folder.is_symlink() or not (folder.is_dir() and os.access(folder, os.X_OK)):
            continue
        answers = read_answers(folder)
        if answers is None and (folder / MANIFEST).is_file():
            raise lacks_answers(folder)
        if answers is not None:
            try:
                check_answers(folder, answers)
                packages[folder.name] = answers
            except EddiError:
                if folder.name not in renewed:
                    raise
    return packages


def check_answers(package: Path, answers: Mapping[str, Any]) -> None:
    """Refuse the answers of a package that other code could not follow (EddiError, T005)."""
    try:
        owner_of(str(answers["template"]))
        if "facts" in answers:
            model_id(answers)
            kinds()[answers["kind"]]
            answers["model_file"]
            "".join([answers.get("model_text", ""), *answers["files"], *answers["files"].values()])
            "".join(answers.get("parts", ()))
            if answers.get("config"):
                from_data(answers["config"], package.name)
            "".join(input_[key] for input_ in answers["inputs"] for key in _OF_INPUTS)  # all texts
    except (AttributeError, KeyError, SyntaxError, TypeError, ValueError, RecursionError) as damage:
        reason = str(damage).partition("\n")[0]
        place = Place(str(package / ANSWERS_FILE))
        raise EddiError(problem("T005.reason", place, reason=reason)) from None


def model_id(answers: Mapping[str, Any]) -> str:
    """Return the id of the model that a monitor package was generated from."""
    return facts_of(answers["facts"]).id


@contextmanager
def alone(folders: Iterable[Path]) -> Iterator[None]:
    """Keep other commands from writing into folders, from before they are read.

    In place of a folder that is not there, the nearest one above is locked.

    Raises:
        EddiError: one is at work there (F012).
    """
    there = [next(filter(Path.is_dir, (place, *place.parents))) for place in folders]
    try:
        with ExitStack() as stack:
            for folder in {place.resolve(): place for place in there}.values():
                stack.enter_context(locked(folder))
            yield
    except BusyError as busy:
        raise EddiError(problem("F012", reason=busy)) from None


def lacks_answers(package: Path) -> EddiError:
    """Return what to say of a package that does not know what it was made of."""
    place = Place(str(package))
    return EddiError(problem("H012.no_answers", place, answers=ANSWERS_FILE, package=package))


def refuse_newer(packages: Iterable[Path]) -> None:
    """Refuse to write packages of a later release (T006): what it added would be taken out."""
    files = [path / ANSWERS_FILE for path in packages if not path.is_symlink()]
    versions = {file: (read_answers(file.parent) or {}).get("generator_version") for file in files}
    newer = {file: version for file, version in versions.items() if is_newer(str(version))}
    if newer:
        made = [(Place(str(file)), version) for file, version in newer.items()]
        raise EddiError(*(problem("T006", p, maker=v, present=__version__) for p, v in made))


def packages_root(platform: Platform, place: Path) -> Path:
    """Return the folder of all packages of a platform in its workspace, or in any folder.

    Raises:
        EddiError: this is not a workspace (G007), or the folder leads out of it (F009).
    """
    kind = platform.workspace
    if kind is not None:
        where, sources = Place(str(place)), PurePosixPath(platform.root).parts[0]
        if not place.is_dir():
            raise EddiError(problem("G007.missing", where, kind=kind, folder=place, source=sources))
        if place.resolve().name == sources and not (place / sources).exists():
            above = ".." if place == Path() else place.parent  # `.` has no parent
            raise EddiError(problem("G007.sources", where, sources=sources, above=above))
    return root_below(place, platform.root)


def root_below(place: Path, name: str) -> Path:
    """Return the folder of all packages in a workspace, which may be a link: the user names it.

    Raises:
        EddiError: a link in it leads out of it (F009).
    """
    root = place / name
    if not root.resolve().is_relative_to(place.resolve()):
        raise EddiError(problem("F009.link", Place(str(root)), folder=place))
    return root
