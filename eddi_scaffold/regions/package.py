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
from contextlib import contextmanager, suppress
from pathlib import Path, PurePosixPath
from typing import NamedTuple

from .choosing import Body
from .git import both_sides, former_lines
from .marked_file import parse, sides_of
from .markers import text_digest

EDDI = ".eddi"
MANIFEST = f"{EDDI}/manifest"
KEPT = f"{EDDI}/kept"
NEW = f"{EDDI}/new"
PUT = f"{EDDI}/put"
ANSWERS = ".copier-answers.yml"
LINK = "a link"
_LINE = re.compile(r"([0-9a-f]{16}) (\S.*)")
_NO_UTF8 = re.compile("[\udc80-\udcff]")
_REGION = re.compile(rf"{re.escape(KEPT)}/[^/]+\.region(?:\.\d+)?")


class BusyError(Exception):
    """Another run is at work in the folder."""


class SavedError(OSError):
    """A file was saved after it was read."""


def is_relative(name: object) -> bool:
    """Return whether a value is a normalised relative POSIX path: no ``..``, root or blank part.

    The content of a ``.git`` belongs to git, which starts programs from there.
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
        mode = path.lstat().st_mode
    except OSError:
        return None
    if stat.S_ISREG(mode):
        return None
    return "a folder" if stat.S_ISDIR(mode) else LINK if stat.S_ISLNK(mode) else "no regular file"


def entries(folder: Path, skip: Collection[str] = ()) -> Iterator[tuple[str, str | None]]:
    """Yield the entries below a folder: relative POSIX path and, of no regular file, its kind.

    Links are named and not followed, some names passed over; no folder is like an empty one.
    """
    for place, folders, names in os.walk(folder):
        links = {name for name in folders if Path(place, name).is_symlink()}
        folders[:] = sorted({*folders} - {*links, *skip})
        for name in sorted({*names, *links} - {*skip}):
            path = Path(place, name)
            yield path.relative_to(folder).as_posix(), kind_of(path)


def obstacle(root: Path, name: str) -> str | None:
    """Return why a generated file cannot be at a path of a package: a link, a folder."""
    for folder in [*PurePosixPath(name).parents][-2::-1]:
        if not os.path.lexists(root / folder):
            return None
        if (kind := kind_of(root / folder)) != "a folder":
            return f"{folder} is {kind or 'a file'}"
    return f"{name} is {kind}" if (kind := kind_of(root / name)) else None


def stamp_of(path: Path) -> tuple[int, ...]:
    """Return what changes when a file is saved; empty where there is none."""
    try:
        state = path.lstat()
    except OSError:
        return ()
    return state.st_mtime_ns, state.st_size, state.st_ino


def text_of(data: bytes) -> str:
    """Return bytes as text, also those that are no UTF-8."""
    return data.decode("utf-8", "surrogateescape")


def bytes_of(text: str) -> bytes:
    """Return the same bytes again."""
    return text.encode("utf-8", "surrogateescape")


class PackageFile:
    """A generated file, on disk or of a rendering."""

    def __init__(self, data: bytes, mode: int) -> None:
        self.data, self.mode, self.text = data, mode, text_of(data)
        self.is_text = _NO_UTF8.search(self.text) is None  # else no regions, and counted in bytes
        parsed = [parse(side) for side in sides_of(self.text)]
        self.sides = [marked for marked, _ in parsed]  # several in a conflict that git left
        self.marked = self.sides[0]
        self.faults = list(dict.fromkeys(fault for _, faults in parsed for fault in faults))
        of_sides = [text_digest("".join(side.outside)) for side in self.sides]
        self.digests = of_sides if self.is_text else [hashlib.sha256(data).hexdigest()[:16]]


def bytes_at(root: Path, name: str) -> bytes | None:
    """Return the bytes of a file of a package, ``None`` where there is none, or an obstacle."""
    is_there = obstacle(root, name) is None and stamp_of(root / name)
    return (root / name).read_bytes() if is_there else None


def known_file(root: Path, name: str, digest: str, folder: Path | None = None) -> bytes | None:
    """Return the bytes of a file that is known by its SHA-256, and that nothing renders.

    It is taken from the package, or from a folder.
    """
    if not is_relative(name):
        return None
    places = [] if obstacle(root, name) else [root / name]
    places += [] if folder is None else [folder / Path(name).name]
    there = (path.read_bytes() for path in places if path.is_file() and os.access(path, os.R_OK))
    return next((data for data in there if hashlib.sha256(data).hexdigest() == digest), None)


def read_file(root: Path, name: str) -> PackageFile | None:
    """Read such a file; both raise OSError."""
    data = bytes_at(root, name)
    return None if data is None else PackageFile(data, (root / name).lstat().st_mode & 0o777)


class Manifest(NamedTuple):
    """What the last renderings of a package were."""

    files: Mapping[str, frozenset[str]]  # path -> digests
    mixed: bool  # it lists two renderings: after a merge, or a killed run
    exists: bool


def manifest_of(root: Path) -> Manifest:
    """Read the manifest of a package; another line, such as a conflict marker, says nothing."""
    data = bytes_at(root, MANIFEST)
    files: dict[str, frozenset[str]] = {}
    for line in text_of(data or b"").splitlines():
        match = _LINE.fullmatch(line.rstrip())
        if match and is_relative(match[2]):
            files[match[2]] = files.get(match[2], frozenset()) | {match[1]}
    mixed = len(files.pop("*", ())) > 1
    return Manifest(files, mixed, data is not None)


def manifest_text(files: Mapping[str, str], answers: str) -> str:
    """Return the manifest of a rendering: path -> digest, and the answers that it was made of."""
    listed = "".join(f"{files[name]} {name}\n" for name in sorted(files))
    return f"{text_digest(listed + answers)} *\n{listed}"


def is_as_made(
    root: Path, name: str, digests: Iterable[str], known: frozenset[str], new: Iterable[str] = ()
) -> bool:
    """Return whether the digests of a file are those of a rendering.

    It is a known one, the new one, one of another time that git has put there, or a merge of two.
    """
    if known.union(new).issuperset(digests):
        return True
    lines = (_LINE.fullmatch(text_of(line).rstrip()) for line in former_lines(root, MANIFEST))
    former = known | {match[1] for match in lines if match and match[2] == name}
    if former.issuperset(digests):
        return True
    sides = both_sides(root, name) if len(known) > 1 else [b""]
    return all(side and former.issuperset(PackageFile(side, 0).digests) for side in sides)


def kept_texts(root: Path) -> dict[str, Body | None]:
    """Return what is kept for a person: path -> its region, the newest last; ``None`` for files."""
    kept: dict[str, Body | None] = {}
    there = () if obstacle(root, f"{KEPT}/*") else entries(root / KEPT)
    names = (f"{KEPT}/{name}" for name, kind in there if kind is None)
    for name in sorted(names, key=lambda name: (len(name), name)):
        kept[name] = None
        if _REGION.fullmatch(name) and os.access(root / name, os.R_OK):
            marked, faults = parse(text_of((root / name).read_bytes()))
            regions = [] if faults else [*marked.regions.values()]
            kept[name] = Body(regions[0], name, kept=True) if len(regions) == 1 else None
    return kept


def free_name(root: Path, name: str, data: bytes, taken: Iterable[str] = ()) -> str | None:
    """Return where a text is kept, ``None`` where the same is kept already."""
    number, place = 1, f"{KEPT}/{name}"
    while os.path.lexists(root / place) or place in taken:
        if bytes_at(root, place) == data:
            return None
        number += 1
        place = f"{KEPT}/{name}.{number}"
    return place


class Step(NamedTuple):
    """One change of a package: a file gets new bytes, or goes."""

    path: str  # relative to the package
    data: bytes | None  # None for a file that goes
    mode: int = 0o644


class Note(NamedTuple):
    """One thing that happened to a person's text, or why nothing is written."""

    file: str  # relative to the package
    line: int | None  # in the file, None when there is none
    text: str  # one sentence without a full stop
    attention: bool = True  # whether a person must look at it

    @property
    def place(self) -> str:
        """The file, and the line where there is one."""
        return self.file if self.line is None else f"{self.file}:{self.line}"


