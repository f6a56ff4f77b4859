"""List the regions of a package and what a person should look at."""

from __future__ import annotations

import hashlib
import os
from collections.abc import Callable, Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cache, partial
from pathlib import Path
from typing import Literal

from . import names
from .bases import BASES, FORMER, bases_of, editable_files, newest_rendering, read_bases
from .bodies import same_body
from .conflicts import CONFLICT, conflict_lines, separator_lines
from .files import entries, read_regular, stays
from .fitting import made_of, missing_parts
from .generated import GENERATED, listed_generated, recorded_generated
from .git import former_texts
from .lost import lost_markers
from .manifest import ANSWERS, MANIFEST, changed_bases, recorded_rendering, rendering_digest
from .marked_file import Fault, MarkedFile, Region, parse
from .markers import with_sig
from .merge import check_text, dissolve, kind_of
from .outside import same_lines
from .paths import is_relative
from .placements import adopt_ids, way_back
from .store import (
    EDDI,
    PRISTINE,
    SAVED,
    files_below,
    load_accepted,
    load_orphans,
    read_text,
    refuse_changed,
    save_accepted,
    without_sentinel,
    write_file,
)
from .sync import Refusal, linked_folders

_RECORD = f"{EDDI}/{MANIFEST}"
_CONFLICT_OF_RECORD = "merge conflict in a record: resolve the others, then generate again"
_PROBE = 8000
"""Bytes in which git looks for a zero byte, to tell that a file is no text."""
_OTHER = "written for other inputs or states; look at it, then accept it"
_LANGUAGES = {"python": "Python", "xml": "XML"}
Doubts = Callable[[str, Iterable[Region]], Mapping[str, Sequence[str]]]
"""Tells from a module and its hand-written regions what is doubtful in each of them."""
State = Literal["untouched", "edited", "orphaned", "rejected", "broken", "unfit"]


@dataclass(frozen=True)
class RegionStatus:
    """One region, saved body, rejected edit or damaged marker.

    Attributes:
        id: the region; of a rejected edit the edited file; empty for what concerns a file.
        file: file relative to the package; of saved bodies the file they came from.
        line: line of the begin marker, ``None`` when it is in no file.
        state: ``untouched`` holds the default; ``unfit``: file and records are of different
            renderings, or no program can read the file.
        notes: what to look at.
        review: whether a person must look (``regions --check`` fails).
    """

    id: str
    file: str
    line: int | None
    state: State
    notes: tuple[str, ...] = ()
    review: bool = False


def _no_doubts(_text: str, _regions: Iterable[Region]) -> Mapping[str, Sequence[str]]:
    return {}


def list_regions(root: Path, doubts: Doubts = _no_doubts) -> tuple[RegionStatus, ...]:
    """Return all regions of a package, by file and line, and what a person should look at.

    Args:
        root: the package.
        doubts: what else to look at in Python, which a template knows and the merge does not.
    """
    linked = linked_folders(root)
    if linked:
        return tuple(_broken(refusal) for refusal in linked)
    found: list[RegionStatus] = []
    if _has_lost_renderings(root):
        note = "without this folder hand edits and generated text look the same; generate again"
        found.append(RegionStatus("", EDDI, None, "broken", (note,), review=True))
    found += _regions(root, doubts)
    broken = {one.file for one in found if one.state == "broken"}
    found += [
        one for one in unfit_files(root, partial(former_texts, root)) if one.file not in broken
    ]
    return (*found, *_saved(root), *_conflicts(root, broken))


def open_edits(root: Path) -> list[RegionStatus]:
    """Return what a merge reported and is still open: not accepted, placed or removed."""
    linked = linked_folders(root)
    if linked:
        return [_broken(refusal) for refusal in linked]
    return [*_saved(root), *(status for status in _regions(root) if _OTHER in status.notes)]


