"""Which body goes into which region: by id, by declared former id, by saved body."""

from __future__ import annotations

from collections import Counter, deque
from collections.abc import Container, Iterable, Mapping, Sequence
from dataclasses import dataclass, replace

from . import names
from .bodies import is_empty, same_body
from .marked_file import MarkedFile, Region
from .result import Note, Orphan, Restored

_PLACE = f"{names.folder}/orphans"


@dataclass(frozen=True)
class Placement:
    """The body of one region of the new text.

    Attributes:
        region: the region as the generator rendered it.
        body: the text that goes into it.
        sig: signature that the body was written against.
        indent: blanks before the begin marker where the body was.
        edited: whether a person wrote it.
    """

    region: Region
    body: str
    sig: str | None
    indent: str
    edited: bool


@dataclass(frozen=True)
class Placements:
    """All bodies of a file.

    Attributes:
        by_id: one claim for each region of the new text.
        orphans: hand-written bodies that nothing claims.
        taken: saved bodies that are in the new text now.
        notes: what to report.
        changed: ids in both renderings that mean another element now.
    """

    by_id: Mapping[str, Placement]
    orphans: tuple[Orphan, ...]
    taken: tuple[Orphan, ...]
    notes: tuple[Note, ...]
    changed: frozenset[str] = frozenset()


def adopt_ids(document: MarkedFile, theirs: MarkedFile) -> MarkedFile:
    """Give regions without id the id of the one region in the same function of ``theirs``."""
    counted = Counter(region.function for region in theirs.regions.values())
    known = {
        region.function: region.id
        for region in theirs.regions.values()
        if region.function and counted[region.function] == 1
    }
    present = set(document.regions)
    return MarkedFile(
        tuple(
            replace(part, id=known[part.function])
            if isinstance(part, Region)
            and not part.explicit
            and part.function in known
            and known[part.function] not in present
            else part
            for part in document.parts
        )
    )


def claim_bodies(
    path: str,
    base: MarkedFile | None,
    mine: MarkedFile | None,
    theirs: MarkedFile,
    orphans: Sequence[Orphan],
) -> Placements:
    """Decide for each region of the new text whose body it gets."""
    old = base.regions if base else {}
    own = mine.regions if mine else {}
    new = theirs.regions
    former = {region.id: _news(region, base, own) for region in new.values()}
    sources = _sources(new, former, old if base else own)
    heirs = {source: heir for heir, source in sources.items()}
    hand = {
        region.id: region
        for region in own.values()
        if not _untouched(region, old.get(region.id), new.get(heirs.get(region.id, "")))
    }
    claims: dict[str, Placement] = {}
    claimed: set[str] = set()
    taken: list[Orphan] = []
    notes: list[Note] = []
    for region in new.values():
        source = hand.get(sources.get(region.id, ""))
        if source is not None:
            claimed.add(source.id)
            before = old.get(source.id)
            # A marker that lost its whole comment still means what the base has; one with an id
            # but no signature was never looked at (an adopted package).
            sig = source.sig if source.explicit or before is None else before.sig
            claim = Placement(region, source.body, sig, source.indent, edited=True)
            notes.extend(_report_changes(path, claim, source, old.get(region.id)))
        else:
            # A region that is not new and holds the default was emptied by the person on purpose.
            news = region.id not in own or region.id not in old
            names = [*([region.id] if news else ()), *(former[region.id] if base else ())]
            saved = _saved(names, [o for o in orphans if o not in taken])
            if saved is None:
                there = own.get(region.id)
                same = there is not None and same_body(there.body, region.body)
                shown = there if there is not None and same else region  # in the person's layout
                claim = Placement(region, shown.body, region.sig, shown.indent, edited=False)
            else:
                claim = Placement(region, saved.body, saved.sig, saved.indent, edited=True)
                text = f"the saved body of region {saved.id!r} is back"
                text += "" if saved.id == region.id else f" in region {region.id!r}"
                notes.append(Restored(path, None, text, attention=False))
                taken.append(saved)
                notes.extend(_report_changes(path, claim, None, None))
        claims[region.id] = claim
    taken.extend(o for o in orphans if o not in taken and _is_restored(o, claims.get(o.id)))
    lost = tuple(
        Orphan(region.id, path, region.sig, region.indent, region.body)
        for region in hand.values()
        if region.id not in claimed and not is_empty(region.body)
    )
    notes.extend(_report_lost(path, own[o.id], sources.get(o.id)) for o in lost)
    known = {*own, *(orphan.id for orphan in orphans)}
    notes.extend(
        Note(path, None, f"region {name!r} is to come from {was!r}, but nothing of that id is here")
        for name, names in former.items()
        for was in names
        if lost and name not in own and was not in known
    )
    notes.extend(
        Note(path, own[name].line, f"region {name!r} is another one now, with the generated text")
        for name in new
        if name in claimed and name not in sources
    )
    notes.extend(
        Note(
            path, own[was].line, f"{name!r} and {heirs[was]!r} are both declared as {was!r} before"
        )
        for name, names in former.items()
        for was in names
        if was in claimed and sources.get(name) != was
    )
    changed = frozenset(name for name in old.keys() & new.keys() if sources.get(name) != name)
    return Placements(claims, lost, tuple(taken), tuple(notes), changed)


