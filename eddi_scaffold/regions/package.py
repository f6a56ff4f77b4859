"""A package on disk: its generated files, the manifest that lists them, kept texts, and writing.

It may be a stranger's: a link, FIFO or device in it is never opened, and a path that comes out of a
file is used only where it is the normalised, relative form of a place below the package.
"""

from __future__ import annotations

import errno
import fcntl
import hashlib
import os
import re
import shutil
import stat
from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path, PurePosixPath

from .choosing import Body
from .git import former_lines, side_bytes
from .marked_file import Fault, MarkedFile, parse, sides_of
from .markers import text_digest

EDDI = ".eddi"
MANIFEST = f"{EDDI}/manifest"
KEPT = f"{EDDI}/kept"
NEW = f"{EDDI}/new"
PUT = f"{EDDI}/put"
ANSWERS = ".copier-answers.yml"
LINK = "a link"
KINDS = {
    stat.S_IFDIR: "a folder",
    stat.S_IFLNK: LINK,
    stat.S_IFIFO: "a FIFO",
    stat.S_IFSOCK: "a socket",
    stat.S_IFCHR: "a device",
    stat.S_IFBLK: "a device",
}
_LINE = re.compile(r"([0-9a-f]{16}) (\S.*)")
_NO_UTF8 = re.compile("[\udc80-\udcff]")
_REGION = re.compile(rf"{re.escape(KEPT)}/[^/]+\.region(?:\.\d+)?")


class BusyError(Exception):
    """Another run is at work in the folder."""


class SavedError(Exception):
    """A file was saved after it was read; the text is its path."""


# paths --------------------------------------------------------------------------------------------
def is_relative(name: object) -> bool:
    """Return whether a value is a normalised relative POSIX path: no ``..``, root or blank part.

    The content of a ``.git`` belongs to git, which starts programs from there: nothing else may
    be written there.

    >>> is_relative("src/rover/EDDIInput.py"), is_relative("a/../b"), is_relative("/etc/passwd")
    (True, False, False)
    """
    return (
        isinstance(name, str)
        and name.isprintable()
        and "\\" not in name
        and all(part.lower() not in {"", ".", "..", ".git"} for part in name.split("/"))
    )


def kind_of(path: Path) -> str | None:
    """Return the kind of the entry at a path, ``None`` for a regular file or nothing."""
    try:
        kind = stat.S_IFMT(path.lstat().st_mode)
    except OSError:
        return None
    return None if kind == stat.S_IFREG else KINDS.get(kind, "no regular file")


def entries(folder: Path, skip: Collection[str] = ()) -> Iterator[tuple[str, str | None]]:
    """Yield the entries below a folder: relative POSIX path and, of no regular file, its kind.

    Links are named and not followed, some names passed over; no folder is like an empty one.
    """
    for place, folders, names in os.walk(folder):
        links = {one for one in folders if Path(place, one).is_symlink()}
        folders[:] = sorted({*folders} - {*links, *skip})
        for name in sorted({*names, *links} - {*skip}):
            path = Path(place, name)
            yield path.relative_to(folder).as_posix(), kind_of(path)


def obstacle(root: Path, name: str) -> str | None:
    """Return why a generated file cannot be at a path of a package: a link, a folder."""
    for folder in [*PurePosixPath(name).parents][-2::-1]:
        if not os.path.lexists(root / folder):
            return None
        kind = kind_of(root / folder)
        if kind != "a folder":
            return f"{folder} is {kind or 'a file'}"
    kind = kind_of(root / name)
    return f"{name} is {kind}" if kind is not None else None


def stamp_of(path: Path) -> tuple[int, ...]:
    """Return what changes when a file is saved; empty where there is none."""
    try:
        state = path.lstat()
    except OSError:
        return ()
    return state.st_mtime_ns, state.st_size, state.st_ino


def bytes_at(root: Path, name: str) -> bytes | None:
    """Return the bytes of a file of a package; ``None`` where there is none, or no file."""
    there = obstacle(root, name) is None and stamp_of(root / name)
    return (root / name).read_bytes() if there else None