def _saved(root: Path) -> Iterator[RegionStatus]:
    """Yield the bodies and edits that have no place in the files."""
    for path, orphan in load_orphans(root).items():
        place = path.relative_to(root).as_posix()
        file = orphan.file if is_relative(orphan.file) else place
        note = f"saved in {place}; delete it if it is not needed{way_back(orphan.id)}"
        yield RegionStatus(orphan.id, file, None, "orphaned", (note,), review=True)
    for name in files_below(root / EDDI / "rejects"):
        note = "put the edit where it belongs now, then delete this file"
        file = f"{EDDI}/rejects/{name}"
        yield RegionStatus(name, file, None, "rejected", (note,), review=True)


def regions_of(root: Path) -> list[RegionStatus]:
    """Return the regions of the editable files, and damaged markers; no other file is read."""
    return [] if linked_folders(root) else _regions(root)


def _regions(root: Path, doubts: Doubts = _no_doubts) -> list[RegionStatus]:
    bases = read_bases(root)
    return [
        status
        for name in editable_files(root)
        for status in _of_file(root, name, bases.get(name), doubts)
    ]


def _conflicts(root: Path, known: Collection[str]) -> list[RegionStatus]:
    """Return the text files with conflict markers, but for our copies of text without a place."""
    return [
        _broken(Refusal(name, lines[0], _CONFLICT_OF_RECORD if name == _RECORD else CONFLICT))
        for name, kind in entries(root, skip=("__pycache__", ".git"))
        if kind is None and name not in known and not name.startswith(SAVED)
        if (lines := _conflict_lines(root, name))
    ]


def _conflict_lines(root: Path, name: str) -> Sequence[int]:
    try:
        data = read_regular(root / name)
    except OSError:
        return ()
    if b"\0" in data[:_PROBE]:
        return ()
    text = data.decode("latin-1")  # lines are the same in any encoding
    lines = conflict_lines(text)
    alone = () if lines else separator_lines(text)
    return alone if alone and check_text(name, text) is not None else lines


def _has_lost_renderings(root: Path) -> bool:
    """Return whether renderings of editable files are gone; some templates have no such file."""
    return not recorded_generated(root) and not editable_files(root)


def unfit_files(
    root: Path, former: Callable[[str], Mapping[str, str]] = lambda _: {}
) -> list[RegionStatus]:
    """Return the files that cannot be read, or were not made of what the records say.

    Args:
        root: the package.
        former: versions of a file in the history, by commit; none where that is not known.
    """
    found = []
    changed, bases, former = changed_bases(root), read_bases(root), cache(former)
    if not changed and not _is_of_one_rendering(root):
        note = "answers and renderings are not of one run, of two branches, or were changed by hand"
        found.append(_unfit(ANSWERS, f"{note}: look at `git diff {EDDI}`, then generate again"))
    if listed_generated(root):
        found.append(_unfit(GENERATED, "these renderings are not in their places; generate again"))
    for name in editable_files(root):
        text = read_text(root / name)
        fault = check_text(name, text) if isinstance(text, str) else None
        if fault is not None:
            note = f"it is not valid {_LANGUAGES[kind_of(name)]}: {fault.reason}"
            found.append(RegionStatus("", name, fault.line, "unfit", (note,), review=True))
        notes = _misfits(root, name, bases.get(name), former)
        if name in changed:
            notes.insert(
                0,
                f"its base in {EDDI}/{BASES} is not what was recorded, as after a replacement over"
                " many files or a merge: your lines and generated ones look alike; `git checkout --"
                f" {EDDI}` puts back what was changed by hand, else generate again: lines that go"
                " are kept",
            )
        if notes:
            found.append(_unfit(name, *notes))
    return found


def _misfits(
    root: Path, name: str, merged: str | None, former: Callable[[str], Mapping[str, str]]
) -> list[str]:
    pristine = read_text(root / PRISTINE / name)
    if isinstance(pristine, Fault):
        return []
    if not os.path.lexists(root / name):
        cure = f"`git -C {root} checkout HEAD -- {name}` brings back what was committed"
        return [f"it is missing; {cure}, else generate again"]
    rendered = merged if pristine is None else without_sentinel(pristine)
    if rendered is None:
        return ["its rendering is not whole (interrupted, or of two branches); generate again"]
    if rendered != merged:
        return ["its newest rendering has not been merged into it; generate again"]
    return list(_strange_parts(root, name, merged, former).values())


