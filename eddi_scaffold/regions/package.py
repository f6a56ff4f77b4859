"""A package on disk: its generated files, the manifest that lists them, and saved texts."""

from __future__ import annotations

import hashlib
import os
import re
import stat
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path, PurePosixPath

from .choosing import Body
from .files import entries, inside, is_relative, kind_of, read_regular
from .git import former_lines, side_bytes
from .marked_file import Fault, MarkedFile, parse, sides_of
from .markers import text_digest

EDDI = ".eddi"
MANIFEST = f"{EDDI}/manifest"
KEPT = f"{EDDI}/kept"
NEW = f"{EDDI}/new"
PUT = f"{EDDI}/put"
ANSWERS = ".copier-answers.yml"
_LINE = re.compile(r"([0-9a-f]{16}) (\S.*)")
_REGION = re.compile(r".+\.region(?:\.\d+)?")


@dataclass(frozen=True)
class Manifest:
    """What the last renderings of a package were.

    Attributes:
        files: path -> digests of its text outside regions; two after a merge, or a killed run.
        wholes: digests of each rendering as a whole.
        exists: whether there is one.
    """

    files: Mapping[str, frozenset[str]] = field(default_factory=dict)
    wholes: frozenset[str] = frozenset()
    exists: bool = False

    @property
    def mixed(self) -> bool:
        """Whether it lists more than one rendering."""
        return len(self.wholes) > 1


def read_manifest(text: str | None) -> Manifest:
    """Read the lines of a manifest; another one, such as a conflict marker, says nothing."""
    if text is None:
        return Manifest()
    files: dict[str, set[str]] = {}
    for line in text.splitlines():
        match = _LINE.fullmatch(line.rstrip())
        if match and (match[2] == "*" or is_relative(match[2])):
            files.setdefault(match[2], set()).add(match[1])
    wholes = frozenset(files.pop("*", ()))
    return Manifest({name: frozenset(found) for name, found in files.items()}, wholes, True)


def manifest_text(files: Mapping[str, str], answers: str) -> str:
    """Return the manifest of a rendering: path -> digest, and the answers that it was made of."""
    listed = "".join(f"{files[name]} {name}\n" for name in sorted(files))
    return f"{text_digest(listed + answers)} *\n{listed}"


@dataclass(frozen=True)
class PackageFile:
    """A generated file as it is on disk.

    Attributes:
        data: its bytes.
        text: the same as text; what is no UTF-8 comes back to the byte.
        sides: the file, or one for each side of a conflict that git left in it.
        faults: what is wrong with its markers.
        mode: permission bits.
        stamp: tells whether it was saved meanwhile.
    """

    data: bytes
    text: str
    sides: tuple[MarkedFile, ...]
    faults: tuple[Fault, ...]
    mode: int
    stamp: tuple[int, ...]

    @property
    def digests(self) -> list[str]:
        """Digests of what stands outside of regions."""
        return [digest_of(self.data, side) for side in self.sides]


def digest_of(data: bytes, marked: MarkedFile) -> str:
    """Return the digest of a generated file, of text without its regions."""
    try:
        data.decode()
    except UnicodeDecodeError:
        return hashlib.sha256(data).hexdigest()[:16]
    return marked.digest


def text_of(data: bytes) -> str:
    """Return bytes as text, from which the same bytes can be made."""
    return data.decode("utf-8", "surrogateescape")


def bytes_of(text: str) -> bytes:
    """Return the bytes of a text that :func:`text_of` made."""
    return text.encode("utf-8", "surrogateescape")


def stamp_of(path: Path) -> tuple[int, ...]:
    """Return what changes when a file is saved; empty where there is none."""
    try:
        state = path.lstat()
    except OSError:
        return ()
    return state.st_mtime_ns, state.st_size, state.st_ino


def read_file(root: Path, name: str) -> PackageFile | None:
    """Read a generated file, ``None`` where there is none.

    Raises:
        OSError: it cannot be read.
    """
    path = root / name
    stamp = stamp_of(path)
    if not stamp:
        return None
    data = read_regular(path, follow=False)
    text = text_of(data)
    sides, faults = zip(*map(parse, sides_of(text)), strict=True)
    lines = {(fault.line, fault.reason): fault for found in faults for fault in found}
    mode = path.lstat().st_mode & 0o777
    return PackageFile(data, text, sides, tuple(lines.values()), mode, stamp)


def obstacle(root: Path, name: str) -> str | None:
    """Return why a generated file cannot be at a path of a package: a link, a folder."""
    above = PurePosixPath(name).parents
    for folder in list(above)[-2::-1]:
        mode = _mode_of(root / folder)
        if mode and not stat.S_ISDIR(mode):
            return f"{folder} is {kind_of(root / folder) or 'a file'}"
    if stat.S_ISDIR(_mode_of(root / name)):
        return f"{name} is a folder"
    kind = kind_of(root / name)
    return f"{name} is {kind}" if kind is not None else None


def _mode_of(path: Path) -> int:
    """Return what is at a path; nothing is, where no disk can hold such a name."""
    try:
        return path.lstat().st_mode
    except OSError:
        return 0


def manifest_of(root: Path) -> Manifest:
    """Read the manifest of a package."""
    place = inside(root, MANIFEST)
    try:
        return read_manifest(text_of(read_regular(place, follow=False)) if place else None)
    except OSError:
        return Manifest()


def kept_names(root: Path) -> list[str]:
    """Return what is kept in a package for a person, relative to the package."""
    if inside(root, f"{KEPT}/x") is None:
        return []
    return sorted(f"{KEPT}/{name}" for name, kind in entries(root / KEPT) if kind is None)


def kept_regions(root: Path) -> Iterator[tuple[str, Body | None]]:
    """Yield the saved regions of a package, the newest of an id last; ``None``: not readable."""
    names = [name for name in kept_names(root) if _is_region(name)]
    for name in sorted(names, key=lambda one: (len(one), one)):
        try:
            marked, faults = parse(text_of(read_regular(root / name, follow=False)))
        except OSError:
            marked, faults = MarkedFile(()), ()
        found = list(marked.regions.values())
        yield name, Body(found[0], name, kept=True) if len(found) == 1 and not faults else None


def _is_region(name: str) -> bool:
    below = name.removeprefix(f"{KEPT}/")
    return "/" not in below and _REGION.fullmatch(below) is not None


def free_name(root: Path, name: str, data: bytes, taken: Iterable[str] = ()) -> str | None:
    """Return where a text is kept, ``None`` where the same is kept already."""
    number = 1
    while True:
        found = f"{KEPT}/{name}" if number == 1 else f"{KEPT}/{name}.{number}"
        path = root / found
        if not os.path.lexists(path) and found not in taken:
            return found
        if path.is_file() and not path.is_symlink() and path.read_bytes() == data:
            return None
        number += 1


def made_by_git(root: Path, name: str, digests: Iterable[str], known: frozenset[str]) -> bool:
    """Return whether git put a file there: a rendering of another time, or a merge of two.

    Args:
        root: the package.
        name: the file.
        digests: of what stands outside of its regions.
        known: those in the manifest.
    """
    lines = (_LINE.fullmatch(text_of(line).rstrip()) for line in former_lines(root, MANIFEST))
    former = known | {match[1] for match in lines if match and match[2] == name}
    if former.issuperset(digests):
        return True
    sides = side_bytes(root, name) if len(known) > 1 else []
    return len(sides) > 1 and all(parse(text_of(one))[0].digest in former for one in sides)
