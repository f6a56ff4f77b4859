"""What is open in a package, from the package alone."""

from __future__ import annotations

import os
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path

from . import package
from .markers import tail_of, with_tail
from .package import EDDI, MANIFEST, NEW, PackageFile, Step
from .sync import Plan, look_reasons


@dataclass(frozen=True)
class RegionStatus:
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


def list_regions(root: Path) -> list[RegionStatus]:
    """Return the regions of a package, and what else is open in it."""
    return list(_listed(root))


def _listed(root: Path) -> Iterator[RegionStatus]:
    manifest = package.manifest_of(root)
    if manifest.mixed:
        note = "lists two renderings: after a merge, or a killed run; generate again"
        yield RegionStatus("", MANIFEST, None, "broken", (note,))
    if any(kind is None for _, kind in package.entries(root / NEW)):
        yield RegionStatus("", NEW, None, "broken", ("a rendering waits there; generate again",))
    files = _files_of(root)
    if files and not manifest.exists:
        yield RegionStatus("", MANIFEST, None, "missing", ("it was generated; generate again",))
    for name, known in sorted(files.items()):
        stop, file = package.obstacle(root, name), None
        try:
            file = package.read_file(root, name)
        except OSError as refused:
            stop = f"cannot be read: {refused.strerror}"
        if stop is not None:
            yield RegionStatus("", name, None, "broken", (stop,))
        elif file is None:
            yield RegionStatus("", name, None, "missing", ("it was generated; generate again",))
        else:
            yield from _in_file(root, name, file, known)
    regions = dict(package.kept_regions(root))
    for name in package.kept_names(root):
        if body := regions.get(name):
            note = "its place is gone; it returns with it; remove it when it is not needed"
            yield RegionStatus(body.region.id, name, None, "orphaned", (note,))
        else:
            note = "kept for you; take what you need, then remove it"
            note = "no region can be read in it" if name in regions else note
            yield RegionStatus("", name, None, "rejected", (note,))


def _files_of(root: Path) -> Mapping[str, frozenset[str]]:
    """Return the generated files with their digests; without a manifest, those with regions."""
    manifest = package.manifest_of(root)
    if manifest.exists:
        return manifest.files
    found = {}
    for name, kind in package.entries(root, {".git", EDDI}):
        readable = kind is None and os.access(root / name, os.R_OK)
        file = package.read_file(root, name) if readable else None
        if file is not None and b"Manual edit" in file.data and file.marked.regions:
            found[name] = frozenset(file.digests)  # nothing is known of what is outside of them
    return found


def _in_file(
    root: Path, name: str, file: PackageFile, known: frozenset[str]
) -> Iterator[RegionStatus]:
    if len(file.sides) > 1:
        yield RegionStatus("", name, None, "broken", ("a merge is not finished; generate again",))
        return
    if file.faults:
        for fault in file.faults:
            yield RegionStatus("", name, fault.line, "broken", (fault.reason,))
        return
    if not package.is_as_made(root, name, file.digests, known):
        yield RegionStatus("", name, None, "outside", ("edited outside regions; generate again",))
    for id_, region in file.marked.regions.items():
        now = None if region.untouched else region.now
        notes = (f"look at it: {look_reasons(region.digests, now)}",) if now is not None else ()
        state = "untouched" if region.untouched else "edited"
        yield RegionStatus(id_, name, region.line, state, notes, now is not None)


def plan_accept(root: Path, ids: Iterable[str]) -> tuple[Plan, list[str]]:
    """Plan to note that bodies were looked at; return it with the ids that are there."""
    wanted, found = set(ids), list[str]()
    steps: list[Step] = []
    stamps = {}
    for name in sorted(_files_of(root)):
        stamp, file = package.stamp_of(root / name), package.read_file(root, name)
        if file is None or file.faults or len(file.sides) > 1:
            continue
        lines = file.text.split("\n")
        for id_, region in file.marked.regions.items():
            if id_ in wanted and region.now is not None:
                found.append(id_)
                end = "\r" if lines[region.line - 1].endswith("\r") else ""
                tail = tail_of(region.now.digests, region.was)
                lines[region.line - 1] = with_tail(region.begin, id_, tail) + end
                stamps[name] = stamp
        if name in stamps:
            steps.append(Step(name, package.bytes_of("\n".join(lines)), file.mode))
    return Plan(root, steps=steps, stamps=stamps), found
