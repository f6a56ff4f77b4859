"""One run at a time in a folder of packages.

The lock is the kernel's, on a file in the user's own folder: a process that dies gives it back, a
workspace that comes from elsewhere cannot hold it, and none of it lies in the workspace.
"""

from __future__ import annotations

import errno
import fcntl
import json
import os
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from .state import key_of, made_shelf, refuse_shared

_PAUSE_S = 0.05


class BusyError(Exception):
    """Another run is at work in the folder; the text says which, and since when."""


@contextmanager
def locked(folder: Path, wait_s: float = 0.0) -> Iterator[None]:
    """Keep other runs of this user out of a folder of packages.

    Without a place for the lock there is none.

    Args:
        folder: the folder, which need not be there.
        wait_s: how long to wait for another run.

    Raises:
        BusyError: another run is still at work there.
    """
    try:
        handle = _opened(folder)
    except OSError:
        yield
        return
    try:
        _take(handle, folder, wait_s)
        os.pwrite(handle, _record().encode(), 0)
        try:
            yield
        finally:
            os.ftruncate(handle, 0)
            fcntl.flock(handle, fcntl.LOCK_UN)  # a forked process may still have the handle
    finally:
        os.close(handle)


def _opened(folder: Path) -> int:
    place = made_shelf("locks") / key_of(folder)
    flags = os.O_RDWR | os.O_CREAT | os.O_CLOEXEC | os.O_NOFOLLOW
    handle = os.open(place, flags, 0o600)
    try:
        refuse_shared(os.fstat(handle), place)
    except OSError:
        os.close(handle)
        raise
    return handle


def _take(handle: int, folder: Path, wait_s: float) -> None:
    end = time.monotonic() + wait_s
    while not _is_taken(handle):
        if time.monotonic() >= end:
            raise BusyError(f"{_holder(handle)} is at work in {folder}")
        time.sleep(_PAUSE_S)
    os.ftruncate(handle, 0)  # of a run that was killed


def _is_taken(handle: int) -> bool:
    try:
        fcntl.flock(handle, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except OSError as refused:
        return refused.errno not in {errno.EACCES, errno.EAGAIN}  # else: a disk without locks
    return True


def _record() -> str:
    return json.dumps({"process": os.getpid(), "since": time.strftime("%Y-%m-%d %H:%M:%S")})


def _holder(handle: int) -> str:
    try:
        record = json.loads(os.pread(handle, 200, 0))
        return f"process {int(record['process'])} (since {record['since']})"
    except (OSError, ValueError, KeyError, TypeError):
        return "another process"