def _strange_parts(
    root: Path,
    name: str,
    merged: str | None,
    former: Callable[[str], Mapping[str, str]],
    known: Collection[str] = (),
) -> dict[str, str]:
    """Return in what a file does not fit its base, but for what a person accepted; part -> note.

    Former renderings among the parts that are ``known`` are passed over.
    """
    _, mine, theirs, _ = _documents(root, name, merged)
    base, place = _base(merged, theirs), f"{EDDI}/{BASES}"
    if mine is None or base is None:
        return {}
    missing = missing_parts(base, mine, python=kind_of(name) == "python")
    accepted = load_accepted(root, name)
    found = {part: note for part, note in missing.items() if part not in accepted}
    if same_lines(base.skeleton, mine.skeleton):
        return found
    texts = {key: text for key, text in _former(name, former).items() if text != merged}
    olds = {
        key: parse(one)[0] for key, one in texts.items() if _part_of(one) not in {*accepted, *known}
    }
    commit = made_of(base, mine, olds)
    if commit is not None:
        kept = place if bases_of(former(place).get(commit, "")) else f"{FORMER}/{name}"
        cure = f"run 'git checkout {commit} -- {kept}', then generate again"
        note = f"generated lines are of the rendering in {commit}; {cure}"
        found[_part_of(texts[commit])] = f"{note}; if the file is right, accept it"
    elif found:
        branches = f"after a merge of branches, take {place} of the file's branch first"
        found[[*found][-1]] += f"; generate again, and it is back ({branches}); or accept the file"
    return found


def _former(name: str, former: Callable[[str], Mapping[str, str]]) -> dict[str, str]:
    """Return the bases that a file had in the history, by commit."""
    whole = {key: bases_of(text) for key, text in former(f"{EDDI}/{BASES}").items()}
    found = {key: bases[name] for key, bases in whole.items() if name in bases}
    return {**former(f"{FORMER}/{name}"), **found}


def _part_of(rendering: str) -> str:
    return hashlib.sha256(rendering.encode()).hexdigest()


def _unfit(name: str, *notes: str) -> RegionStatus:
    return RegionStatus("", name, None, "unfit", notes, review=True)


def _is_of_one_rendering(root: Path) -> bool:
    return recorded_rendering(root) in {"", rendering_digest(root)}


def mixed_renderings(root: Path, committed: Callable[[str], str | None]) -> str | None:
    """Return what to do before an update of a package that branches were merged in.

    Copier would render what the package was made of, and take the difference for a person's edit.

    Args:
        root: the package.
        committed: text of a file in the last commit.
    """
    answers = read_text(root / ANSWERS)
    if not isinstance(answers, str) or answers != committed(ANSWERS):
        return None  # there is a new rendering already
    bases = read_bases(root)
    texts = {name: read_text(root / PRISTINE / name) for name in bases}
    whole = {n: without_sentinel(text) for n, text in texts.items() if isinstance(text, str)}
    merged = all(text == bases[name] for name, text in whole.items())
    one = _is_of_one_rendering(root) and not changed_bases(root)
    if None not in whole.values() and (not merged or one):
        return None
    return (
        "answers and renderings are of two branches, of a run that was interrupted, or changed by"
        f" hand: {names.upgrade}run `copier recopy --trust --force`, which brings all to one, and"
        " commit"
    )


def broken_files(root: Path) -> tuple[Refusal, ...]:
    """Return the damaged markers of a package: a new rendering could not be merged."""
    return linked_folders(root) or tuple(
        Refusal(status.file, status.line or 1, "; ".join(status.notes))
        for status in _regions(root)
        if status.state == "broken"
    )