# files --------------------------------------------------------------------------------------------
def text_of(data: bytes) -> str:
    """Return bytes as text, from which :func:`bytes_of` makes the same bytes."""
    return data.decode("utf-8", "surrogateescape")


def bytes_of(text: str) -> bytes:
    """Return the bytes of a text of :func:`text_of`."""
    return text.encode("utf-8", "surrogateescape")


@dataclass(frozen=True)
class PackageFile:
    """A generated file, on disk or of a rendering."""

    data: bytes
    mode: int

    @cached_property
    def text(self) -> str:
        """The same as text; what is no UTF-8 comes back to the byte."""
        return text_of(self.data)

    @property
    def is_text(self) -> bool:
        """Whether it is UTF-8; another file has no regions, and counts byte for byte."""
        return _NO_UTF8.search(self.text) is None

    @cached_property
    def _parsed(self) -> Sequence[tuple[MarkedFile, tuple[Fault, ...]]]:
        return [parse(side) for side in sides_of(self.text)]

    @property
    def sides(self) -> Sequence[MarkedFile]:
        """The file, or one for each side of a conflict that git left in it."""
        return [marked for marked, _ in self._parsed]

    @property
    def marked(self) -> MarkedFile:
        """The file, or the first side of a conflict in it."""
        return self._parsed[0][0]

    @property
    def faults(self) -> Sequence[Fault]:
        """What is wrong with its markers."""
        return list(dict.fromkeys(fault for _, faults in self._parsed for fault in faults))

    @cached_property
    def digests(self) -> Sequence[str]:
        """Digests of what stands outside of regions, of each side."""
        if not self.is_text:
            return [hashlib.sha256(self.data).hexdigest()[:16]]
        return [side.digest for side in self.sides]


def read_file(root: Path, name: str) -> PackageFile | None:
    """Read a generated file, ``None`` where there is none, or an obstacle; may fail (OSError)."""
    data = bytes_at(root, name)
    return None if data is None else PackageFile(data, (root / name).lstat().st_mode & 0o777)


# manifest -----------------------------------------------------------------------------------------
@dataclass(frozen=True)
class Manifest:
    """What the last renderings of a package were."""

    files: Mapping[str, frozenset[str]] = field(default_factory=dict)  # path -> digests
    mixed: bool = False  # it lists two renderings: after a merge, or a killed run
    exists: bool = False


def manifest_of(root: Path) -> Manifest:
    """Read the manifest of a package; another line, such as a conflict marker, says nothing."""
    data = bytes_at(root, MANIFEST)
    if data is None:
        return Manifest()
    files: dict[str, set[str]] = {}
    for line in text_of(data).splitlines():
        match = _LINE.fullmatch(line.rstrip())
        if match and is_relative(match[2]):
            files.setdefault(match[2], set()).add(match[1])
    mixed = len(files.pop("*", ())) > 1
    return Manifest({name: frozenset(found) for name, found in files.items()}, mixed, True)


def manifest_text(files: Mapping[str, str], answers: str) -> str:
    """Return the manifest of a rendering: path -> digest, and the answers that it was made of."""
    listed = "".join(f"{files[name]} {name}\n" for name in sorted(files))
    return f"{text_digest(listed + answers)} *\n{listed}"


def is_as_made(
    root: Path, name: str, digests: Iterable[str], known: frozenset[str], new: Iterable[str] = ()
) -> bool:
    """Return whether what stands outside of the regions of a file is a rendering.

    It is a known one, the new one, one of another time that git has put there, or a merge of two.
    """
    if known.union(new).issuperset(digests):
        return True
    lines = (_LINE.fullmatch(text_of(line).rstrip()) for line in former_lines(root, MANIFEST))
    former = known | {match[1] for match in lines if match and match[2] == name}
    if former.issuperset(digests):
        return True
    sides = side_bytes(root, name) if len(known) > 1 else [b""]
    return all(side and parse(text_of(side))[0].digest in former for side in sides)


# kept texts ---------------------------------------------------------------------------------------
def kept_names(root: Path) -> list[str]:
    """Return what is kept in a package for a person, relative to the package."""
    if obstacle(root, f"{KEPT}/*"):
        return []
    return sorted(f"{KEPT}/{name}" for name, kind in entries(root / KEPT) if kind is None)