class Plan(NamedTuple):
    """What is to be done in a package, or why nothing is."""

    root: Path  # the package
    refusals: Sequence[Note] = ()  # with any of them nothing may be written
    notes: Sequence[Note] = ()
    steps: Sequence[Step] = ()  # in the order in which they are made
    stamps: Mapping[str, tuple[int, ...]] = {}  # of all that were read

    def prepare(self) -> None:
        """Write all new bytes beside their places; nothing of a person changes.

        Raises:
            OSError: the disk is full, a folder is not writable, or a file was saved meanwhile.
        """
        put_aside(self.root, self.steps, self.root / PUT)
        self._refuse_saved()

    def finish(self) -> None:
        """Do the steps, each at once; killed in between, the next run finishes."""
        self._refuse_saved()
        for number, step in enumerate(self.steps):
            target = self.root / step.path
            if step.data is not None:
                target.parent.mkdir(parents=True, exist_ok=True)
                (self.root / PUT / str(number)).replace(target)
            else:
                target.unlink(missing_ok=True)
                _remove_empty(target.parent, self.root)
        for folder in (PUT, NEW):
            shutil.rmtree(self.root / folder, ignore_errors=True)
        for place in (self.root / EDDI, self.root):
            _remove_empty(place, self.root.parent)

    def _refuse_saved(self) -> None:
        for name, stamp in self.stamps.items():
            if stamp_of(self.root / name) != stamp:
                shutil.rmtree(self.root / PUT, ignore_errors=True)
                reason = "it was saved while this command was running"
                raise SavedError(errno.EBUSY, reason, str(self.root / name))


def _remove_empty(folder: Path, above: Path) -> None:
    while folder != above and folder.is_dir() and not any(folder.iterdir()):
        folder.rmdir()
        folder = folder.parent


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
        with suppress(OSError):  # of a disk without locks
            try:
                fcntl.flock(handle, fcntl.LOCK_EX | fcntl.LOCK_NB)
            except (BlockingIOError, PermissionError):
                raise BusyError(f"another run is at work in {folder}") from None
        yield
    finally:
        os.close(handle)


def put_aside(root: Path, steps: Sequence[Step], place: Path) -> None:
    """Write all new bytes into a folder on the same disk (OSError)."""
    shutil.rmtree(place, ignore_errors=True)
    for step in steps:
        folder = next(filter(os.path.lexists, (root / step.path).parents))
        if not os.access(folder, os.W_OK | os.X_OK):
            raise PermissionError(errno.EACCES, os.strerror(errno.EACCES), str(folder))
    try:
        if any(step.data is not None for step in steps):
            place.mkdir(parents=True)  # fails where a link is in its place
            (place / ".gitignore").write_bytes(b"*\n")
        for number, step in enumerate(steps):
            if step.data is not None:
                (place / str(number)).write_bytes(step.data)
                (place / str(number)).chmod(step.mode)
        for path in place.glob("*"):  # at the end, when most is on the disk already
            with path.open("rb") as file:
                os.fsync(file.fileno())
    except OSError:
        shutil.rmtree(place, ignore_errors=True)
        raise