def accept(root: Path, words: Iterable[str]) -> tuple[str, ...]:
    """Confirm that bodies, or files that do not fit their base, were reviewed and are right.

    The markers of a body get the signature of the newest rendering; what a file has or lacks
    against its base counts as written by hand until the base changes.

    Args:
        root: the package.
        words: ids of regions, and editable files relative to the package.

    Returns:
        The words that were found; files with damaged markers are left alone.
    """
    wanted, accepted = set(words), []
    if linked_folders(root):
        return ()
    bases = read_bases(root)
    for name in editable_files(root):
        base = bases.get(name)
        if name in wanted and (parts := _all_strange_parts(root, name, base)):
            save_accepted(root, name, parts)
            accepted.append(name)
        text, mine, theirs, _ = _documents(root, name, base)
        if text is None or mine is None or theirs is None or not stays(root, root / name):
            continue
        lines = text.split("\n")
        for region in mine.regions.values():
            current = theirs.regions.get(region.id)
            if region.id in wanted and current is not None:
                line = lines[region.line - 1]
                end = "\r" if line.endswith("\r") else ""
                lines[region.line - 1] = with_sig(line.rstrip("\r"), current.sig) + end
                accepted.append(region.id)
        check = partial(refuse_changed, root / name, text)
        write_file(root, name, "\n".join(lines).encode(), check=check)
    return tuple(accepted)


def _all_strange_parts(root: Path, name: str, base: str | None) -> set[str]:
    """Return the same parts, with every former rendering that the file has lines of."""
    former, found = cache(partial(former_texts, root)), set[str]()
    while new := _strange_parts(root, name, base, former, found).keys() - found:
        found |= new
    return found


def _documents(
    root: Path, name: str, base: str | None
) -> tuple[str | None, MarkedFile | None, MarkedFile | None, list[Fault]]:
    """Return a file's text, it and its rendering split at the markers, and what is wrong."""
    text = read_text(root / name)
    rendered = newest_rendering(root, name, base)
    theirs = parse(rendered.replace("\r\n", "\n"))[0] if isinstance(rendered, str) else None
    if isinstance(text, Fault):
        return None, None, theirs, [text]
    if text is None:
        return None, None, theirs, []
    mine, faults = parse(text)
    if faults:
        return text, None, theirs, faults
    return text, adopt_ids(mine, theirs) if theirs else mine, theirs, []


def _of_file(root: Path, name: str, merged: str | None, doubts: Doubts) -> list[RegionStatus]:
    text, mine, theirs, faults = _documents(root, name, merged)
    base = _base(merged, theirs)
    if mine is not None and base is not None and not (root / EDDI / "next" / name).exists():
        faults = lost_markers(base, dissolve(mine, base, theirs or base))
    broken = [_broken(Refusal(name, fault.line, fault.reason)) for fault in faults]
    if text is None or mine is None or broken:
        return broken
    old = base.regions if base is not None else {}
    new = theirs.regions if theirs else {}
    edited = {
        r.id: r
        for r in mine.regions.values()
        if not any(
            d is not None and same_body(r.body, d.body) for d in (old.get(r.id), new.get(r.id))
        )
    }
    doubtful = [
        r
        for r in mine.regions.values()
        if r.id in edited or (r.id in old and old[r.id].function != r.function)
    ]
    notes = doubts(text, doubtful) if kind_of(name) == "python" else {}
    return [
        _edited(name, region, new.get(region.id), notes.get(region.id, ()))
        if region.id in edited
        else _untouched(name, region, notes.get(region.id, ()))
        for region in mine.regions.values()
    ]


def _base(text: str | None, theirs: MarkedFile | None) -> MarkedFile | None:
    if text is None:
        return None
    document, faults = parse(text)
    return None if faults else adopt_ids(document, theirs or document)


def _broken(found: Refusal) -> RegionStatus:
    return RegionStatus("", found.file, found.line, "broken", (found.reason,), review=True)


def _untouched(name: str, region: Region, doubts: Sequence[str]) -> RegionStatus:
    notes = tuple(doubts)
    return RegionStatus(region.id, name, region.line, "untouched", notes, review=bool(notes))


def _edited(name: str, region: Region, new: Region | None, doubts: Iterable[str]) -> RegionStatus:
    notes = list(doubts)
    if new is not None and new.sig is not None and region.sig != new.sig:
        notes.insert(0, _OTHER)
    return RegionStatus(region.id, name, region.line, "edited", tuple(notes), review=bool(notes))
