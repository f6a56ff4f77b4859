"""An update of Copier's that was killed: the next one must not take half of it for hand edits.

Copier records the new version in the answers before it has brought all files to it. A second update
would then start from the new version, and keep what is still old as a person's edit of it. So the
answers of before stay beside the package until the merge has ended, and are put back.
"""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

from .manifest import ANSWERS
from .store import EDDI, read_text, remove_file, write_file

_BEFORE = f"{EDDI}/updating.yml"


def begin_update(root: Path, hindrance: Callable[[], str | None]) -> str | None:
    """Keep the answers of before an update; return what to do where it cannot begin.

    Args:
        root: the package.
        hindrance: returns what else is in the way of an update that is not under way.
    """
    before, now = read_text(root / _BEFORE), read_text(root / ANSWERS)
    if isinstance(before, str) and before != now:
        write_file(root, ANSWERS, before.encode())
        return (
            "the last update was interrupted; the answers are again those that the files were made"
            " of: commit, and run the same update again"
        )
    if before is None and (found := hindrance()):
        return found
    if isinstance(now, str):
        write_file(root, _BEFORE, now.encode())
    return None


def end_update(root: Path) -> None:
    """Drop them: the package is at its answers."""
    remove_file(root / _BEFORE)
