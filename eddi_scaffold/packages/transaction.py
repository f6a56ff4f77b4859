"""Replace many files as one step: all of them are new, or all of them are old.

The new texts are staged in one folder next to the files, then the journal records the plan, then
each file is replaced, in the order of the changes. Killed before that: nothing happened. Killed
after it: the next ``recover`` finishes the replacements, but leaves alone what was changed since: a
person may have gone on writing.
"""

from __future__ import annotations

import errno
import hashlib
import os
import secrets
import shutil
import stat
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path, PurePosixPath

from eddi_scaffold.packages import journal
from eddi_scaffold.packages.journal import JournalEntry
from eddi_scaffold.packages.obstacles import shown
from eddi_scaffold.problems import EddiError, Place, error
from eddi_scaffold.regions.files import entries, kind_of, open_regular, read_regular
from eddi_scaffold.regions.store import ChangedMeanwhileError
from eddi_scaffold.source import refuse_input

PREFIX = ".eddi-transaction-"
"""How the folders with staged texts begin."""
_SHOWN = 5
NEW, NEW_PROGRAM = 0o644, 0o755
"""Permissions of files that were not there before."""


@dataclass(frozen=True)
class FileState:
    """Content and permission bits of one file."""

    data: bytes
    mode: int = NEW

    @property
    def executable(self) -> bool:
        """Return whether its owner may run it."""
        return bool(self.mode & stat.S_IXUSR)

    @property
    def text(self) -> str | None:
        """Return the content as text, ``None`` where it is not UTF-8."""
        try:
            return self.data.decode()
        except UnicodeDecodeError:
            return None


@dataclass(frozen=True)
class FolderContent:
    """The content of a folder.

    Attributes:
        files: relative POSIX path -> state of the regular files.
        others: relative POSIX path -> what it is, of all else: links are not followed, and FIFOs,
            sockets, devices and what cannot be read are not opened.
    """

    files: dict[str, FileState] = field(default_factory=dict)
    others: dict[str, str] = field(default_factory=dict)


def survey(
    folder: Path, skip: frozenset[str] = frozenset({".git", "__pycache__"})
) -> FolderContent:
    """Read all regular files below a folder, and list what else is there."""
    tree = FolderContent()
    for name, kind in sorted(entries(folder, skip)):
        path = folder / name
        if kind is not None:
            tree.others[name] = kind
            continue
        try:
            mode = path.lstat().st_mode & 0o777
            tree.files[name] = FileState(read_regular(path, follow=False), mode)
        except FileNotFoundError:
            continue  # gone meanwhile
        except OSError as refused:
            tree.others[name] = f"a file that cannot be read ({refused.strerror})"
    return tree


def tree_of(folder: Path) -> dict[str, FileState]:
    """Read all regular files below a folder: relative POSIX path -> state."""
    return survey(folder).files


@dataclass(frozen=True)
class Applied:
    """How the writing went.

    Attributes:
        left: one sentence for each file that was changed in the moment before it was replaced.
        notes: what else a person should know, one sentence each.
    """

    left: Sequence[str] = ()
    notes: Sequence[str] = ()


def apply(
    root: Path,
    changes: Mapping[str, FileState | None],
    before: Mapping[str, FileState] | None = None,
    follows: Mapping[str, Sequence[str]] | None = None,
    meanwhile: Mapping[str, FileState] | None = None,
) -> Applied:
    """Write, replace or (``None``) remove the files below ``root`` as one step.

    Args:
        root: folder that the paths are relative to.
        changes: path -> new state, in the order in which they are made.
        before: path -> state that the change was made from, of those that existed; without it,
            whatever is there is replaced.
        follows: path -> paths of the files without whose changes it makes no sense: when a killed
            run is finished and one of them was changed since, it is left alone as well.
        meanwhile: new files that are there only from the first change to the last one.

    Raises:
        ChangedMeanwhileError: a file was saved after it was read; then nothing was changed.
        OSError: the disk is full, a folder is not writable, or a link or what is not a regular file
            is in the way; then nothing was changed.
    """
    if not changes:
        return Applied()
    _refuse_early(root, PREFIX)
    root.mkdir(parents=True, exist_ok=True)
    staging = root / f"{PREFIX}{secrets.token_hex(4)}"
    try:
        journal.keep(root, staging.name, None)
        staging.mkdir(mode=0o700)
        steps = list(_staged(root, staging, changes, before, follows or {}, meanwhile or {}))
        unrecorded = journal.keep(root, staging.name, steps)
        _refuse_changed(root, steps)  # at last: the disk may have taken its time
    except BaseException:
        shutil.rmtree(staging, ignore_errors=True)
        journal.forget(root, staging.name)
        raise
    try:
        left = _finish(root, staging, steps)
    except KeyboardInterrupt:
        _finish(root, staging, steps)  # all is decided: half of it would be worse than a moment
        raise
    if unrecorded is None:
        return Applied(left)
    note = f"killed, this run could not have been finished: no journal at {unrecorded}"
    return Applied(left, [note])


