"""This user's own folder for what several runs must know: nobody else's word counts there."""

from __future__ import annotations

import errno
import hashlib
import os
from pathlib import Path

_OTHERS_WRITE = 0o022


def shelf(name: str) -> Path:
    """Return the folder for one purpose; it need not be there.

    Raises:
        OSError: this user has no home.
    """
    try:
        places = (Path(os.environ.get("XDG_STATE_HOME", "")), Path("~/.local/state").expanduser())
        state = next(place for place in places if place.is_absolute())
    except (RuntimeError, StopIteration):
        raise FileNotFoundError(errno.ENOENT, "there is no home folder", "~") from None
    return state / "eddi-scaffold" / name


def made_shelf(name: str) -> Path:
    """Return the same folder, made for this user alone.

    Raises:
        OSError: it cannot be made, or others may write there.
    """
    folder = shelf(name)
    folder.mkdir(mode=0o700, parents=True, exist_ok=True)
    refuse_shared(folder.stat(), folder)
    return folder


def key_of(folder: Path) -> str:
    """Return what names a folder of a workspace there, by whatever path it is reached."""
    return hashlib.sha256(os.fsencode(os.path.realpath(folder))).hexdigest()[:32]


def refuse_shared(status: os.stat_result, place: Path) -> None:
    """Refuse what another user owns or may write: it would be his word.

    Raises:
        PermissionError: it is so.
    """
    if status.st_uid != os.geteuid() or status.st_mode & _OTHERS_WRITE:
        raise PermissionError(errno.EPERM, "other users may write there", str(place))
