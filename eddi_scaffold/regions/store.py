"""Files of a package: read them, replace them atomically, keep what has no place.

Layout below ``.eddi/``: ``pristine/F`` (Copier's rendering of F until it is merged),
``generated/F`` (the same of a file that must not be edited), ``bases`` (the renderings of the last
finished sync), ``next/F`` (what becomes the base of a sync under way), ``accepted/F`` (in what F
may differ from that base though it looks like another one's), ``orphans/<id>`` (bodies without a
region), ``rejects/F.patch`` (outside edits without a place), ``rejects/F.edited`` (whole files).
"""

from __future__ import annotations

import errno
import hashlib
import json
import os
import re
import shutil
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager, suppress
from itertools import chain, count
from pathlib import Path
from urllib.parse import quote

from . import names
from .files import LINK, entries, read_regular, resolved
from .marked_file import Fault
from .markers import decode_id, encode_id
from .paths import is_relative
from .result import Orphan

EDDI = names.folder
SAVED = (f"{EDDI}/orphans/", f"{EDDI}/rejects/")
"""Folders of records that a person may work in: text of theirs that has no place."""
PRISTINE = f"{EDDI}/pristine"
"""Folder into which Copier renders the editable files."""
IGNORED = ".gitignore"
"""Record that hides renderings from git; if it hides itself it goes with them."""
_PLACED = f"{EDDI}/placed"
"""What a folder of renderings is called while it is removed."""
_TEMPORARY = ".eddi-tmp"
# The last line of a rendering; before the colon stands the name of the template or its generator.
_SENTINEL_LINE = re.compile(
    r"^[ \t]*(?:#|<!--)\s*[\w-]+: end of rendering\s*(?:-->\s*)?\Z", re.MULTILINE
)
_HEAD = "# saved body of a region that is gone; it comes back with the region"


_durable = True


@contextmanager
def in_scratch() -> Iterator[None]:
    """Do not wait for the disk: what is written within goes with the process."""
    global _durable  # noqa: PLW0603 - one process merges one package at a time
    _durable = False
    try:
        yield
    finally:
        _durable = True


class ChangedMeanwhileError(OSError):
    """A file was saved after the text was read that its new one is made of."""


def files_below(folder: Path) -> list[str]:
    """Return the regular files below a folder, relative to it, sorted; links are not followed."""
    return sorted(
        name for name, kind in entries(folder) if kind is None and not name.endswith(_TEMPORARY)
    )


def is_hidden(root: Path, record: str) -> bool:
    """Return whether git, and so Copier, is told not to look at one of the records."""
    text = read_text(root / EDDI / IGNORED)
    return isinstance(text, str) and f"/{record}" in text.splitlines()


def discard(root: Path, folder: str) -> None:
    """Remove a folder of renderings by one rename: half of one must not pass for a rendering."""
    (root / folder).rename(root / _PLACED)
    shutil.rmtree(root / _PLACED)


def linked_records(root: Path) -> list[str]:
    """Return the links to folders among a package's records, relative to it."""
    if (root / EDDI).is_symlink():
        return [EDDI]
    links = (f"{EDDI}/{name}" for name, kind in entries(root / EDDI) if kind == LINK)
    return [name for name in links if (root / name).is_dir()]


def read_text(path: Path) -> str | Fault | None:
    """Return a file's text with its line ends, ``None`` without the file, else what is wrong."""
    try:
        return read_regular(path).decode()
    except FileNotFoundError:
        return None
    except UnicodeDecodeError as problem:
        line = problem.object.count(b"\n", 0, problem.start) + 1
        return Fault(line, "the file is not UTF-8; convert it")
    except OSError as problem:
        return Fault(1, f"cannot read the file: {problem.strerror}")


def without_sentinel(text: str) -> str | None:
    """Return a rendering without its last line, ``None`` when the rendering was interrupted."""
    match = _SENTINEL_LINE.search(text)
    return text[: match.start()] if match else None