def _staged(
    root: Path,
    staging: Path,
    changes: Mapping[str, FileState | None],
    before: Mapping[str, FileState] | None,
    follows: Mapping[str, Sequence[str]],
    guards: Mapping[str, FileState],
) -> Iterator[JournalEntry]:
    """Stage the new texts, and yield what is to be done."""
    ends = [(path, None) for path in guards]
    middle = [(path, state) for path, state in changes.items() if path not in guards]
    old: dict[str, str | None] = {}
    for path in {**guards, **changes}:
        read = before.get(path) if before is not None else None
        now = _digest(root / path) if before is None else None
        old[path] = _sha256(read.data) if read is not None else now
    for number, (path, state) in enumerate([*guards.items(), *middle, *ends]):
        _refuse_early(root, path)
        if state is not None:
            _write(staging / str(number), state.data)
            (staging / str(number)).chmod(state.mode)
        staged = None if state is None else str(number)
        new = None if state is None else _sha256(state.data)
        yield JournalEntry(path, staged, new, old[path], follows.get(path, ()))
        old[path] = new


def _refuse_changed(root: Path, steps: Sequence[JournalEntry]) -> None:
    """Raise where a file is not what its new text was made of: a person has saved it meanwhile."""
    first = {step.path: step for step in reversed(steps)}
    for path, step in first.items():
        if _digest(root / path) != step.old:
            raise ChangedMeanwhileError(errno.EBUSY, "it was saved meanwhile", str(root / path))


def write(
    root: Path,
    changes: Mapping[str, FileState | None],
    before: Mapping[str, FileState] | None = None,
    follows: Mapping[str, Sequence[str]] | None = None,
    meanwhile: Mapping[str, FileState] | None = None,
) -> Applied:
    """Do the same as ``apply`` for a command.

    Raises:
        EddiError: nothing could be written (F002), a file was saved meanwhile (F013), or a file
            of which no ``before`` is given is an input of the command (F014).
    """
    for path in changes.keys() - (before or {}).keys():
        refuse_input(root / path)
    try:
        return apply(root, changes, before, follows, meanwhile)
    except ChangedMeanwhileError as saved:
        message = "it was changed while this command was running; nothing was written"
        place = Place(str(saved.filename))
        raise EddiError(error("F013", message, place, "run the command again")) from None
    except OSError as problem:
        reason = problem.strerror or str(problem)
        named = problem.filename is not None and PREFIX not in str(problem.filename)
        place = Place(str(problem.filename if named else root))
        raise EddiError(error("F002", f"cannot write: {reason}", place)) from None


def recover(root: Path) -> Sequence[str]:
    """Finish what killed runs of this user began below ``root``.

    Returns:
        What was found, one sentence each; nothing is taken from a folder that no journal of this
        user refers to.
    """
    if not root.is_dir():
        return ()
    notes: list[str] = []
    strangers: list[Path] = []
    kept = journal.records(root)
    found = {path.name for path in root.glob(f"{PREFIX}*")}
    for name in sorted({*kept, *found}):
        staging = root / name
        if name in found and (name not in kept or not _is_own_folder(staging)):
            strangers.append(staging)
            continue
        steps = kept[name]
        if name not in found:
            pass  # killed when all was done
        elif steps is None:
            shutil.rmtree(staging, ignore_errors=True)
            notes.append(f"{root}: an interrupted run had changed nothing yet")
        else:
            notes.append(f"{root}: what an interrupted run had begun is finished")
            notes += _finish(root, staging, steps)
        journal.forget(root, name)
    return [*notes, *_left_alone(strangers)]


