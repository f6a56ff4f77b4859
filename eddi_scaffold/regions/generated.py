"""Files that must not be edited: each is put in its place after a look at what is there.

Copier renders them below ``.eddi/generated`` only. So it has nothing of a person's to write over,
to merge with or to remove, whatever its command; what lies in the place of such a file and was not
written here is copied to ``.eddi/rejects`` first.
"""

from __future__ import annotations

import hashlib
import json
import os
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path

from .files import kind_of, read_regular
from .formatting import same_text
from .paths import inside
from .result import Note
from .store import (
    EDDI,
    ChangedMeanwhileError,
    files_below,
    read_text,
    remove_file,
    save_reject,
    write_file,
)

GENERATED = f"{EDDI}/generated"
"""Folder with the newest rendering of each file that must not be edited."""
MANIFEST = "manifest.json"
ANSWERS = ".copier-answers.yml"
"""File of a package in which Copier keeps the answers."""
_LAYOUT = b" \t\r\n'\"(),\\"
_LOWER = bytes(range(256)).lower()
"""With these characters and upper case formatters do what they do, in every version of Python."""


def listed_generated(root: Path) -> list[str]:
    """Return the generated-only files of the newest rendering."""
    return [name for name in files_below(root / GENERATED) if _is_place(root, name)]


def recorded_generated(root: Path) -> list[str]:
    """Return the generated-only files of the last finished rendering."""
    return sorted(_recorded(root))


def is_placed(root: Path) -> bool:
    """Return whether the last rendering of the generated-only files is whole, and in place."""
    recorded = _recorded(root)
    return (
        bool(recorded)
        and sorted(recorded) == listed_generated(root)
        and all(_digest(root / GENERATED / name) == was for name, was in recorded.items())
        and all(kind_of(root / name) is None and (root / name).exists() for name in recorded)
        and not changed_generated(root)
    )


def changed_generated(root: Path) -> list[str]:
    """Return the generated-only files that differ from the last rendering in more than layout."""
    return [
        name
        for name, digest in sorted(_recorded(root).items())
        if _digest(root / name) not in {digest, None} and not _is_reformatted(root, name)
    ]


def place_generated(root: Path, committed: Callable[[str], str | None]) -> list[Note]:
    """Bring the generated-only files to their renderings, and record what was written.

    Args:
        root: the package.
        committed: text of a file before this rendering, if it is known.

    Returns:
        What was kept of a person's text, and what could not be written.
    """
    names, before = listed_generated(root), _recorded(root)
    if not (root / GENERATED).is_dir() or not (names or before):
        return []  # where the folder was lost, it tells nothing
    written = {}
    notes: list[Note] = []
    gone = sorted(name for name in before.keys() - names if _is_place(root, name))
    for name in [*names, *gone]:
        new = read_regular(root / GENERATED / name) if name in names else None
        if new is not None:
            written[name] = hashlib.sha256(new).hexdigest()
        try:
            notes += _place(root, name, new, before.get(name), committed)
        except OSError as problem:
            if new is None:
                continue
            text = f"it is left alone, and should be as generated: {problem.strerror or problem}"
            notes.append(Note(name, None, text))
    record = {"rendering": rendering_digest(root), "sha256": written}
    text = json.dumps(record, indent=1, sort_keys=True) + "\n"
    write_file(root, f"{EDDI}/{MANIFEST}", text.encode())
    return notes


def rendering_digest(root: Path) -> str:
    """Return the SHA-256 of a package's answers and of the renderings that its files were made of.

    Without where the templates lie, and without what a formatter changes.
    """
    text = read_text(root / ANSWERS)
    kept, origin = [], False
    for line in (text if isinstance(text, str) else "").split("\n"):
        origin = line.startswith("_src_path") or (origin and line[:1] in {" ", "\r", ""})
        if not origin:
            kept.append(line)
    digest = hashlib.sha256("\n".join(kept).encode().translate(_LOWER, _LAYOUT))
    for name in files_below(root / EDDI / "base"):
        data = read_regular(root / EDDI / "base" / name)
        digest.update(b"\0" + os.fsencode(name) + b"\0" + data.translate(_LOWER, _LAYOUT))
    return digest.hexdigest()


def recorded_rendering(root: Path) -> str:
    """Return the same of the last finished rendering, empty without one."""
    return str(_manifest(root).get("rendering") or "")


def keep_edits_of_old_layout(root: Path) -> None:
    """Copy edited generated-only files before `copier update` removes them.

    Up to version 0.1 Copier itself rendered them in their places, so the first update to this
    layout removes them all.
    """
    if not (root / GENERATED).is_dir():
        for name in changed_generated(root):
            save_reject(root, name, read_regular(root / name), ".edited")


def _place(
    root: Path,
    name: str,
    new: bytes | None,
    recorded: str | None,
    committed: Callable[[str], str | None],
) -> list[Note]:
    path, data = root / name, _present(root / name)
    notes = []
    if data is not None and data != new and not _is_ours(name, data, new, recorded, committed):
        copy = save_reject(root, name, data, ".edited").relative_to(root)
        why = "was" if recorded is not None else "it lies where one of the generator's belongs"
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


def _is_ours(
    name: str,
    data: bytes,
    new: bytes | None,
    recorded: str | None,
    committed: Callable[[str], str | None],
) -> bool:
    if hashlib.sha256(data).hexdigest() == recorded:
        return True
    old = committed(f"{GENERATED}/{name}")
    renderings = (new, old.encode() if old is not None else None)
    return any(one is not None and same_text(name, data, one) for one in renderings)


def _is_reformatted(root: Path, name: str) -> bool:
    try:
        mine, ours = (read_regular(path) for path in (root / name, root / GENERATED / name))
    except OSError:
        return False
    return same_text(name, mine, ours)


def _is_place(root: Path, name: str) -> bool:
    """Return whether a generated-only file may have this name, which comes from a record."""
    if name.partition("/")[0] in {EDDI, ANSWERS} or inside(root, name) is None:
        return False
    return not os.path.exists(root / EDDI / "pristine" / name)  # noqa: PTH110 - false for any name


def _recorded(root: Path) -> dict[str, str]:
    found = _manifest(root).get("sha256")
    names = found if isinstance(found, dict) else {}
    return {name: str(digest) for name, digest in names.items() if inside(root, name)}


def _manifest(root: Path) -> dict[str, object]:
    text = read_text(root / EDDI / MANIFEST)
    try:
        found = json.loads(text) if isinstance(text, str) else {}
    except (ValueError, RecursionError):
        return {}
    return found if isinstance(found, dict) else {}


def _digest(path: Path) -> str | None:
    try:
        return hashlib.sha256(read_regular(path)).hexdigest()
    except OSError:
        return None
