"""Files of anybody: only regular ones are opened, and never read beyond a limit.

FIFOs, sockets and devices may wait for ever, or be read without end.
"""

from __future__ import annotations

import errno
import os
import stat
from pathlib import Path, PurePosixPath
from typing import BinaryIO

from eddi_scaffold.regions.package import KINDS, is_relative

MAX_BYTES = 64 * 1024 * 1024
"""A larger file is nothing that we read."""


class NotRegularError(OSError):
    """The entry is a FIFO, a socket or a device."""


def open_regular(path: str | Path) -> BinaryIO:
    """Open a file, or what a link leads to, for reading; the caller closes it.

    Raises:
        NotRegularError: it is not a regular file; nothing waits for its other end.
        OSError: it is a folder, or cannot be opened.
    """
    if "\0" in str(path):
        raise OSError(errno.EINVAL, "no file has such a name")
    _refuse(Path(path).stat().st_mode, path)
    handle = os.open(path, os.O_RDONLY | os.O_CLOEXEC | os.O_NONBLOCK)
    try:
        _refuse(os.fstat(handle).st_mode, path)  # another one may be there by now
    except OSError:
        os.close(handle)
        raise
    return os.fdopen(handle, "rb")


def read_regular(path: str | Path, limit: int = MAX_BYTES) -> bytes:
    """Return the bytes of a regular file, of which no more than ``limit`` + 1 are read.

    Raises:
        NotRegularError: it is not a regular file.
        OSError: it is a folder, cannot be read, or is larger than ``limit``.
    """
    with open_regular(path) as stream:
        size = os.fstat(stream.fileno()).st_size
        data = stream.read(size + 1) or b"" if size <= limit else b""  # None: nothing new in kmsg
        if len(data) > size:  # it grows, or is of /proc, where files have no size
            data += stream.read(limit + 1 - len(data)) or b""
    if max(size, len(data)) > limit:
        reason = f"it has more than the limit of {limit} bytes"
        raise OSError(errno.EFBIG, reason, str(path))
    return data


def stays(root: Path, path: Path) -> bool:
    """Return whether a path, links followed, still lies below a folder."""
    return Path(os.path.realpath(path)).is_relative_to(os.path.realpath(root))


def inside(root: Path, name: object) -> Path | None:
    """Return the place of a relative path below a folder, ``None`` where it may lie elsewhere.

    Args:
        root: the folder.
        name: from a file; anything.

    Returns:
        ``None`` for a path that is not relative and normalised, or has a link among its parents
        below ``root``. The last part may be a link: it names the link, not its target.
    """
    if not isinstance(name, str) or not is_relative(name):
        return None
    above = [root / folder for folder in PurePosixPath(name).parents][:-1]
    # false for a name that no disk can hold
    return None if any(map(os.path.islink, above)) else root / name


def _refuse(mode: int, path: str | Path) -> None:
    kind = stat.S_IFMT(mode)
    if kind == stat.S_IFDIR:
        raise IsADirectoryError(errno.EISDIR, os.strerror(errno.EISDIR), str(path))
    if kind != stat.S_IFREG:
        reason = f"it is {KINDS.get(kind, 'no regular file')}, and only regular files are read"
        raise NotRegularError(errno.EINVAL, reason, str(path))
