"""Which body goes into which region: by id, by declared former id, by saved body."""

from __future__ import annotations

from collections import Counter
from collections.abc import Container, Iterable, Mapping, Sequence
from dataclasses import dataclass, replace

from eddi_scaffold.regions.bodies import is_empty, same_body
from eddi_scaffold.regions.marked_file import MarkedFile, Region
from eddi_scaffold.regions.result import Note, Orphan


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
    """

    by_id: Mapping[str, Placement]
    orphans: tuple[Orphan, ...]
    taken: tuple[Orphan, ...]
    notes: tuple[Note, ...]


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
    hand = {
        region.id: region
        for region in own.values()
        if not _untouched(region, old.get(region.id), new.get(region.id))
    }
    claims: dict[str, Placement] = {}
    claimed: set[str] = set()
    taken: list[Orphan] = []
    notes: list[Note] = []
    for region in new.values():
        former = _former_ids(region, base, own, new)
        source = _own_or_former(region, former, hand, claimed)
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
            names = [*([region.id] if news else ()), *(former if base else ())]
            saved = _saved(names, [o for o in orphans if o not in taken])
            if saved is None:
                claim = Placement(region, region.body, region.sig, region.indent, edited=False)
            else:
                claim = Placement(region, saved.body, saved.sig, saved.indent, edited=True)
                text = f"the saved body of region {saved.id!r} is back in region {region.id!r}"
                notes.append(Note(path, None, text, attention=False))
                taken.append(saved)
                notes.extend(_report_changes(path, claim, None, old.get(region.id)))
        claims[region.id] = claim
    taken.extend(o for o in orphans if o not in taken and _is_restored(o, claims.get(o.id)))
    lost = tuple(
        Orphan(region.id, path, region.sig, region.indent, region.body)
        for region in hand.values()
        if region.id not in claimed and not is_empty(region.body)
    )
    notes.extend(
        Note(path, own[o.id].line, f"region {o.id!r} is gone; its body is saved in .eddi/orphans")
        for o in lost
    )
    return Placements(claims, lost, tuple(taken), tuple(notes))


def _untouched(region: Region, before: Region | None, after: Region | None) -> bool:
    return any(r is not None and same_body(region.body, r.body) for r in (before, after))


def _former_ids(
    region: Region, base: MarkedFile | None, own: Mapping[str, Region], new: Mapping[str, Region]
) -> list[str]:
    """Return the former ids that are news; an old declaration must not catch another element.

    Answers keep ``renamed_from`` for ever, and the former id may name something else by now.
    """
    if base is None:
        known: Iterable[str] = region.was if region.id in own else ()
    else:
        before = base.regions.get(region.id)
        known = before.was if before else ()
    return [old for old in region.was if old not in known and old not in new]


def _own_or_former(
    region: Region, former: Iterable[str], hand: Mapping[str, Region], claimed: Container[str]
) -> Region | None:
    names = [region.id, *(old for old in former if old not in claimed)]
    return next((hand[name] for name in names if name in hand), None)


def _saved(names: Iterable[str], orphans: Sequence[Orphan]) -> Orphan | None:
    for name in names:
        found = [orphan for orphan in orphans if orphan.id == name]
        if found:
            return found[-1]
    return None


def _is_restored(orphan: Orphan, claim: Placement | None) -> bool:
    return claim is not None and claim.edited and same_body(orphan.body, claim.body)


def _report_changes(
    path: str, claim: Placement, source: Region | None, before: Region | None
) -> list[Note]:
    region, line = claim.region, source.line if source else None
    notes = []
    if source is not None and source.id != region.id:
        text = f"region {source.id!r} is called {region.id!r} now; its body moved along"
        notes.append(Note(path, line, text, attention=False))
    changed = before is None or before.sig != region.sig
    if region.sig is not None and claim.sig != region.sig and changed:
        text = (
            f"the body of region {region.id!r} was written for other inputs or states; "
            "look at it and accept it"
        )
        notes.append(Note(path, line, text))
    return notes
