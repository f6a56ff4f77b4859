"""What is open in a package, from the package alone."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from .choosing import Body
from .files import entries
from .marked_file import MarkedFile, Region
from .markers import tail_of, with_tail
from .package import (
    MANIFEST,
    NEW,
    PackageFile,
    bytes_of,
    kept_names,
    kept_regions,
    made_by_git,
    manifest_of,
    obstacle,
    read_file,
)
from .sync import Plan, look_reasons
from .write import Step

Doubts = Callable[[str, Iterable[Region]], Mapping[str, Sequence[str]]]
"""Tells from a module and its hand-written regions what is doubtful in each of them."""


@dataclass(frozen=True)
class RegionStatus:
    """One line of the report.

    Attributes:
        id: of the region; empty for a whole file.
        file: relative to the package.
        line: of the begin marker, ``None`` where there is none.
        state: ``untouched``, ``edited``, ``orphaned`` (its place is gone), ``rejected`` (a whole
            file is kept), ``outside`` (edited outside regions), ``missing`` or ``broken``.
        notes: why a person must look at it, or doubts.
        review: whether a person must.
    """

    id: str
    file: str
    line: int | None
    state: str
    notes: tuple[str, ...] = ()
    review: bool = True


def list_regions(root: Path, doubts: Doubts | None = None) -> list[RegionStatus]:
    """Return the regions of a package, and what else is open in it."""
    return list(_listed(root, doubts))


def _listed(root: Path, doubts: Doubts | None) -> Iterator[RegionStatus]:
    manifest = manifest_of(root)
    if manifest.mixed:
        note = "lists two renderings: after a merge, or a killed run; generate again"
        yield RegionStatus("", MANIFEST, None, "broken", (note,))
    if any(kind is None for _, kind in entries(root / NEW)):
        yield RegionStatus("", NEW, None, "broken", ("a rendering waits there; generate again",))
    for name, known in sorted(manifest.files.items()):
        stop = obstacle(root, name)
        try:
            file = None if stop else read_file(root, name)
        except OSError as refused:
            stop = f"cannot be read: {refused.strerror}"
            file = None
        if stop is not None:
            yield RegionStatus("", name, None, "broken", (stop,))
        elif file is None:
            yield RegionStatus("", name, None, "missing", ("it was generated; generate again",))
        else:
            yield from _in_file(root, name, file, known, doubts)
    regions = dict(kept_regions(root))
    for name in kept_names(root):
        body = regions.get(name)
        if body is not None:
            note = "its place is gone; it returns with it; remove it when it is not needed"
            yield RegionStatus(body.region.id, name, None, "orphaned", (note,))
        else:
            note = "no region can be read in it"
            if name not in regions:
                note = "kept for you; take what you need, then remove it"
            yield RegionStatus("", name, None, "rejected", (note,))


def _in_file(
    root: Path, name: str, file: PackageFile, known: frozenset[str], doubts: Doubts | None
) -> Iterator[RegionStatus]:
    if len(file.sides) > 1:
        yield RegionStatus("", name, None, "broken", ("a merge is not finished; generate again",))
        return
    for fault in file.faults:
        yield RegionStatus("", name, fault.line, "broken", (fault.reason,))
    if file.faults:
        return
    if not known.issuperset(file.digests) and not made_by_git(root, name, file.digests, known):
        yield RegionStatus("", name, None, "outside", ("edited outside regions; generate again",))
    regions = file.sides[0].regions
    written = [region for region in regions.values() if not Body(region, name).untouched]
    doubted = doubts(file.text, written) if doubts and name.endswith(".py") and written else {}
    for id_, region in regions.items():
        if Body(region, name).untouched:
            yield RegionStatus(id_, name, region.line, "untouched", (), review=False)
            continue
        notes = list(doubted.get(id_, ()))
        review = region.now is not None
        if region.now is not None:
            notes.insert(0, f"look at it: {look_reasons(region.digests, region.now)}")
        yield RegionStatus(id_, name, region.line, "edited", tuple(notes), review)


def plan_accept(root: Path, ids: Iterable[str]) -> tuple[Plan, list[str]]:
    """Plan to note that bodies were looked at; return it with the ids that are there."""
    wanted, found = set(ids), []
    steps: list[Step] = []
    before, stamps = {}, {}
    for name in sorted(manifest_of(root).files):
        file = read_file(root, name) if obstacle(root, name) is None else None
        if file is None or file.faults or len(file.sides) > 1:
            continue
        mine = [id_ for id_, one in file.sides[0].regions.items() if id_ in wanted and one.now]
        if mine:
            found += mine
            data = bytes_of(_accepted(file, file.sides[0], mine))
            steps.append(Step(name, data, file.mode))
            before[name], stamps[name] = file.data, file.stamp
    return Plan(root, steps=steps, before=before, stamps=stamps), found


def _accepted(file: PackageFile, marked: MarkedFile, ids: Iterable[str]) -> str:
    lines = file.text.split("\n")
    for id_ in ids:
        region = marked.regions[id_]
        assert region.now is not None
        end = "\r" if lines[region.line - 1].endswith("\r") else ""
        tail = tail_of(region.now.digests, region.was)
        lines[region.line - 1] = with_tail(region.begin, id_, tail) + end
    return "\n".join(lines)
