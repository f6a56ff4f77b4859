"""The bases of a package: what each editable file was last merged with, in one file that git diffs.

A line of a base stands behind one blank, an empty one is empty, so no text needs an escape. The
line before a base has the name of its file, and a digest of the name: in a replacement over many
files the name may change, too.
"""

from __future__ import annotations

import hashlib
import re
import shutil
from collections.abc import Iterator, Mapping
from pathlib import Path

from .conflicts import first_side
from .files import entries
from .marked_file import Fault
from .markers import decode_id, encode_id
from .paths import is_relative
from .store import EDDI, PRISTINE, files_below, read_text, remove_file, without_sentinel, write_file

BASES = "bases"
FORMER = f"{EDDI}/base"
"""Folder in which releases up to 0.1 kept each base as a file of its own."""
_HEAD = "# What each file was last merged with: commit it, and change nothing in it.\n"
_OPEN = "\\ no line end\n"
"""After a base whose last line has none, as in a diff."""
_KEY = re.compile("[0-9a-f]{8}")


def bases_of(text: str) -> dict[str, str]:
    """Return the bases that a text holds by file; of a conflict the first side."""
    return {name: base for name, _, base in _sections(text)}


def text_of(bases: Mapping[str, str]) -> str:
    """Return the text that holds these bases."""
    return _HEAD + "".join(map(_section, sorted(bases), (bases[name] for name in sorted(bases))))


def read_bases(root: Path) -> dict[str, str]:
    """Return the base of each editable file of a package that was merged."""
    text = read_text(root / EDDI / BASES)
    found = {}
    for told, key, base in _sections(text if isinstance(text, str) else ""):
        names = (n for n, kind in entries(root, (".git",)) if kind is None and _key(n) == key)
        name = told if _key(told) == key else next(names, told)
        if is_relative(name):
            found[name] = base
    for name in files_below(root / FORMER):
        former = read_text(root / FORMER / name)
        if isinstance(former, str):
            found[name] = former
    return found


def write_bases(root: Path, bases: Mapping[str, str]) -> None:
    """Replace the bases of a package as one step."""
    if bases:
        write_file(root, f"{EDDI}/{BASES}", text_of(bases).encode())
    else:
        remove_file(root / EDDI / BASES)
    shutil.rmtree(root / FORMER, ignore_errors=True)


def editable_files(root: Path) -> list[str]:
    """Return the editable files of a package, sorted: merged, or with a rendering to be merged."""
    return sorted({*read_bases(root), *files_below(root / PRISTINE)})


def newest_rendering(root: Path, name: str, base: str | None) -> str | Fault | None:
    """Return the newest rendering of an editable file, merged or not; ``None``: it is not whole."""
    text = read_text(root / PRISTINE / name)
    if text is None:
        return base
    return without_sentinel(text) if isinstance(text, str) else text


def _section(name: str, base: str) -> str:
    lines = base.split("\n")
    end = "" if lines[-1] == "" else "\n" + _OPEN
    body = "\n".join(f" {line}" if line.strip("\r") else line for line in lines)
    return f"{encode_id(name)} {_key(name)}\n{body}{end}"


def _sections(text: str) -> Iterator[tuple[str, str, str]]:
    """Yield name, digest of the name and base."""
    name, key, lines = "", "", list[str]()
    for line in [*first_side(text).split("\n")[:-1], "end"]:
        bare = line.rstrip("\r")
        if line[:1] == " " or not bare:
            lines.append(f"{line[1:] if bare else line}\n")
        elif line[:1] == _OPEN[0]:
            lines[-1:] = [last[:-1] for last in lines[-1:]]
        elif line[:1] != _HEAD[0]:
            if _KEY.fullmatch(key):
                yield decode_id(name), key, "".join(lines)
            name, _, key = bare.partition(" ")
            lines.clear()


def _key(name: str) -> str:
    return hashlib.sha256(name.encode(errors="surrogateescape")).hexdigest()[:8]
