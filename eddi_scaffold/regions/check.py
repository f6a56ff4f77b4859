"""What is open in a package, from the package alone."""

from __future__ import annotations

import os
from collections.abc import Container, Iterator, Mapping
from pathlib import Path
from typing import NamedTuple

from . import package
from .choosing import look_reasons
from .markers import tail_of, with_tail
from .package import EDDI, MANIFEST, NEW, Plan, Step


class RegionStatus(NamedTuple):
    """One line of the report.

    The state is ``untouched``, ``edited``, ``orphaned`` (its place is gone), ``rejected`` (a whole
    file is kept), ``outside`` (edited outside regions), ``missing`` or ``broken``.
    """

    id: str  # of the region; empty for a whole file
    file: str  # relative to the package
    line: int | None  # of the begin marker, None where there is none
    state: str
    notes: tuple[str, ...] = ()  # why a person must look at it
    review: bool = True  # whether a person must

    @property
    def why(self) -> str:
        """Id of a region, and the notes."""
        return ": ".join(filter(None, (self.id, "; ".join(self.notes))))


def list_regions(root: Path) -> Iterator[RegionStatus]:
    """Yield the regions of a package, and what else is open in it."""

    def whole(name: str, state: str, note: str, line: int | None = None) -> RegionStatus:
        return RegionStatus("", name, line, state, (note,))

    manifest = package.manifest_of(root)
    if manifest.mixed:
        note = "lists two renderings: after a merge, or a killed run; generate again"
        yield whole(MANIFEST, "broken", note)
    if any(kind is None for _, kind in package.entries(root / NEW)):
        yield whole(NEW, "broken", "a rendering waits there; generate again")
    files = _files_of(root)
    absent = "it was generated; generate again"
    if files and not manifest.exists:
        yield whole(MANIFEST, "missing", absent)
    for name, known in sorted(files.items()):
        try:
            stop, file = package.obstacle(root, name), package.read_file(root, name)
        except OSError as refused:
            stop, file = f"cannot be read: {refused.strerror}", None
        if stop is not None:
            yield whole(name, "broken", stop)
        elif file is None:
            yield whole(name, "missing", absent)
        elif len(file.sides) > 1:
            yield whole(name, "broken", "a merge is not finished; generate again")
        elif file.faults:
            yield from (whole(name, "broken", fault.reason, fault.line) for fault in file.faults)
        else:
            if not package.is_as_made(root, name, file.digests, known):
                yield whole(name, "outside", "edited outside regions; generate again")
            for id_, region in file.marked.regions.items():
                now = None if region.untouched else region.now
                state = "untouched" if region.untouched else "edited"
                notes = (f"look at it: {look_reasons(region.digests, now)}",) if now else ()
                yield RegionStatus(id_, name, region.line, state, notes, now is not None)
    for name, body in sorted(package.kept_texts(root).items()):
        if body is not None:
            note = "its place is gone; it returns with it; remove it when it is not needed"
            yield RegionStatus(body.region.id, name, None, "orphaned", (note,))
        else:
            yield whole(name, "rejected", "kept for you; take what you need, then remove it")


def _files_of(root: Path) -> Mapping[str, frozenset[str]]:
    """Return the generated files with their digests; without a manifest, those with regions."""
    manifest = package.manifest_of(root)
    if manifest.exists:
        return manifest.files
    files = {}
    for name, kind in package.entries(root, {".git", EDDI}):
        readable = kind is None and os.access(root / name, os.R_OK)
        file = package.read_file(root, name) if readable else None
        if file is not None and b"Manual edit" in file.data and file.marked.regions:
            files[name] = frozenset(file.digests)  # nothing is known of what is outside of them
    return files


def plan_accept(root: Path, ids: Container[str]) -> tuple[Plan, list[str]]:
    """Plan to note that bodies were looked at; return it with the ids that are there."""
    accepted: list[str] = []
    steps: list[Step] = []
    stamps = {}
    for name in sorted(_files_of(root)):
        stamp, file = package.stamp_of(root / name), package.read_file(root, name)
        if file is None or file.faults or len(file.sides) > 1:
            continue
        lines = file.text.split("\n")
        for id_, region in file.marked.regions.items():
            if id_ in ids and region.now is not None:
                accepted.append(id_)
                at, tail = region.line - 1, tail_of(region.now.digests, region.was)
                end = "\r" if lines[at].endswith("\r") else ""
                lines[at], stamps[name] = with_tail(region.begin, id_, tail) + end, stamp
        if name in stamps:
            steps.append(Step(name, package.bytes_of("\n".join(lines)), file.mode))
    return Plan(root, steps=steps, stamps=stamps), accepted
