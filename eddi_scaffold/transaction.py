"""Replace many files as one step: all of them are new, or all of them are old.

The new texts are staged in one folder beside the files, then a journal is written, then each file
is replaced, in the order of the changes. Killed before the journal: nothing happened. Killed after
it: the next ``recover`` finishes the replacements, but leaves alone what was changed since: a
person may have gone on writing.
"""

from __future__ import annotations

import errno
import hashlib
import json
import os
import shutil
import tempfile
from collections.abc import Mapping
from dataclasses import astuple, dataclass
from pathlib import Path

from eddi_scaffold.problems import EddiError, Place, error

_PREFIX = ".eddi-transaction-"
_JOURNAL = "journal.json"


@dataclass(frozen=True)
class FileState:
    """Content and permission bits of one file."""

    data: bytes
    executable: bool = False


def tree_of(
    folder: Path, skip: frozenset[str] = frozenset({".git", "__pycache__"})
) -> dict[str, FileState]:
    """Read all files below a folder: relative POSIX path -> state; empty when it does not exist."""
    found: dict[str, FileState] = {}
    for root, folders, files in os.walk(folder):
        folders[:] = sorted(name for name in folders if name not in skip)
        for name in sorted(files):
            path = Path(root, name)
            if path.is_file():
                mode = path.stat().st_mode
                relative = path.relative_to(folder).as_posix()
                found[relative] = FileState(path.read_bytes(), bool(mode & 0o100))
    return found


@dataclass(frozen=True)
class _Step:
    """One line of the journal.

    Attributes:
        path: the file, relative to the root.
        staged: name of its new text, ``None`` to remove it.
        old: digest of the text that is replaced, ``None`` when there was no file.
        follows: file without whose change this one makes no sense.
    """

    path: str
    staged: str | None
    old: str | None
    follows: str | None


def apply(
    root: Path,
    changes: Mapping[str, FileState | None],
    follows: Mapping[str, str] | None = None,
    meanwhile: Mapping[str, FileState] | None = None,
) -> None:
    """Write, replace or (``None``) remove the files below ``root`` as one step.

    Args:
        root: folder that the paths are relative to.
        changes: path -> new state, in the order in which they are made.
        follows: path -> path of the file without whose change it makes no sense: when a killed
            run is finished and that file was changed since, both are left alone.
        meanwhile: new files that are there only from the first change to the last one.

    Raises:
        OSError: the disk is full or a folder is not writable; then nothing was changed.
    """
    if not changes:
        return
    _refuse_early(root / _JOURNAL)
    root.mkdir(parents=True, exist_ok=True)
    staging = Path(tempfile.mkdtemp(prefix=_PREFIX, dir=root))
    try:
        journal: list[_Step] = []
        guards = meanwhile or {}
        ends = [(path, None) for path in guards]
        for number, (path, state) in enumerate([*guards.items(), *changes.items(), *ends]):
            _refuse_early(root / path)
            staged = None if state is None else str(number)
            if state is not None:
                _write(staging / str(number), state.data)
                (staging / str(number)).chmod(0o755 if state.executable else 0o644)
            guard = guards[path].data if path in guards and state is None else None
            old = _digest(root / path) if guard is None else hashlib.sha256(guard).hexdigest()
            journal.append(_Step(path, staged, old, (follows or {}).get(path)))
        _write(staging / "journal.new", json.dumps([astuple(step) for step in journal]).encode())
        (staging / "journal.new").replace(staging / _JOURNAL)
    except BaseException:
        shutil.rmtree(staging, ignore_errors=True)
        raise
    try:
        _finish(root, staging)
    except KeyboardInterrupt:
        recover(root)  # all is decided: half of it would be worse than a moment more
        raise


def write(
    root: Path,
    changes: Mapping[str, FileState | None],
    follows: Mapping[str, str] | None = None,
    meanwhile: Mapping[str, FileState] | None = None,
) -> None:
    """Do the same as ``apply`` for a command.

    Raises:
        EddiError: nothing could be written (F002).
    """
    try:
        apply(root, changes, follows, meanwhile)
    except OSError as problem:
        reason = problem.strerror or str(problem)
        named = problem.filename is not None and _PREFIX not in str(problem.filename)
        place = Place(str(problem.filename if named else root))
        raise EddiError(error("F002", f"cannot write: {reason}", place)) from None


def recover(root: Path) -> bool:
    """Finish what a killed ``apply`` began below ``root``; tell whether there was something."""
    unfinished = sorted(root.glob(f"{_PREFIX}*")) if root.is_dir() else []
    for staging in unfinished:
        if (staging / _JOURNAL).exists():
            _finish(root, staging)
        else:
            shutil.rmtree(staging, ignore_errors=True)
    return bool(unfinished)


def _refuse_early(target: Path) -> None:
    """Raise now what would stop the replacements half-way."""
    if target.is_dir() and not target.is_symlink():
        raise IsADirectoryError(errno.EISDIR, "a folder stands in its place", str(target))
    for folder in target.parents:
        if folder.is_dir():
            if not os.access(folder, os.W_OK | os.X_OK):
                raise PermissionError(errno.EACCES, os.strerror(errno.EACCES), str(folder))
            return
        if os.path.lexists(folder):
            raise NotADirectoryError(errno.ENOTDIR, os.strerror(errno.ENOTDIR), str(folder))


def _finish(root: Path, staging: Path) -> None:
    left: set[str] = set()
    for entry in json.loads((staging / _JOURNAL).read_bytes()):
        step = _Step(*entry)
        target = root / step.path
        if not (target if step.staged is None else staging / step.staged).exists():
            continue  # done by the run that was killed
        if _digest(target) != step.old or step.follows in left:
            left.add(step.path)
        elif step.staged is None:
            target.unlink(missing_ok=True)
            _remove_empty_folders(target.parent, root)
        else:
            target.parent.mkdir(parents=True, exist_ok=True)
            (staging / step.staged).replace(target)
    shutil.rmtree(staging, ignore_errors=True)


def _digest(path: Path) -> str | None:
    return hashlib.sha256(path.read_bytes()).hexdigest() if path.is_file() else None


def _remove_empty_folders(folder: Path, root: Path) -> None:
    while folder != root and folder.is_dir() and not any(folder.iterdir()):
        folder.rmdir()
        folder = folder.parent


def _write(path: Path, data: bytes) -> None:
    with path.open("wb") as file:
        file.write(data)
        file.flush()
        os.fsync(file.fileno())
