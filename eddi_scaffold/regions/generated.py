"""Files that must not be edited: detect edits, and keep a copy."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Iterable
from pathlib import Path

from eddi_scaffold.regions.files import read_regular
from eddi_scaffold.regions.paths import inside, is_relative
from eddi_scaffold.regions.store import (
    EDDI,
    SENTINEL,
    read_text,
    save_reject,
    without_sentinel,
    write_file,
)

GENERATED = "generated.txt"
"""File of a package's records that every rendering has."""
MANIFEST = "manifest.json"
_EDITED = "edited.txt"
ANSWERS = ".copier-answers.yml"
"""File of a package in which Copier keeps the answers."""


def listed_generated(root: Path) -> list[str]:
    """Return the generated-only files that the template lists, empty when it was interrupted.

    A listed name may be a pattern such as ``src/**/*.py``.
    """
    text = read_text(root / EDDI / GENERATED)
    plain = without_sentinel(text) if isinstance(text, str) else None
    lines = {line.strip() for line in (plain or "").split("\n") if line.strip()}
    return sorted({name for line in lines for name in _matching(root, line)})


def recorded_generated(root: Path) -> list[str]:
    """Return the generated-only files of the last finished rendering."""
    return sorted(_recorded(root))


def note_edits(root: Path) -> None:
    """Remember, before `copier update`, which generated-only files a person edited.

    Copier merges such edits into the new rendering; without the note they would pass as generated.
    """
    note = root / EDDI / _EDITED
    names = changed_generated(root)
    if names:
        write_file(root, f"{EDDI}/{_EDITED}", ("\n".join(names) + "\n").encode())
    else:
        note.unlink(missing_ok=True)


def record_generated(root: Path) -> bool:
    """Store the digests of the generated-only files; returns whether the record changed.

    A file that was noted as edited gets an empty digest: it differs from every rendering.
    """
    note = root / EDDI / _EDITED
    noted = read_text(note)
    edited = set(noted.split("\n")) if isinstance(noted, str) else set()
    edited |= {name for name, digest in _recorded(root).items() if not digest}
    digests = {
        name: "" if name in edited else digest
        for name in listed_generated(root)
        if (digest := _digest(root / name))
    }
    if not digests:
        return False
    record = {"answers": answers_digest(root), "sha256": digests}
    text = json.dumps(record, indent=1, sort_keys=True) + "\n"
    changed = write_file(root, f"{EDDI}/{MANIFEST}", text.encode())
    note.unlink(missing_ok=True)
    return changed


def answers_digest(root: Path) -> str:
    """Return the SHA-256 of a package's answers, without where the templates lay."""
    text = read_text(root / ANSWERS)
    kept, origin = [], False
    for line in (text if isinstance(text, str) else "").split("\n"):
        origin = line.startswith("_") or (origin and line[:1] in {" ", ""})
        if not origin:
            kept.append(line)
    return hashlib.sha256("\n".join(kept).encode()).hexdigest()


def recorded_answers(root: Path) -> str:
    """Return the digest of the answers of the last finished rendering, empty without one."""
    return str(_manifest(root).get("answers", ""))


def changed_generated(root: Path) -> list[str]:
    """Return the generated-only files whose bytes differ from the last rendering."""
    return [
        name
        for name, digest in sorted(_recorded(root).items())
        if _digest(root / name) not in {digest, None}
    ]


def forget_generated(root: Path) -> None:
    """Drop the record, because every generated-only file is about to be rendered anew."""
    (root / EDDI / MANIFEST).unlink(missing_ok=True)
    (root / EDDI / _EDITED).unlink(missing_ok=True)


def save_generated_edits(root: Path, paths: Iterable[str] | None = None) -> list[Path]:
    """Copy edited generated-only files to ``.eddi/rejects/<path>.edited`` before a new rendering.

    Args:
        root: the package.
        paths: files to keep; by default those of :func:`changed_generated`.

    Returns:
        Where the copies are.
    """
    names = changed_generated(root) if paths is None else list(paths)
    return [save_reject(root, name, read_regular(root / name), ".edited") for name in names]


def replace_generated(root: Path, name: str, data: bytes) -> None:
    """Write a generated-only file; text that a person put there is kept in ``.eddi/rejects``.

    For files that Copier does not render, so that it has not merged the person's text either.
    """
    if name in changed_generated(root):
        save_generated_edits(root, [name])
    write_file(root, name, data)
    note = root / EDDI / _EDITED
    noted = read_text(note)
    if isinstance(noted, str) and name in noted.split("\n"):
        rest = [one for one in noted.split("\n") if one and one != name]
        write_file(root, f"{EDDI}/{_EDITED}", "".join(f"{one}\n" for one in rest).encode())


def _matching(root: Path, line: str) -> list[str]:
    if "*" not in line or not is_relative(line):
        names = [line]
    else:
        names = [path.relative_to(root).as_posix() for path in root.glob(line) if path.is_file()]
    return [name for name in names if inside(root, name)]


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


__all__ = [
    "ANSWERS",
    "GENERATED",
    "MANIFEST",
    "SENTINEL",
    "answers_digest",
    "changed_generated",
    "forget_generated",
    "listed_generated",
    "note_edits",
    "record_generated",
    "recorded_answers",
    "recorded_generated",
    "replace_generated",
    "save_generated_edits",
]