def write_file(
    root: Path,
    name: str,
    data: bytes,
    like: str | None = None,
    check: Callable[[], None] | None = None,
    *,
    durable: bool = True,
) -> bool:
    """Replace a file of a package as one step; readers and a killed process see old or new.

    Args:
        root: the package.
        name: the file; a link that stays in the package is followed.
        data: its new bytes.
        like: file of the package whose mode a new file gets.
        check: called right before the old file goes; raises an ``OSError`` to keep it.
        durable: whether the bytes must outlive a power failure from now on.

    Returns:
        Whether there was anything to do.

    Raises:
        OSError: a link leads out of the package, the disk is full, or the folder is not writable;
            the old file stays.
    """
    path = resolved(root, root / name)
    if path is None:
        raise OSError(errno.ELOOP, "a link leads out of the package", str(root / name))
    if _holds(path, data):
        return False
    path.parent.mkdir(parents=True, exist_ok=True)
    durable = durable and _durable
    temporary = path.with_name(f".{path.name}{_TEMPORARY}")
    models = [path, *([root / like] if like is not None else [])]
    model = next((one for one in models if one.is_file()), None)
    try:
        temporary.unlink(missing_ok=True)  # the entry there may be a link
        with temporary.open("xb") as file:
            if model is not None:
                os.fchmod(file.fileno(), model.stat().st_mode & 0o7777)
            file.write(data)
            file.flush()
            if durable:
                os.fsync(file.fileno())
        if check is not None:
            check()
        os.replace(temporary, path)  # noqa: PTH105 - one name for the step that commits
    except OSError as problem:
        with suppress(OSError):
            temporary.unlink()
        if isinstance(problem, ChangedMeanwhileError):
            raise
        raise OSError(problem.errno, problem.strerror, str(path)) from None
    if durable:
        _sync_folder(path.parent)
    return True


def refuse_changed(path: Path, text: str | None) -> None:
    """Check that a file still holds the text that was read, ``None`` where there was none.

    Raises:
        ChangedMeanwhileError: somebody has saved it since.
    """
    if read_text(path) != text:
        raise ChangedMeanwhileError(errno.EBUSY, "it was saved while it was merged", str(path))


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
    """Remove what a killed process left next to the files that sync writes."""
    shutil.rmtree(root / _PLACED, ignore_errors=True)
    found = {root / EDDI / name for name, _ in entries(root / EDDI) if name.endswith(_TEMPORARY)}
    for path in (resolved(root, root / name) for name in paths):
        if path is not None:
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
    if len(name) > 200 or not is_relative(name):
        name = f"{name[:150]}-{hashlib.sha256(orphan.id.encode()).hexdigest()[:16]}"
    return _save_numbered(root, f"{EDDI}/orphans/{name}", "~", "", data)


def load_accepted(root: Path, path: str) -> frozenset[str]:
    """Return the parts of a file that do not fit its base, and that a person found right."""
    text = read_text(root / EDDI / "accepted" / path)
    return frozenset(text.splitlines() if isinstance(text, str) else ())


def save_accepted(root: Path, path: str, parts: Iterable[str]) -> None:
    """Add to these parts."""
    lines = sorted({*load_accepted(root, path), *parts})
    write_file(root, f"{EDDI}/accepted/{path}", "".join(f"{line}\n" for line in lines).encode())


def save_reject(root: Path, path: str, data: bytes, suffix: str = ".patch") -> Path:
    """Save an edit without a place below ``.eddi/rejects``; never replaces a different one."""
    return _save_numbered(root, f"{EDDI}/rejects/{path}", ".", suffix, data)


def _save_numbered(root: Path, stem: str, mark: str, suffix: str, data: bytes) -> Path:
    numbered = (f"{stem}{mark}{number}{suffix}" for number in count(2))
    for name in chain([f"{stem}{suffix}"], numbered):
        path = root / name
        if not os.path.lexists(path):
            write_file(root, name, data)
        elif not _holds(path, data):
            continue
        return path
    raise AssertionError("names never run out")


def _holds(path: Path, data: bytes) -> bool:
    try:
        return read_regular(path, len(data)) == data
    except OSError:
        return False


def _numbered_last(name: str) -> tuple[str, int]:
    stem, _, number = name.partition("~")
    return stem, int(number) if number.isdecimal() else 1


def _read_orphan(text: str) -> Orphan | None:
    head, found, body = text.partition("# ---\n")
    fields = dict(line[2:].split(": ", 1) for line in head.split("\n")[1:] if ": " in line)
    try:
        sig = fields["sig"] if fields["sig"] != "-" else None
        indent = str(json.loads(fields["indent"]))
        orphan = Orphan(decode_id(fields["region"]), decode_id(fields["file"]), sig, indent, body)
    except (KeyError, ValueError, RecursionError):
        return None
    return orphan if found else None


def _sync_folder(folder: Path) -> None:
    with suppress(OSError):
        handle = os.open(folder, os.O_RDONLY)
        try:
            os.fsync(handle)
        finally:
            os.close(handle)
