"""Files that must not be edited: each is put in its place after a look at what is there.

Copier renders them below ``.eddi/generated`` only, which git ignores and ``sync`` empties. So it
has nothing of a person's to write over, to merge with or to remove, whatever its command; what lies
in the place of such a file and was not written here is copied to ``.eddi/rejects`` first.
"""

from __future__ import annotations

import hashlib
import json
import os
import shutil
from collections.abc import Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path

from .files import kind_of, read_regular
from .formatting import meaning_digest
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
"""Folder into which Copier renders the files that must not be edited."""
_PLACED = f"{EDDI}/placed"
"""What it is called while it is removed: half of it must not pass for a rendering."""
MANIFEST = "manifest.json"
ANSWERS = ".copier-answers.yml"
"""File of a package in which Copier keeps the answers."""
_NOT_FORMATTED = b"# fmt: off\n"
"""Black, ruff, yapf and autopep8 obey it."""
_LAYOUT = b" \t\r\n'\"(),\\"
_LOWER = bytes(range(256)).lower()
"""With these characters and upper case formatters do what they do, in every version of Python."""


@dataclass(frozen=True)
class Digests:
    """What is recorded of a rendering: the SHA-256 of its bytes and, of Python, of its meaning."""

    text: str
    meaning: str | None = None

    def fit(self, name: str, data: bytes) -> bool:
        """Return whether a text is this rendering, but for line ends and the layout of Python."""
        if self.text == _sha256(data):
            return True
        plain = data.replace(b"\r\n", b"\n")
        return self.text == _sha256(plain) or (
            self.meaning is not None and self.meaning == _meaning(name, plain)
        )


def digests_of(name: str, data: bytes) -> Digests:
    """Return what is recorded of a rendering."""
    return Digests(_sha256(data), _meaning(name, data))


def listed_generated(root: Path) -> list[str]:
    """Return the generated-only files that Copier has rendered and ``sync`` not yet placed."""
    return [name for name in files_below(root / GENERATED) if _is_place(root, name)]


def recorded_generated(root: Path) -> list[str]:
    """Return the generated-only files of the last finished rendering."""
    return sorted(_recorded(root))


def is_placed(root: Path) -> bool:
    """Return whether all generated-only files of the last rendering are in their places."""
    recorded = _recorded(root)
    return (
        bool(recorded)
        and not listed_generated(root)
        and all(kind_of(root / name) is None and (root / name).exists() for name in recorded)
        and not changed_generated(root)
    )


def changed_generated(root: Path) -> list[str]:
    """Return the generated-only files that differ from the last rendering in more than layout."""
    return [name for name, was in sorted(_recorded(root).items()) if _is_changed(root, name, was)]


def place_generated(root: Path) -> list[Note]:
    """Bring the generated-only files to their renderings, and record what was written.

    Args:
        root: the package.

    Returns:
        What was kept of a person's text, and what could not be written.
    """
    shutil.rmtree(root / _PLACED, ignore_errors=True)
    names, before = listed_generated(root), _recorded(root)
    if not (root / GENERATED).is_dir() or not (names or before):
        return []  # all was placed, or the folder was lost and tells nothing
    written: dict[str, Digests] = {}
    notes: list[Note] = []
    whole = True
    gone = sorted(name for name in before.keys() - names if _is_place(root, name))
    for name in [*names, *gone]:
        new = as_placed(name, read_regular(root / GENERATED / name)) if name in names else None
        was = before.get(name)
        if new is not None:
            written[name] = _same(was, new) or digests_of(name, new)
        try:
            ours = [one for one in (was, written.get(name)) if one is not None]
            notes += _place(root, name, new, ours, known=was is not None)
        except OSError as problem:
            if new is None:
                continue
            whole = False
            text = f"it is left alone, and should be as generated: {problem.strerror or problem}"
            notes.append(Note(name, None, text))
    _write_manifest(root, written)
    if whole:
        (root / GENERATED).rename(root / _PLACED)
        shutil.rmtree(root / _PLACED)
    return notes


def as_placed(name: str, rendering: bytes) -> bytes:
    """Return what is written for a rendering: Python tells formatters to leave it as it is."""
    if not name.endswith(".py"):
        return rendering
    start = rendering.find(b"\n") + 1 if rendering.startswith(b"#!") else 0
    return rendering[:start] + _NOT_FORMATTED + rendering[start:]


def _write_manifest(root: Path, written: Mapping[str, Digests]) -> None:
    record = {
        "meaning": {name: one.meaning for name, one in written.items() if one.meaning is not None},
        "rendering": rendering_digest(root),
        "sha256": {name: one.text for name, one in written.items()},
    }
    text = json.dumps(record, indent=1, sort_keys=True) + "\n"
    write_file(root, f"{EDDI}/{MANIFEST}", text.encode())


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
    if "meaning" not in _manifest(root):
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


def _same(was: Digests | None, new: bytes) -> Digests | None:
    """Return the digests of before where they are of the same text: those of Python take time."""
    return was if was is not None and was.meaning and was.text == _sha256(new) else None


def _meaning(name: str, data: bytes) -> str | None:
    return meaning_digest(data) if name.endswith(".py") else None


def _sha256(data: bytes) -> str:
    return hashlib.sha256(data).hexdigest()


def _is_place(root: Path, name: str) -> bool:
    """Return whether a generated-only file may have this name, which comes from a record."""
    if name.partition("/")[0] in {EDDI, ANSWERS} or inside(root, name) is None:
        return False
    return not os.path.exists(root / EDDI / "pristine" / name)  # noqa: PTH110 - false for any name


def _recorded(root: Path) -> dict[str, Digests]:
    record = _manifest(root)
    texts, meanings = (
        part if isinstance(part := record.get(key), dict) else {} for key in ("sha256", "meaning")
    )
    return {
        name: Digests(str(digest), str(meanings[name]) if name in meanings else None)
        for name, digest in texts.items()
        if inside(root, name)
    }


def _manifest(root: Path) -> dict[str, object]:
    text = read_text(root / EDDI / MANIFEST)
    try:
        found = json.loads(text) if isinstance(text, str) else {}
    except (ValueError, RecursionError):
        return {}
    return found if isinstance(found, dict) else {}
