"""What a killed run has left to finish: records in the user's own folder, none in the workspace.

A workspace may come from anywhere, and a folder in it may look like ours. So nothing in it decides
what to do: the record does, which only this user can write, with the workspace's place and the
digest of each staged text.
"""

from __future__ import annotations

import json
import os
import tempfile
from collections.abc import Sequence
from contextlib import suppress
from dataclasses import astuple, dataclass
from pathlib import Path

from eddi_scaffold.regions.files import open_regular
from eddi_scaffold.regions.paths import is_relative
from eddi_scaffold.regions.state import key_of, made_shelf, refuse_shared, shelf

_SHELF = "unfinished"


@dataclass(frozen=True)
class JournalEntry:
    """One change of a transaction.

    Attributes:
        path: the file, relative to the root.
        staged: name of its new text, ``None`` to remove it.
        new: digest of that text.
        old: digest of the text that is replaced, ``None`` when there was no file.
        follows: files without whose changes this one makes no sense.
    """

    path: str
    staged: str | None
    new: str | None
    old: str | None
    follows: Sequence[str] = ()


def keep(root: Path, staging: str, steps: Sequence[JournalEntry] | None) -> str | None:
    """Record how far a transaction is.

    Args:
        root: folder that it changes.
        staging: folder in it that holds the new texts.
        steps: what is decided; ``None`` while the texts are being staged.

    Returns:
        Why there is no record, ``None`` when there is one.
    """
    decided = None if steps is None else [astuple(step) for step in steps]
    text = json.dumps({"root": os.path.realpath(root), "steps": decided})
    try:
        made_shelf(_SHELF)
        _replace(_place(root, staging), text.encode())
    except OSError as refused:
        forget(root, staging)
        return f"{refused.filename}: {refused.strerror or refused}"
    return None


def forget(root: Path, staging: str) -> None:
    """Drop the record of a transaction that is finished or was given up."""
    with suppress(OSError):
        _place(root, staging).unlink()


def records(root: Path) -> dict[str, Sequence[JournalEntry] | None]:
    """Return the transactions below ``root`` that runs of this user left: staging -> steps."""
    start = key_of(root)
    found: dict[str, Sequence[JournalEntry] | None] = {}
    for place in _places(start):
        # what cannot be read, or is another's, is not a record
        with suppress(OSError, ValueError, TypeError, KeyError):
            steps = _read(place, root)
            found[place.name.removeprefix(start).removesuffix(".json")] = steps
    return found


def _read(place: Path, root: Path) -> Sequence[JournalEntry] | None:
    refuse_shared(place.parent.stat(), place.parent)
    with open_regular(place, follow=False) as stream:
        refuse_shared(os.fstat(stream.fileno()), place)
        record = json.loads(stream.read())
    if record["root"] != os.path.realpath(root):
        raise ValueError("a record of another folder")
    steps = None if record["steps"] is None else [JournalEntry(*step) for step in record["steps"]]
    for step in steps or ():
        if not (is_relative(step.path) and (step.staged is None or step.staged.isdigit())):
            raise ValueError("a path that leads elsewhere")
    return steps


def _places(start: str) -> list[Path]:
    try:
        return sorted(shelf(_SHELF).glob(f"{start}*.json"))
    except OSError:
        return []


def _place(root: Path, staging: str) -> Path:
    return shelf(_SHELF) / f"{key_of(root)}{staging}.json"


def _replace(place: Path, data: bytes) -> None:
    with tempfile.NamedTemporaryFile(dir=place.parent, delete=False) as file:
        try:
            file.write(data)
            file.flush()
            os.fsync(file.fileno())
            Path(file.name).replace(place)
        except BaseException:
            Path(file.name).unlink(missing_ok=True)
            raise
    folder = os.open(place.parent, os.O_RDONLY)
    try:
        os.fsync(folder)  # before anything is replaced in the workspace
    finally:
        os.close(folder)