def _untouched(region: Region, before: Region | None, after: Region | None) -> bool:
    return any(r is not None and same_body(region.body, r.body) for r in (before, after))


def _news(region: Region, base: MarkedFile | None, own: Mapping[str, Region]) -> list[str]:
    """Return the former ids that were not declared before: each declaration is applied once.

    One that the last rendering had is applied. So is one in the person's own marker, which a killed
    run may have written without the rendering.
    """
    before, mine = base.regions.get(region.id) if base else None, own.get(region.id)
    if base is None and mine is not None and not mine.explicit:
        return []
    known = {name for one in (before, mine) if one is not None for name in one.was}
    return [old for old in region.was if old not in known]


def _sources(
    regions: Mapping[str, Region], news: Mapping[str, Sequence[str]], before: Container[str]
) -> dict[str, str]:
    """Return for each id whose body it gets; renames are applied at once, whatever is in use.

    An id that passes to another element gets the body that it was ever declared to get, because
    names that move up again are declared in the same words; else it has a new element.
    """
    moved: dict[str, str] = {}
    heirs: dict[str, str] = {}
    pending = deque(news.items())
    while pending:
        new, names = pending.popleft()
        old = next((n for n in names if n in before and n not in heirs and n != new), None)
        if old is not None and new not in moved:
            moved[new], heirs[old] = old, new
            if old in regions and not news[old]:
                pending.append((old, regions[old].was))
    stay = {name: name for name in regions if name not in moved and name not in heirs}
    return {**moved, **stay}


def _saved(names: Iterable[str], orphans: Sequence[Orphan]) -> Orphan | None:
    for name in names:
        found = [orphan for orphan in orphans if orphan.id == name]
        if found:
            return found[-1]
    return None


def _is_restored(orphan: Orphan, claim: Placement | None) -> bool:
    """Return whether a saved body is in a region again: a person may have written more below it."""
    if claim is None or not claim.edited:
        return False
    saved, there = (
        "".join(f"{line.strip()}\n" for line in body.strip().split("\n"))
        for body in (orphan.body, claim.body)
    )
    return f"\n{saved}" in f"\n{there}" or same_body(orphan.body, claim.body)


def _report_lost(path: str, region: Region, heir: str | None) -> Note:
    what = "gone" if heir is None else f"what was {heir!r} now"
    saved = f"its body is saved in {_PLACE}{way_back(region.id)}"
    return Note(path, region.line, f"region {region.id!r} is {what}; {saved}")


def way_back(region_id: str) -> str:
    """Return what else a person can do with a saved body: what is declared as its new place."""
    kind, _, name = region_id.partition(":")
    declared = {"input": f"`renamed_from: {name}`", "node": f"`renamed: {{NEW: {name}}}`"}.get(kind)
    return f"; was it renamed? {declared} in the configuration brings it over" if declared else ""


def _report_changes(
    path: str, claim: Placement, source: Region | None, before: Region | None
) -> list[Note]:
    region, line = claim.region, source.line if source else None
    notes = []
    moved = source is not None and source.id != region.id
    if source is not None and moved:
        text = f"region {source.id!r} is called {region.id!r} now; its body moved along"
        notes.append(Note(path, line, text, attention=False))
    changed = moved or before is None or before.sig != region.sig
    if region.sig is not None and claim.sig != region.sig and changed:
        text = (
            f"the body of region {region.id!r} was written for other inputs or states; "
            "look at it and accept it"
        )
        notes.append(Note(path, line, text))
    return notes
