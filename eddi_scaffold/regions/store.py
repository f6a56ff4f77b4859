"""Files of a package: read them, replace them atomically, keep what has no place.

Layout below ``.eddi/``: ``pristine/F`` (Copier's rendering of F), ``base/F`` (the rendering of the
last finished sync), ``next/F`` (what becomes the base of a sync under way), ``orphans/<id>``
(bodies without a region), ``rejects/F.patch`` (outside edits without a place).
"""

from __future__ import annotations

import hashlib
import json
import os
import re
import subprocess
from collections.abc import Iterator
from contextlib import suppress
from pathlib import Path, PurePosixPath
from urllib.parse import quote

from eddi_scaffold.regions.document import Fault
from eddi_scaffold.regions.markers import decode_id, encode_id
from eddi_scaffold.regions.result import Orphan

EDDI = ".eddi"
SENTINEL = "eddi-scaffold: end of rendering"
_TEMPORARY = ".eddi-tmp"
_SENTINEL_LINE = re.compile(rf"^[ \t]*(?:#|<!--)\s*{SENTINEL}\s*(?:-->)?\s*\Z", re.MULTILINE)
_HEAD = "# eddi-scaffold: saved body of a region that is gone; it comes back with the region"


def files_below(folder: Path) -> list[str]:
    """Return the files below a folder, relative to it, sorted; empty when there is none."""
    return sorted(
        path.relative_to(folder).as_posix()
        for path in folder.rglob("*")
        if path.is_file() and not path.name.endswith(_TEMPORARY)
    )


def read_text(path: Path) -> str | Fault | None:
    """Return a file's text with its line ends, ``None`` without the file, else what is wrong."""
    try:
        return path.read_bytes().decode()
    except FileNotFoundError:
        return None
    except UnicodeDecodeError as problem:
        line = path.read_bytes()[: problem.start].count(b"\n") + 1
        return Fault(line, "the file is not UTF-8; convert it")
    except OSError as problem:
        return Fault(1, f"cannot read the file: {problem.strerror}")


def without_sentinel(text: str) -> str | None:
    """Return a rendering without its last line, ``None`` when the rendering was interrupted."""
    match = _SENTINEL_LINE.search(text)
    return text[: match.start()] if match else None


def write_file(path: Path, data: bytes, like: Path | None = None) -> bool:
    """Replace a file in one step; readers and a killed process see the old or the new one.

    Args:
        path: the file; a link is followed.
        data: its new bytes.
        like: file whose mode a new file gets.

    Returns:
        Whether there was anything to do.

    Raises:
        OSError: the disk is full or the folder not writable; the old file stays.
    """
    path = Path(os.path.realpath(path))
    with suppress(OSError):
        if path.read_bytes() == data:
            return False
    path.parent.mkdir(parents=True, exist_ok=True)
    temporary = path.with_name(f".{path.name}{_TEMPORARY}")
    try:
        with temporary.open("wb") as file:
            file.write(data)
            file.flush()
            os.fsync(file.fileno())
        model = path if path.exists() else like
        if model is not None and model.exists():
            temporary.chmod(model.stat().st_mode & 0o7777)
        os.replace(temporary, path)  # noqa: PTH105 - one name for the step that commits
    except OSError:
        with suppress(OSError):
            temporary.unlink()
        raise
    _sync_folder(path.parent)
    return True


def remove_file(path: Path) -> bool:
    """Remove a file and the folders below ``.eddi`` that it leaves empty."""
    try:
        os.unlink(path)  # noqa: PTH108 - the counterpart of os.replace
    except FileNotFoundError:
        return False
    folder = path.parent
    with suppress(OSError):
        while EDDI in folder.parts:
            folder.rmdir()
            folder = folder.parent
    return True


def clean_temporaries(root: Path, paths: list[str]) -> None:
    """Remove what a killed process left beside the files that sync writes."""
    found = set((root / EDDI).rglob(f".*{_TEMPORARY}"))
    for name in paths:
        path = Path(os.path.realpath(root / name))
        found.add(path.with_name(f".{path.name}{_TEMPORARY}"))
    for path in found:
        path.unlink(missing_ok=True)


def load_orphans(root: Path) -> dict[Path, Orphan]:
    """Return the saved bodies by file, in the order in which they were saved per id."""
    folder = root / EDDI / "orphans"
    found = {}
    for name in sorted(files_below(folder), key=_numbered_last):
        text = read_text(folder / name)
        orphan = _read_orphan(text) if isinstance(text, str) else None
        if orphan is not None:
            found[folder / name] = orphan
    return found


def save_orphan(root: Path, orphan: Orphan) -> Path:
    """Save a body; a different body of the same id is never replaced."""
    head = [
        _HEAD,
        f"# region: {encode_id(orphan.id)}",
        f"# file: {encode_id(orphan.file)}",
        f"# sig: {orphan.sig or '-'}",
        f"# indent: {json.dumps(orphan.indent)}",
        "# ---",
    ]
    data = ("\n".join(head) + "\n" + orphan.body).encode()
    name = quote(orphan.id, safe="")
    if len(name) > 200:
        name = f"{name[:150]}-{hashlib.sha256(orphan.id.encode()).hexdigest()[:16]}"
    return _save_numbered(root / EDDI / "orphans", f"{name}{{}}", "~{}", data)


def save_reject(root: Path, path: str, data: bytes, suffix: str = ".patch") -> Path:
    """Save an edit without a place below ``.eddi/rejects``; never replaces a different one."""
    place = root / EDDI / "rejects" / path
    return _save_numbered(place.parent, f"{place.name}{{}}{suffix}", ".{}", data)


def committed_text(root: Path, path: str) -> str | None:
    """Return a file's text in the last commit, ``None`` without git or without the file."""
    data = committed_bytes(root, path)
    try:
        return data.decode() if data is not None else None
    except UnicodeDecodeError:
        return None


def committed_bytes(root: Path, path: str) -> bytes | None:
    """Return a file's bytes in the last commit, ``None`` without git or without the file."""
    try:
        done = subprocess.run(
            ["git", "-C", str(root), "show", f"HEAD:./{PurePosixPath(path)}"],
            capture_output=True,
            check=False,
            stdin=subprocess.DEVNULL,
        )
    except OSError:
        return None
    return done.stdout if done.returncode == 0 else None


def _save_numbered(folder: Path, pattern: str, number: str, data: bytes) -> Path:
    for name in _names(pattern, number):
        path = folder / name
        if not path.exists():
            write_file(path, data)
        elif path.read_bytes() != data:
            continue
        return path
    raise AssertionError("names never run out")


def _names(pattern: str, number: str) -> Iterator[str]:
    yield pattern.replace("{}", "")
    count = 2
    while True:
        yield pattern.replace("{}", number.replace("{}", str(count)))
        count += 1


def _numbered_last(name: str) -> tuple[str, int]:
    stem, _, number = name.partition("~")
    return stem, int(number) if number.isdigit() else 1


def _read_orphan(text: str) -> Orphan | None:
    head, found, body = text.partition("# ---\n")
    fields = dict(line[2:].split(": ", 1) for line in head.split("\n")[1:] if ": " in line)
    try:
        sig = fields["sig"] if fields["sig"] != "-" else None
        indent = str(json.loads(fields["indent"]))
        orphan = Orphan(decode_id(fields["region"]), decode_id(fields["file"]), sig, indent, body)
    except (KeyError, ValueError):
        return None
    return orphan if found else None


def _sync_folder(folder: Path) -> None:
    with suppress(OSError):
        handle = os.open(folder, os.O_RDONLY)
        try:
            os.fsync(handle)
        finally:
            os.close(handle)
