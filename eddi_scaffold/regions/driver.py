"""The merge driver of git: merge two branches of an editable file, or of a record of a package.

Git runs it with three files: where the branches part, this branch and the other one; the result
goes into the second. Without it, or where it finds a conflict, git's own rules hold: the conflict
is marked and a person resolves it.
"""

from __future__ import annotations

import sys
from pathlib import Path

from .bases import BASES
from .branches import (
    Joined,
    join_bases,
    join_branches,
    join_manifests,
    join_renderings,
    join_text,
)
from .files import read_regular
from .manifest import MANIFEST
from .store import EDDI, without_sentinel

CONFLICT = 1


def merge_driver(base: Path, ours: Path, theirs: Path, path: str) -> int:
    """Write the merged text into ``ours``.

    Args:
        base: the file where the branches part; empty when both added it.
        ours: the file of this branch.
        theirs: the file of the other branch.
        path: where it is in the repository.

    Returns:
        0, or 1 when a person must resolve a conflict.
    """
    try:
        texts = [read_regular(file).decode() for file in (base, ours, theirs)]
    except (OSError, UnicodeDecodeError) as problem:
        sys.stderr.write(f"{path}: not merged: {problem}\n")
        return CONFLICT
    joined = _join(path, *texts)
    ours.write_bytes(joined.text.encode())
    return CONFLICT if joined.conflict else 0


def _join(path: str, base: str, ours: str, theirs: str) -> Joined:
    _, inside, record = f"/{path}".rpartition(f"/{EDDI}/")
    folder, _, file = record.partition("/")
    if not inside:
        return join_branches(path, base, ours, theirs)
    if record == BASES:
        return Joined(join_bases(base, ours, theirs), conflict=False)
    if folder == "pristine":
        return Joined(_rendered(file, base, ours, theirs), conflict=False)
    if record == MANIFEST:
        merged = join_manifests(base, ours, theirs)
        if merged is not None:
            return Joined(merged, conflict=False)
    return join_text(base, ours, theirs)


def _rendered(path: str, base: str, ours: str, theirs: str) -> str:
    """Return what Copier rendered; that of two branches ends like an interrupted rendering.

    Then nothing takes it for a rendering, and the next one puts it right.
    """
    if base in {ours, theirs} or ours == theirs:
        return theirs if base == ours else ours
    return join_renderings(path, *(without_sentinel(text) or text for text in (base, ours, theirs)))