def _left_alone(folders: Sequence[Path]) -> Iterator[str]:
    for folder in folders[:_SHOWN]:
        yield (
            f"{shown(str(folder))} is left alone: it looks like an interrupted run, but none of "
            "yours left it in this place; remove it if no other command is running here"
        )
    if len(folders) > _SHOWN:
        yield f"{len(folders) - _SHOWN} more of this kind are left alone"


def _is_own_folder(staging: Path) -> bool:
    try:
        status = staging.lstat()
    except OSError:
        return False
    return stat.S_ISDIR(status.st_mode) and status.st_uid == os.geteuid()


def _refuse_early(root: Path, path: str) -> None:
    """Raise now what would stop the replacements half-way."""
    target = root / path
    if _behind_link(root, path):
        raise OSError(errno.ELOOP, "a link is in the way", str(target))
    if target.is_dir() and not target.is_symlink():
        raise IsADirectoryError(errno.EISDIR, "a folder is in its place", str(target))
    if target.exists() and not (target.is_file() or target.is_dir()):
        kind = kind_of(target.resolve())
        raise OSError(errno.EEXIST, f"{kind} is in its place", str(target))
    for folder in target.parents:
        if folder.is_dir():
            if not os.access(folder, os.W_OK | os.X_OK):
                raise PermissionError(errno.EACCES, os.strerror(errno.EACCES), str(folder))
            return
        if os.path.lexists(folder):
            raise NotADirectoryError(errno.ENOTDIR, os.strerror(errno.ENOTDIR), str(folder))


def _behind_link(root: Path, path: str) -> bool:
    return any((root / folder).is_symlink() for folder in PurePosixPath(path).parents[:-1])


def _finish(root: Path, staging: Path, steps: Sequence[JournalEntry]) -> Sequence[str]:
    """Do what is not done yet; return what was left alone, because it was changed since."""
    left: dict[str, str] = {}
    for step in steps:
        target = root / step.path
        staged = None if step.staged is None else staging / step.staged
        if _behind_link(root, step.path):
            left[step.path] = f"{target} is left alone: a link is in the way"
        elif not os.path.lexists(target if staged is None else staged):
            continue  # done by the run that was killed
        elif any(path in left for path in step.follows):
            left[step.path] = ""  # that file was told
        elif _digest(target) != step.old:
            left[step.path] = f"{target} is left alone: it was changed since"
        elif staged is None:
            target.unlink(missing_ok=True)
            _remove_empty_folders(target.parent, root)
        elif _digest(staged) != step.new:
            left[step.path] = f"{target} is left alone: its new text was changed since"
        else:
            target.parent.mkdir(parents=True, exist_ok=True)
            staged.replace(target)
    shutil.rmtree(staging, ignore_errors=True)
    journal.forget(root, staging.name)
    return [told for told in left.values() if told]


def _sha256(data: bytes) -> str:
    return hashlib.sha256(data).hexdigest()


def _digest(path: Path) -> str | None:
    """Return the digest of a file, the kind of another entry, ``None`` where there is nothing."""
    kind = kind_of(path)
    if kind is not None or not os.path.lexists(path):
        return kind
    digest = hashlib.sha256()
    with open_regular(path, follow=False) as stream:
        while block := stream.read(1 << 20):
            digest.update(block)
    return digest.hexdigest()


def _remove_empty_folders(folder: Path, root: Path) -> None:
    while folder != root and folder.is_dir() and not any(folder.iterdir()):
        folder.rmdir()
        folder = folder.parent


def _write(path: Path, data: bytes) -> None:
    with path.open("wb") as file:
        file.write(data)
        file.flush()
        os.fsync(file.fileno())
