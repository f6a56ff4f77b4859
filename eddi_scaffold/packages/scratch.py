"""The folder that a command renders and merges in: in memory where there is room.

A large upgrade makes thousands of small files and removes them again; on a disk that is half of
the time.
"""

from __future__ import annotations

import os
import shutil
import tempfile
from pathlib import Path

_MEMORY = Path("/dev/shm")  # noqa: S108 - `mkdtemp` makes a folder that only its user reads
_ENOUGH = 512 * 2**20
"""Five hundred packages need a quarter of it."""


def scratch_folder(prefix: str) -> tempfile.TemporaryDirectory[str]:
    """Make an empty folder that is gone at the end of the ``with``.

    ``TMPDIR`` says where, as for all temporary files.
    """
    return tempfile.TemporaryDirectory(prefix=prefix, dir=_memory())


def _memory() -> Path | None:
    """Return the RAM disk of Linux; ``None`` where it is missing or small, or none is wanted."""
    if any(os.environ.get(name) for name in ("TMPDIR", "TEMP", "TMP")):
        return None
    try:
        free = shutil.disk_usage(_MEMORY).free
    except OSError:
        return None
    return _MEMORY if free >= _ENOUGH and os.access(_MEMORY, os.W_OK | os.X_OK) else None
