"""Packages that get another name: they move, with everything that a person wrote in them."""

from __future__ import annotations

import json
import os
import re
from collections.abc import Callable, Collection, Container, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path

from eddi_scaffold.identifiers import package_name
from eddi_scaffold.packages.rendering import ANSWERS_FILE
from eddi_scaffold.packages.transaction import FileState, FolderContent, survey
from eddi_scaffold.packages.workspace import existing
from eddi_scaffold.problems import EddiError, Place, error
from eddi_scaffold.regions.bases import BASES, FORMER, bases_of, read_bases, text_of
from eddi_scaffold.regions.generated import changed_generated, recorded_generated
from eddi_scaffold.regions.markers import decode_id, encode_id
from eddi_scaffold.regions.store import SAVED

_RECORDS = ".eddi/"
_KEPT = ("pristine", "generated", "next", "accepted", "rejects")
_MANIFEST = f"{_RECORDS}manifest.json"
_ORPHANS = f"{_RECORDS}orphans/"
_BASES = f"{_RECORDS}{BASES}"
_FILE = "# file: "


@dataclass(frozen=True)
class Renames:
    """Packages of one command that get other names.

    Attributes:
        former: new folder -> old folder; all are renamed at once, so names may swap.
    """

    former: Mapping[str, str]
    _read: dict[Path, FolderContent] = field(default_factory=dict, repr=False, compare=False)

    @property
    def involved(self) -> frozenset[str]:
        """All folders that change."""
        return frozenset([*self.former, *self.former.values()])

    def content(self, root: Path, folder: str) -> FolderContent:
        """Return what is in a package before it is rendered, under its new paths."""
        old = self.former.get(folder)
        if old is not None:
            return _moved(root / old, folder, self.present(root / old))
        return FolderContent() if folder in self.involved else survey(root / folder)

    def present(self, package: Path) -> FolderContent:
        """Return what is in one of these folders, as it was when it was first looked at."""
        if package not in self._read:
            self._read[package] = survey(package)
        return self._read[package]

    def remains(self, root: Path, written: Container[str]) -> dict[str, FileState]:
        """Return the files in folders that are no packages any more."""
        return {
            f"{folder}/{path}": state
            for folder in self.involved
            if folder not in written
            for path, state in self.present(root / folder).files.items()
        }


NO_RENAMES = Renames({})


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
    present = existing(root, made) if words else {}
    for word in words:
        old, new = (package_name(part) for part in word.partition("=")[::2])
        if not (old and new):
            raise _refused(f"{word!r} is not OLD=NEW", "--rename ConSertA=ConSertB")
        if old not in present:
            known = ", ".join(sorted(present)) or "none"
            raise _refused(f"there is no package {old!r} to rename", f"there are: {known}", root)
        if new not in made:
            hint = "give the model of the new name, and its configuration"
            raise _refused(f"this command makes no package {new!r}", hint)
        if old == new or new in former or old in former.values():
            raise _refused(f"{word!r} renames a package twice, or not at all", "give each once")
        former[new] = old
    for new, old in former.items():
        _check_movable(root / old)
        if new not in former.values() and not _is_as_made(root / new):
            message = f"{new!r} is there already, and something in it was written by hand"
            hint = "move what you need of it away, remove the folder, and run this again"
            raise _refused(message, hint, root / new)
    return Renames(former)


def mentions(
    files: Mapping[str, FileState], old: str, new: str, generated: Container[str]
) -> list[str]:
    """Report the files of a person that still have the old name of the package in them."""
    word = re.compile(rb"(?<![\w/~])" + re.escape(old.encode()) + rb"(?![\w/])")
    return [
        f"{new}/{path}: the name {old!r} of the package is still in it"
        for path in sorted(files)
        if not path.startswith((ANSWERS_FILE, _RECORDS))
        and path not in generated
        and any(word.search(line) for line in _own_lines(path, files))
    ]


def _own_lines(path: str, files: Mapping[str, FileState]) -> Iterator[bytes]:
    record = files.get(_BASES)
    base = bases_of(record.text or "").get(path, "") if record is not None else ""
    made = set(base.encode().splitlines())
    return (line for line in files[path].data.splitlines() if line not in made)


def _refused(message: str, hint: str, place: Path | None = None) -> EddiError:
    where = Place(str(place) if place is not None else "")
    return EddiError(error("G025", f"--rename: {message}", where, hint))


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
    for name, kind in sorted(survey(package).others.items()):
        hint = "remove it, run this again, and make it anew (an editor's goes when it is closed)"
        raise _refused(f"{name!r} cannot move along: it is {kind}", hint, package)


def _is_as_made(package: Path) -> bool:
    """Return whether nothing in a folder was written by hand, as where there is none."""
    files, made = survey(package).files, set(recorded_generated(package))
    base = {name: text.encode() for name, text in read_bases(package).items()}
    return not changed_generated(package) and all(
        name in made
        or name == ANSWERS_FILE
        or base.get(name) == state.data
        or (name.startswith(_RECORDS) and not name.startswith(SAVED))
        for name, state in files.items()
    )


def _moved(package: Path, new: str, tree: FolderContent) -> FolderContent:
    """Return a package with the paths, and the records of paths, that it has under another name."""
    moved = _mover(package, new)
    files = {moved(path): s for path, s in tree.files.items() if not path.startswith(f"{FORMER}/")}
    if bases := {moved(name): text for name, text in read_bases(package).items()}:
        files[_BASES] = FileState(text_of(bases).encode())
    for path, state in files.items():
        text = state.data
        if path == _MANIFEST:
            text = _moved_manifest(text, moved)
        elif path.startswith(_ORPHANS):
            text = _moved_orphan(text, moved)
        files[path] = replace(state, data=text)
    return FolderContent(files, tree.others)


def _mover(package: Path, new: str) -> Callable[[str], str]:
    """Return what a path becomes: folders of generated files that have the package's name."""
    old = package.name
    made = [*recorded_generated(package), *read_bases(package)]
    folders = {name[: name.index(f"{old}/")] for name in made if f"/{old}/" in f"/{name}"}
    starts = [f"{_RECORDS}{kept}/{folder}" for kept in _KEPT for folder in folders] + [*folders]

    def moved(path: str) -> str:
        start = next((s for s in starts if path.startswith(f"{s}{old}/")), None)
        return path if start is None else f"{start}{new}{path[len(start) + len(old) :]}"

    return moved


def _moved_manifest(data: bytes, moved: Callable[[str], str]) -> bytes:
    try:
        record = json.loads(data)
        parts = {key: part for key, part in record.items() if isinstance(part, dict)}
    except (ValueError, AttributeError, RecursionError):
        return data  # damaged: all counts as generated, as without a rename
    renamed = {key: {moved(name): d for name, d in part.items()} for key, part in parts.items()}
    return json.dumps({**record, **renamed}).encode()


def _moved_orphan(data: bytes, moved: Callable[[str], str]) -> bytes:
    head, sign, body = data.decode("utf-8", "surrogateescape").partition("# ---\n")
    lines = [
        f"{_FILE}{encode_id(moved(decode_id(line[len(_FILE) :])))}"
        if line.startswith(_FILE)
        else line
        for line in head.split("\n")
    ]
    return ("\n".join(lines) + sign + body).encode("utf-8", "surrogateescape")
