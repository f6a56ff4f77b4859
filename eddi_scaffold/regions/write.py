"""Write what was planned: first all bytes to one side, then only renames."""

from __future__ import annotations

import errno
import fcntl
import os
import shutil
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

from .package import PUT, stamp_of


class BusyError(Exception):
    """Another run is at work in the folder."""


class SavedError(Exception):
    """A file was saved after it was read; the text is its path."""


@dataclass(frozen=True)
class Step:
    """One change of a package: a file gets new bytes, or goes.

    Attributes:
        path: relative to the package.
        data: ``None`` for a file that goes.
        mode: its permission bits.
    """

    path: str
    data: bytes | None
    mode: int = 0o644


@contextmanager
def locked(folder: Path) -> Iterator[None]:
    """Keep other runs out of a folder, as long as this process is in here; a lock of the kernel.

    A folder that is not there, or a disk without locks, has none.

    Raises:
        BusyError: another run is at work there.
    """
    try:
        handle = os.open(folder, os.O_RDONLY | os.O_DIRECTORY | os.O_CLOEXEC)
    except OSError:
        yield
        return
    try:
        try:
            fcntl.flock(handle, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except OSError as refused:
            if refused.errno in {errno.EACCES, errno.EAGAIN}:
                raise BusyError(f"another run is at work in {folder}") from None
        yield
    finally:
        os.close(handle)


def put_aside(root: Path, steps: Sequence[Step], place: Path) -> None:
    """Write all new bytes beside their places; nothing of a person changes.

    Args:
        root: folder of the paths.
        steps: what is to be done.
        place: folder for the bytes, on the same disk.

    Raises:
        OSError: the disk is full, or a folder is not writable.
    """
    shutil.rmtree(place, ignore_errors=True)
    for step in steps:
        _refuse_unwritable((root / step.path).parent)
    if not any(step.data is not None for step in steps):
        return
    place.mkdir(parents=True)
    try:
        for number, step in enumerate(steps):
            if step.data is not None:
                _write(place / str(number), step.data, step.mode)
    except OSError:
        shutil.rmtree(place, ignore_errors=True)
        raise


def refuse_saved(root: Path, stamps: Mapping[str, tuple[int, ...]]) -> None:
    """Refuse where a person saved a file since it was read.

    Raises:
        SavedError: that is so.
    """
    for name, stamp in stamps.items():
        if stamp_of(root / name) != stamp:
            shutil.rmtree(root / PUT, ignore_errors=True)
            raise SavedError(root / name)


def move_in(root: Path, steps: Sequence[Step]) -> None:
    """Do the steps in their order, each at once; killed in between, the next run finishes.

    Raises:
        OSError: a folder is not writable.
    """
    for number, step in enumerate(steps):
        target = root / step.path
        if step.data is not None:
            target.parent.mkdir(parents=True, exist_ok=True)
            (root / PUT / str(number)).replace(target)
            continue
        target.unlink(missing_ok=True)
        folder = target.parent
        while folder != root and folder.is_dir() and not any(folder.iterdir()):
            folder.rmdir()
            folder = folder.parent
    shutil.rmtree(root / PUT, ignore_errors=True)


def _write(path: Path, data: bytes, mode: int) -> None:
    with path.open("wb") as file:
        file.write(data)
        file.flush()
        os.fsync(file.fileno())
    path.chmod(mode)


def _refuse_unwritable(folder: Path) -> None:
    while not os.path.lexists(folder):
        folder = folder.parent
    if not os.access(folder, os.W_OK | os.X_OK):
        raise PermissionError(errno.EACCES, os.strerror(errno.EACCES), str(folder))
