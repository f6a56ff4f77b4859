"""Paths that come out of files: of a package's records, of answers, of a journal.

Such a file may be a stranger's. A path in it is used only when it is the normalised, relative form
of a place below the folder that it is about, and no link on the way leads out of that folder.
"""

from __future__ import annotations

import os
from pathlib import Path, PurePosixPath


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
