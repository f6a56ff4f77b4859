"""What a command changed: every file below a folder, before and after."""

from __future__ import annotations

import hashlib
import os
import stat
from dataclasses import dataclass
from pathlib import Path


@dataclass(frozen=True)
class Seen:
    """One file, folder, link or special file."""

    kind: int
    mode: int
    mtime_ns: int
    content: str


def look(folder: Path) -> dict[str, Seen]:
    """Return everything at and below a folder; nothing special is opened, no link followed."""
    found = {".": _seen(folder)}
    for root, folders, files in os.walk(folder):
        for name in (*folders, *files):
            path = Path(root, name)
            found[path.relative_to(folder).as_posix()] = _seen(path)
    return found


def changes(before: dict[str, Seen], after: dict[str, Seen]) -> list[str]:
    """Return the paths of what differs."""
    return sorted(path for path in {*before, *after} if before.get(path) != after.get(path))


def _seen(path: Path) -> Seen:
    found = path.lstat()
    content = ""
    if stat.S_ISLNK(found.st_mode):
        content = str(path.readlink())
    elif stat.S_ISREG(found.st_mode) and found.st_size < 1 << 20:
        content = hashlib.sha256(path.read_bytes()).hexdigest()
    kind, mode = stat.S_IFMT(found.st_mode), stat.S_IMODE(found.st_mode)
    return Seen(kind, mode, found.st_mtime_ns, content)
