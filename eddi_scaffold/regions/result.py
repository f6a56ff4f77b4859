"""Result of the merge of one file: values that the writing side turns into files."""

from __future__ import annotations

import difflib
from collections.abc import Iterable, Sequence
from dataclasses import dataclass

from .marked_file import Fault, placeholder_id
from .outside import Reject


@dataclass(frozen=True)
class Orphan:
    """The hand-written body of a region that the new text does not have.

    Attributes:
        id: the region it was written in.
        file: the file it was in, relative to the package.
        sig: signature it was written against, ``None`` when not known.
        indent: blanks before its begin marker.
        body: the text, byte for byte.
    """

    id: str
    file: str
    sig: str | None
    indent: str
    body: str


@dataclass(frozen=True)
class Note:
    """One thing that happened to a hand edit.

    Attributes:
        file: file in the package.
        line: line in the file before the merge, ``None`` when there is none.
        text: one sentence without a full stop.
        attention: whether a person must look at it.
    """

    file: str
    line: int | None
    text: str
    attention: bool = True


class Restored(Note):
    """A saved body is in a region again."""


@dataclass(frozen=True)
class Merged:
    """The new text of one file and what had to leave it.

    Attributes:
        text: the new text, ``None`` when the file goes.
        orphans: bodies that must be saved before the file is replaced.
        taken: saved bodies that are in the new text.
        patch: outside edits that did not fit, as unified diffs; empty when all fitted.
        notes: what to report.
    """

    text: str | None
    orphans: tuple[Orphan, ...] = ()
    taken: tuple[Orphan, ...] = ()
    patch: str = ""
    notes: tuple[Note, ...] = ()


@dataclass(frozen=True)
class RefusedFile:
    """A file that must not be touched.

    Attributes:
        faults: why, with lines of the person's file.
    """

    faults: tuple[Fault, ...]


def patch_text(path: str, rejects: Iterable[Reject]) -> str:
    """Return the rejected edits as unified diffs, one for each definition."""
    return "".join(_one(path, reject) for reject in rejects)


def _one(path: str, reject: Reject) -> str:
    head = f"# {path}: edit in {' '.join(reject.where.split())}\n"
    diff = difflib.unified_diff(
        _shown(reject.before), _shown(reject.after), f"a/{path}", f"b/{path}", n=3
    )
    return head + "".join(diff)


def _shown(lines: Sequence[str]) -> list[str]:
    shown = []
    for line in lines:
        region = placeholder_id(line)
        text = line if region is None else f"# (region {region!r})\n"
        shown.append(text if text.endswith("\n") else text + "\n")
    return shown
