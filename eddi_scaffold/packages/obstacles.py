"""Entries of a package that are not regular files: they stay, and files in their place wait.

A link of a person, the lock file of an editor or a socket is not a reason to stop; a link where a
file of ours belongs is, for that file alone.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from pathlib import PurePosixPath

from eddi_scaffold.regions.store import SAVED

_SHOWN = 5
_RECORDS = ".eddi"


@dataclass(frozen=True)
class Obstacles:
    """The entries of one package that are not regular files.

    Attributes:
        folder: name of the package folder.
        kinds: path -> what it is.
        waiting: path of an obstacle -> files that belong there, or below.
    """

    folder: str
    kinds: Mapping[str, str]
    waiting: Mapping[str, list[str]]

    @property
    def skipped(self) -> frozenset[str]:
        """The files that wait, and what the records of the package contain about them."""
        files = [file for files in self.waiting.values() for file in files]
        folders = (
            "",
            *(f"{_RECORDS}/{name}/" for name in ("pristine", "generated", "base", "next")),
        )
        return frozenset(f"{folder}{file}" for folder in folders for file in files)

    def at_records(self, answers_file: str) -> str | None:
        """Return an obstacle in the place of the package's own records, ``None`` without one."""
        return next(
            (
                path
                for path in self.kinds
                if path in {answers_file, _RECORDS}
                or (path.startswith(f"{_RECORDS}/") and not path.startswith(SAVED))
            ),
            None,
        )

    def before(self, paths: Iterable[str]) -> str | None:
        """Return the first obstacle in the place of one of these files, or among its folders."""
        return next((at for path in paths if (at := _obstacle(path, self.kinds)) is not None), None)

    def stop(self, path: str) -> str:
        """Report that the whole package is left alone because of one obstacle."""
        where = f"{self.folder}/{shown(path)} is {self.kinds[path]}"
        return f"{self.folder} is left alone: {where}, and a record of the package belongs there"

    def waiting_notes(self) -> list[str]:
        """Report which files wait."""
        return [self._waiting_note(path, files) for path, files in self.waiting.items()]

    def _waiting_note(self, path: str, files: list[str]) -> str:
        what = f"{self.folder}/{shown(path)} is {self.kinds[path]}: it is left alone"
        return (
            f"{what}, not brought up to date"
            if files == [path]
            else f"{what}, and so {_few(files)}"
        )

    def untouched(self) -> list[str]:
        """Report once what else is there; nothing of it was opened or copied."""
        found = [f"{shown(p)} ({k})" for p, k in self.kinds.items() if p not in self.waiting]
        return [f"{self.folder}: left as they are: {_few(found)}"] if found else []


def obstacles(folder: str, kinds: Mapping[str, str], wanted: Iterable[str]) -> Obstacles:
    """Return which files cannot be put where they belong.

    Args:
        folder: name of the package folder.
        kinds: path in it -> what it is, of all that is not a regular file.
        wanted: the files that a package has.
    """
    waiting: dict[str, list[str]] = {}
    for path in sorted(wanted):
        at = _obstacle(path, kinds)
        if at is not None and not path.startswith(f"{_RECORDS}/"):
            waiting.setdefault(at, []).append(path)
    return Obstacles(folder, kinds, waiting)


def shown(name: str) -> str:
    """Return the name of a file as one line."""
    return name if name.isprintable() else ascii(name)


def _obstacle(path: str, kinds: Mapping[str, str]) -> str | None:
    places = [path, *map(str, PurePosixPath(path).parents)]
    return next((place for place in places if place in kinds), None)


def _few(names: list[str]) -> str:
    more = f" and {len(names) - _SHOWN} more" if len(names) > _SHOWN else ""
    return ", ".join(names[:_SHOWN]) + more