def kept_regions(root: Path) -> Iterator[tuple[str, Body | None]]:
    """Yield the saved regions of a package, the newest of an id last; ``None``: not readable."""
    names = [name for name in kept_names(root) if _REGION.fullmatch(name)]
    for name in sorted(names, key=lambda one: (len(one), one)):
        try:
            marked, faults = parse(text_of((root / name).read_bytes()))
        except OSError:
            marked, faults = MarkedFile(()), ()
        found = list(marked.regions.values())
        yield name, Body(found[0], name, kept=True) if len(found) == 1 and not faults else None


def free_name(root: Path, name: str, data: bytes, taken: Iterable[str] = ()) -> str | None:
    """Return where a text is kept, ``None`` where the same is kept already."""
    number, found = 1, f"{KEPT}/{name}"
    while os.path.lexists(root / found) or found in taken:
        if bytes_at(root, found) == data:
            return None
        number += 1
        found = f"{KEPT}/{name}.{number}"
    return found


# writing ------------------------------------------------------------------------------------------
@dataclass(frozen=True)
class Step:
    """One change of a package: a file gets new bytes, or goes."""

    path: str  # relative to the package
    data: bytes | None  # None for a file that goes
    mode: int = 0o644


@contextmanager
def locked(folder: Path) -> Iterator[None]:
    """Keep other runs out of a folder, as long as this process is in here (BusyError).

    It is a lock of the kernel; a folder that is not there, or a disk without locks, has none.
    """
    try:
        handle = os.open(folder, os.O_RDONLY | os.O_DIRECTORY | os.O_CLOEXEC)
    except OSError:
        yield
        return
    try:
        try:
            fcntl.flock(handle, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except OSError as refused:
            if refused.errno in {errno.EACCES, errno.EAGAIN}:
                raise BusyError(f"another run is at work in {folder}") from None
        yield
    finally:
        os.close(handle)


def put_aside(root: Path, steps: Sequence[Step], place: Path) -> None:
    """Write all new bytes into a folder on the same disk; nothing of a person changes.

    Raises:
        OSError: the disk is full, or a folder is not writable.
    """
    shutil.rmtree(place, ignore_errors=True)
    for step in steps:
        folder = (root / step.path).parent
        while not os.path.lexists(folder):
            folder = folder.parent
        if not os.access(folder, os.W_OK | os.X_OK):
            raise PermissionError(errno.EACCES, os.strerror(errno.EACCES), str(folder))
    if any(step.data is not None for step in steps):
        place.mkdir(parents=True)  # fails where a link is in its place: nothing goes through it
    try:
        for number, step in enumerate(steps):
            if step.data is not None:
                write_durably(place / str(number), step.data, step.mode)
    except OSError:
        shutil.rmtree(place, ignore_errors=True)
        raise


def refuse_saved(root: Path, stamps: Mapping[str, tuple[int, ...]]) -> None:
    """Refuse where a person saved a file since it was read (SavedError)."""
    for name, stamp in stamps.items():
        if stamp_of(root / name) != stamp:
            shutil.rmtree(root / PUT, ignore_errors=True)
            raise SavedError(root / name)


def move_in(root: Path, steps: Sequence[Step]) -> None:
    """Do the steps in their order, each at once; killed in between, the next run finishes."""
    for number, step in enumerate(steps):
        target = root / step.path
        if step.data is not None:
            target.parent.mkdir(parents=True, exist_ok=True)
            (root / PUT / str(number)).replace(target)
            continue
        target.unlink(missing_ok=True)
        folder = target.parent
        while folder != root and folder.is_dir() and not any(folder.iterdir()):
            folder.rmdir()
            folder = folder.parent
    shutil.rmtree(root / PUT, ignore_errors=True)


def write_durably(path: Path, data: bytes, mode: int) -> None:
    """Write a file, which is on the disk at the end."""
    with path.open("wb") as file:
        file.write(data)
        file.flush()
        os.fsync(file.fileno())
    path.chmod(mode)
