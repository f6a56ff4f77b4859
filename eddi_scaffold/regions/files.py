"""Untrusted files and paths: read the kind and the bytes of an entry safely.

A package may hold links, FIFOs, sockets and devices. Opening them may wait for ever, read without
end or lead out of the package; so only regular files are opened, and never read beyond a limit. A
path that comes out of a file is used only when it is the normalised, relative form of a place below
the folder that it is about, and no link on the way leads out of that folder.
"""

from __future__ import annotations

import errno
import os
import stat
from collections.abc import Collection, Iterator
from pathlib import Path, PurePosixPath
from typing import BinaryIO

MAX_BYTES = 64 * 1024 * 1024
"""A larger file is nothing that we read."""
LINK = "a link"
_KINDS = {
    stat.S_IFLNK: LINK,
    stat.S_IFIFO: "a FIFO",
    stat.S_IFSOCK: "a socket",
    stat.S_IFCHR: "a device",
    stat.S_IFBLK: "a device",
}


class NotRegularError(OSError):
    """The entry is a FIFO, a socket or a device."""


def open_regular(path: str | Path, *, follow: bool = True) -> BinaryIO:
    """Open a file for reading; the caller closes it.

    Args:
        path: the file.
        follow: whether it may be a link to a file.

    Raises:
        NotRegularError: it is not a regular file; nothing waits for its other end.
        OSError: it is a folder, or cannot be opened.
    """
    if "\0" in str(path):
        raise OSError(errno.EINVAL, "no file has such a name")
    _refuse(Path(path).stat(follow_symlinks=follow).st_mode, path)
    flags = os.O_RDONLY | os.O_CLOEXEC | os.O_NONBLOCK | (0 if follow else os.O_NOFOLLOW)
    handle = os.open(path, flags)
    try:
        _refuse(os.fstat(handle).st_mode, path)  # another one may be there by now
    except OSError:
        os.close(handle)
        raise
    return os.fdopen(handle, "rb")


def read_regular(path: str | Path, limit: int = MAX_BYTES, *, follow: bool = True) -> bytes:
    """Return the bytes of a regular file, of which no more than ``limit`` + 1 are read.

    Raises:
        NotRegularError: it is not a regular file.
        OSError: it is a folder, cannot be read, or is larger than ``limit``.
    """
    with open_regular(path, follow=follow) as stream:
        size = os.fstat(stream.fileno()).st_size
        data = stream.read(size + 1) or b"" if size <= limit else b""  # None: nothing new in kmsg
        if len(data) > size:  # it grows, or is of /proc, where files have no size
            data += stream.read(limit + 1 - len(data)) or b""
    if max(size, len(data)) > limit:
        reason = f"it has more than the limit of {limit} bytes"
        raise OSError(errno.EFBIG, reason, str(path))
    return data


def entries(folder: Path, skip: Collection[str] = ()) -> Iterator[tuple[str, str | None]]:
    """Yield the entries below a folder: relative POSIX path and, of no regular file, its kind.

    Links are named and not followed.

    Args:
        folder: where to look; none there is like an empty one.
        skip: names that are passed over.
    """
    pending = [""]
    while pending:
        inner = pending.pop()
        try:
            with os.scandir(folder / inner) as found:
                here = sorted((entry for entry in found if entry.name not in skip), key=_name)
        except (FileNotFoundError, NotADirectoryError):
            continue
        except OSError as refused:
            yield inner, f"a folder that cannot be read ({refused.strerror})"
            continue
        for entry in here:
            name = f"{inner}/{entry.name}" if inner else entry.name
            if entry.is_dir(follow_symlinks=False):
                pending.append(name)
            else:
                yield name, kind_of(folder / name)


def kind_of(path: Path) -> str | None:
    """Return the kind of the entry at a path, ``None`` for a regular file or nothing."""
    try:
        kind = stat.S_IFMT(path.lstat().st_mode)
    except OSError:
        return None
    return None if kind == stat.S_IFREG else _KINDS.get(kind, "no regular file")


def stays(root: Path, path: Path) -> bool:
    """Return whether a path, links followed, still lies below a folder."""
    return Path(os.path.realpath(path)).is_relative_to(os.path.realpath(root))


def _name(entry: os.DirEntry[str]) -> str:
    return entry.name


def _refuse(mode: int, path: str | Path) -> None:
    kind = stat.S_IFMT(mode)
    if kind == stat.S_IFDIR:
        raise IsADirectoryError(errno.EISDIR, os.strerror(errno.EISDIR), str(path))
    if kind != stat.S_IFREG:
        reason = f"it is {_KINDS.get(kind, 'no regular file')}, and only regular files are read"
        raise NotRegularError(errno.EINVAL, reason, str(path))


def is_relative(name: object) -> bool:
    """Return whether a value is a normalised relative POSIX path: no ``..``, root or blank part.

    The content of a ``.git`` belongs to git, which starts programs from there: nothing else may
    be written there.

    >>> is_relative("src/rover/EDDIInput.py"), is_relative("a/../b"), is_relative("/etc/passwd")
    (True, False, False)
    """
    return (
        isinstance(name, str)
        and bool(name)
        and name.isprintable()
        and "\\" not in name
        and not name.startswith("/")
        and all(part.lower() not in {"", ".", "..", ".git"} for part in name.split("/"))
    )


def inside(root: Path, name: object) -> Path | None:
    """Return the place of a relative path below a folder, ``None`` where it may lie elsewhere.

    Args:
        root: the folder.
        name: from a file; anything.

    Returns:
        ``None`` for a path that is not relative and normalised, or has a link among its parents
        below ``root``. The last part may be a link: it names the link, not its target.
    """
    if not is_relative(name):
        return None
    assert isinstance(name, str)
    folder = root
    for part in PurePosixPath(name).parts[:-1]:
        folder = folder / part
        if os.path.islink(folder):  # noqa: PTH114 - false for a name that no disk can hold
            return None
    return root / name
