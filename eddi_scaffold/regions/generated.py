"""Files that must not be edited: each is put in its place after a look at what is there.

Copier renders them below ``.eddi/generated`` only, which git ignores and ``sync`` empties. So it
has nothing of a person's to write over, to merge with or to remove, whatever its command; what lies
in the place of such a file and was not written here is copied to ``.eddi/rejects`` first.
"""

from __future__ import annotations

import os
from collections.abc import Container, Sequence
from contextlib import suppress
from pathlib import Path

from .bases import read_bases
from .files import kind_of, read_regular
from .manifest import (
    ANSWERS,
    Digests,
    digests_of,
    is_of_old_layout,
    record_files,
    recorded_files,
)
from .paths import inside, is_relative
from .result import Note
from .store import (
    EDDI,
    PRISTINE,
    ChangedMeanwhileError,
    discard,
    files_below,
    remove_file,
    save_reject,
    write_file,
)

GENERATED = f"{EDDI}/generated"
"""Folder into which Copier renders the files that must not be edited."""
_NOT_FORMATTED = b"# fmt: off\n"
"""Black, ruff, yapf and autopep8 obey it."""
_LEFT = "it is left alone, and should be as generated: {}"


def listed_generated(root: Path) -> list[str]:
    """Return the generated-only files that Copier has rendered and ``sync`` not yet placed."""
    editable = read_bases(root)
    return [name for name in files_below(root / GENERATED) if _is_place(root, name, editable)]


def recorded_generated(root: Path) -> list[str]:
    """Return the generated-only files of the last finished rendering."""
    return sorted(recorded_files(root))


def is_placed(root: Path) -> bool:
    """Return whether all generated-only files of the last rendering are in their places."""
    recorded = recorded_files(root)
    return (
        bool(recorded)
        and not listed_generated(root)
        and all(kind_of(root / name) is None and (root / name).exists() for name in recorded)
        and not changed_generated(root)
    )


def changed_generated(root: Path) -> list[str]:
    """Return the generated-only files that differ from the last rendering in more than layout."""
    return [
        name for name, was in sorted(recorded_files(root).items()) if _is_changed(root, name, was)
    ]


def place_generated(root: Path) -> list[Note]:
    """Bring the generated-only files to their renderings, and record what was written.

    Args:
        root: the package.

    Returns:
        What was kept of a person's text, and what could not be written.
    """
    names, before = listed_generated(root), recorded_files(root)
    behind = [
        name
        for name in files_below(root / GENERATED)
        if is_relative(name) and inside(root, name) is None
    ]
    if not (root / GENERATED).is_dir() or not (names or before or behind):
        return []  # all was placed, or the folder was lost and tells nothing
    written: dict[str, Digests] = {}
    notes = [Note(name, None, _LEFT.format("its folder is a link")) for name in behind]
    whole = not behind
    editable = read_bases(root)
    gone = sorted(name for name in before.keys() - names if _is_place(root, name, editable))
    for name in [*names, *gone]:
        new = as_placed(name, read_regular(root / GENERATED / name)) if name in names else None
        was = before.get(name)
        if new is not None:
            written[name] = digests_of(name, new, was)
        try:
            ours = [one for one in (was, written.get(name)) if one is not None]
            notes += _place(root, name, new, ours, known=was is not None)
        except OSError as problem:
            if new is None:
                continue
            whole = False
            notes.append(Note(name, None, _LEFT.format(problem.strerror or problem)))
    record_files(root, written)
    if whole:
        discard(root, GENERATED)
    return notes


def as_placed(name: str, rendering: bytes) -> bytes:
    """Return what is written for a rendering: Python tells formatters to leave it as it is."""
    if not name.endswith(".py"):
        return rendering
    start = rendering.find(b"\n") + 1 if rendering.startswith(b"#!") else 0
    return rendering[:start] + _NOT_FORMATTED + rendering[start:]


def keep_edits_of_old_layout(root: Path) -> None:
    """Copy edited generated-only files before `copier update` removes them.

    Up to version 0.1 Copier itself rendered them in their places, so the first update to this
    layout removes them all.
    """
    if is_of_old_layout(root):
        for name in changed_generated(root):
            save_reject(root, name, read_regular(root / name), ".edited")


def _place(
    root: Path, name: str, new: bytes | None, ours: Sequence[Digests], known: bool
) -> list[Note]:
    path, data = root / name, _present(root / name)
    notes = []
    if data is not None and data != new and not any(one.fit(name, data) for one in ours):
        copy = save_reject(root, name, data, ".edited").relative_to(root)
        why = "was" if known else "it lies where one of the generator's belongs"
        notes = [Note(name, None, f"must not be edited, but {why}: your text is kept in {copy}")]

    def unchanged() -> None:
        if _present(path) != data:
            raise ChangedMeanwhileError("it was saved meanwhile")

    if new is not None:
        like = f"{GENERATED}/{name}"
        write_file(root, name, new, like, unchanged, durable=False)  # it can be rendered again
        mode, model = path.stat().st_mode, (root / like).stat().st_mode
        if model & 0o100 and not mode & 0o100:
            path.chmod(mode | (mode & 0o444) >> 2)
    elif data is not None:
        unchanged()
        remove_file(path)
        with suppress(OSError):
            for folder in list(path.relative_to(root).parents)[:-1]:
                (root / folder).rmdir()
    return notes


def _present(path: Path) -> bytes | None:
    """Return the bytes of what lies in a place; a link or a special file is not looked into."""
    kind = kind_of(path)
    if kind is not None:
        raise OSError(f"it is {kind}")
    try:
        return read_regular(path, follow=False)
    except (FileNotFoundError, NotADirectoryError):
        return None


def _is_changed(root: Path, name: str, was: Digests) -> bool:
    try:
        return not was.fit(name, read_regular(root / name))
    except OSError:
        return False


def _is_place(root: Path, name: str, editable: Container[str]) -> bool:
    """Return whether a generated-only file may have this name, which comes from a record."""
    if name.partition("/")[0] in {EDDI, ANSWERS} or inside(root, name) is None:
        return False
    place = root / PRISTINE / name
    return name not in editable and not os.path.exists(place)  # noqa: PTH110 - false for any name
