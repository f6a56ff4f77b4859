"""Bring a package's editable files to the newest rendering, with every hand edit in its place.

Order of writes: saved bodies, rejected edits, what becomes the base, the files, saved bodies that
are back in their files, the base. A process that is killed anywhere leaves a state from which the
next run arrives at the same result.
"""

from __future__ import annotations

import difflib
import hashlib
from collections import Counter
from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass
from functools import partial
from pathlib import Path

from . import names
from .bases import BASES, FORMER, editable_files, read_bases, write_bases
from .conflicts import other_side
from .files import read_regular, stays
from .generated import GENERATED, listed_generated, place_generated, recorded_generated
from .interrupted import end_update
from .manifest import changed_bases, record_bases
from .marked_file import Fault, parse
from .merge import may_return, merge, retire
from .result import Merged, Note, Orphan, RefusedFile
from .store import (
    EDDI,
    IGNORED,
    PRISTINE,
    ChangedMeanwhileError,
    clean_temporaries,
    discard,
    files_below,
    is_hidden,
    linked_records,
    load_orphans,
    read_text,
    refuse_changed,
    remove_file,
    save_orphan,
    save_reject,
    without_sentinel,
    write_file,
)

AGAIN = f"then {names.upgrade}commit and run `copier update --trust`"
"""What a person does to have a package merged once more."""
_SAVES = 5
"""Each starts the merge anew; one who saves more often in a second is no person."""


@dataclass(frozen=True)
class Refusal:
    """A file that was left alone.

    Attributes:
        file: file relative to the package.
        line: line in it, counted from 1.
        reason: why, and what to do.
    """

    file: str
    line: int
    reason: str


@dataclass(frozen=True)
class SyncReport:
    """What a sync did.

    Attributes:
        touched: editable files that were written or removed.
        notes: what happened to hand edits.
        refused: files that were left alone.
    """

    touched: tuple[str, ...] = ()
    notes: tuple[Note, ...] = ()
    refused: tuple[Refusal, ...] = ()

    @property
    def needs_attention(self) -> bool:
        """Whether a person must look at something (exit status 3 of our commands)."""
        return bool(self.refused) or any(note.attention for note in self.notes)


@dataclass(frozen=True)
class _Texts:
    path: str
    base: str | None
    there: str | None  # what the file holds
    mine: str | None  # the same, or what the last commit has
    alike: bool  # base and file may have been changed alike
    theirs: str | None  # None: not rendered any more


@dataclass(frozen=True)
class _Planned:
    texts: _Texts
    merged: Merged


def _nothing(_: str) -> None:
    return None


def sync_package(root: Path, committed: Callable[[str], str | None] = _nothing) -> SyncReport:
    """Merge the new rendering of every editable file of a package with the person's text.

    A second run changes nothing. Files with damaged markers are left alone.

    Args:
        root: the package's folder, with ``.eddi/pristine``; may be a scratch copy.
        committed: text of a file before the rendering, mostly of the last commit.
    """
    linked = linked_folders(root)
    if linked:
        return SyncReport(refused=linked)
    refused: list[Refusal] = []
    touched: list[str] = []
    notes: list[Note] = []
    try:
        for _ in range(_SAVES):  # a person may save a file while it is merged
            refused.clear()
            with suppress(ChangedMeanwhileError):
                _sync(root, committed, refused, touched, notes)
                break
        else:
            refused.clear()
            _sync(root, committed, refused, touched, notes)
        notes.extend(place_generated(root))
        if not refused:
            _clear(root)
        end_update(root)
    except OSError as problem:
        reason = f"{problem.strerror or problem}; nothing is lost; remove the reason, {AGAIN}"
        refused.append(Refusal(_relative(root, problem.filename), 1, reason))
    return SyncReport(tuple(dict.fromkeys(touched)), tuple(dict.fromkeys(notes)), tuple(refused))


def _sync(
    root: Path,
    committed: Callable[[str], str | None],
    refused: list[Refusal],
    touched: list[str],
    notes: list[Note],
) -> None:
    """Merge once.

    Raises:
        ChangedMeanwhileError: a person saved a file in between; it is merged again from there.
    """
    paths = editable_files(root)
    clean_temporaries(root, [*paths, *listed_generated(root), *recorded_generated(root)])
    _settle_renderings(root)
    changed = changed_bases(root)
    _finish_interrupted(root)
    if not (root / PRISTINE).is_dir():  # then the bases are the newest renderings
        paths = [path for path in paths if path not in changed]
    bases = read_bases(root)
    found = [
        _read(root, path, bases.get(path), committed, refused, notes, path in changed)
        for path in paths
    ]
    texts = [text for text in found if text is not None]
    stored = load_orphans(root)
    plan = _plan(texts, list(stored.values()), refused)
    notes.extend(note for planned in plan for note in planned.merged.notes)
    notes.extend(_keep(root, planned) for planned in plan if _may_drop(planned))
    _write(root, plan, stored, touched)


def _settle_renderings(root: Path) -> None:
    """Take the newest side where Copier or git merged renderings, for instance formatted ones."""
    for name in files_below(root / PRISTINE):
        data = read_regular(root / PRISTINE / name)
        if (settled := other_side(data)) != data:
            write_file(root, f"{PRISTINE}/{name}", settled)


def _clear(root: Path) -> None:
    """Remove the renderings, which are the bases now, and what hid them from git.

    They stay where git sees them: Copier would take them for files that a person removed, and never
    render them again; and beside a file in ``generated`` that could not be placed yet.
    """
    if (root / GENERATED).is_dir():
        return
    if (root / PRISTINE).is_dir() and is_hidden(root, "pristine/"):
        discard(root, PRISTINE)
    if not (root / PRISTINE).is_dir() and is_hidden(root, IGNORED):
        remove_file(root / EDDI / IGNORED)


def linked_folders(root: Path) -> tuple[Refusal, ...]:
    """Return the links in the place of folders of a package's records."""
    reason = "it is a link, and the records of a package must lie in the package; remove the link"
    return tuple(Refusal(name, 1, reason) for name in linked_records(root))


def _read(
    root: Path,
    path: str,
    base: str | None,
    committed: Callable[[str], str | None],
    refused: list[Refusal],
    notes: list[Note],
    alike: bool,
) -> _Texts | None:
    records = (BASES, f"{Path(FORMER).name}/{path}", f"next/{path}", f"pristine/{path}")
    places = [path, *(f"{EDDI}/{record}" for record in records)]
    away = [name for name in places if not stays(root, root / name)]
    if away:
        refused.append(Refusal(away[0], 1, "it is behind a link that leads out of the package"))
        return None
    there, pristine = read_text(root / path), read_text(root / PRISTINE / path)
    for found, name in ((there, path), (pristine, f"{PRISTINE}/{path}")):
        if isinstance(found, Fault):
            refused.append(Refusal(name, found.line, found.reason))
            return None
    assert not isinstance(there, Fault)
    assert not isinstance(pristine, Fault)
    mine = there
    theirs = without_sentinel(pristine) if pristine is not None else None
    if not (root / PRISTINE).is_dir():
        theirs = base  # it is merged
    if pristine is not None and theirs is None:
        reason = "the rendering was interrupted (its last line is missing); render again"
        refused.append(Refusal(f"{PRISTINE}/{path}", pristine.count("\n") + 1, reason))
        return None
    if mine is None and base is not None:
        mine = committed(path)  # Copier removes files that the template dropped
        faults = parse(mine)[1] if mine is not None else []
        if faults:
            text = f"the committed text has damaged markers ({faults[0].reason}); it is in git only"
            notes.append(Note(path, faults[0].line, text))
            mine = None
    return _Texts(path, base, there, mine, alike, theirs)


def _plan(texts: Sequence[_Texts], stored: list[Orphan], refused: list[Refusal]) -> list[_Planned]:
    """Merge all files; a body that leaves one file may come back in another one."""
    first = [_merge(text, []) for text in texts]
    refused.extend(
        Refusal(text.path, fault.line, fault.reason)
        for text, result in zip(texts, first, strict=True)
        if isinstance(result, RefusedFile)
        for fault in result.faults
    )
    done = [
        _Planned(text, result)
        for text, result in zip(texts, first, strict=True)
        if isinstance(result, Merged)
    ]
    pool = stored + [orphan for planned in done for orphan in planned.merged.orphans]
    if not pool:
        return done
    plan = []
    for planned in done:
        if planned.texts.theirs is None or not may_return(planned.texts.theirs, pool):
            plan.append(planned)
            continue
        result = _merge(planned.texts, pool)
        assert isinstance(result, Merged)
        pool = [orphan for orphan in pool if orphan not in result.taken]
        plan.append(_Planned(planned.texts, result))
    return plan


def _merge(texts: _Texts, orphans: Sequence[Orphan]) -> Merged | RefusedFile:
    if texts.theirs is not None:
        return merge(texts.path, texts.base, texts.mine, texts.theirs, orphans)
    if texts.mine is None:
        return Merged(None)
    return retire(texts.path, texts.base, texts.mine)


def _may_drop(planned: _Planned) -> bool:
    """Return whether lines leave a file that only seem to be generated."""
    texts = (planned.texts.mine or "", planned.merged.text or "")
    own, new = (Counter(line.strip() for line in text.splitlines()) for text in texts)
    return planned.texts.alike and any((own - new).keys())


def _keep(root: Path, planned: _Planned) -> Note:
    path, text = planned.texts.path, planned.texts.mine or ""
    copy = save_reject(root, path, text.encode(), ".edited").relative_to(root)
    reason = (
        f"its base in {EDDI}/{BASES} is not what was recorded, as after a replacement over many "
        f"files: your lines and generated ones looked alike, so all of the file is kept in {copy}"
    )
    return Note(path, None, reason)


def _write(
    root: Path, plan: Sequence[_Planned], stored: dict[Path, Orphan], touched: list[str]
) -> None:
    places = {orphan: path for path, orphan in stored.items()}
    for planned in plan:
        for orphan in planned.merged.orphans:
            places[orphan] = save_orphan(root, orphan)
    for planned in plan:
        if planned.merged.patch:
            save_reject(root, planned.texts.path, planned.merged.patch.encode())
    for planned in plan:
        _write_next(root, planned)
    left = list(plan)
    try:
        while left:
            if _write_one(root, left[0]):
                touched.append(left[0].texts.path)
            left.pop(0)
    except (
        ChangedMeanwhileError
    ):  # the merge that follows saves what leaves the files that are left
        saved = {places[orphan] for planned in left for orphan in planned.merged.orphans}
        for path in saved - stored.keys():
            remove_file(path)
        raise
    for planned in plan:
        for orphan in planned.merged.taken:
            remove_file(places[orphan])
    _commit(root, {planned.texts.path: planned.texts.theirs for planned in plan})


def _write_one(root: Path, planned: _Planned) -> bool:
    path, text = planned.texts.path, planned.merged.text
    check = partial(refuse_changed, root / path, planned.texts.there)
    if text is None:
        check()
        return remove_file(root / path)
    return write_file(root, path, text.encode(), f"{PRISTINE}/{path}", check)


def _write_next(root: Path, planned: _Planned) -> None:
    texts, text = planned.texts, planned.merged.text
    if text is None or texts.theirs is None or texts.base in {None, texts.theirs}:
        return
    data = next_base(text.encode(), texts.theirs.encode())
    write_file(root, f"{EDDI}/next/{texts.path}", data)


def next_base(text: bytes, base: bytes) -> bytes:
    """Return the content of ``.eddi/next/F``: when F holds ``text``, its base is ``base``."""
    return hashlib.sha256(text).hexdigest().encode() + b"\n" + base


def _commit(root: Path, made: Mapping[str, str | None]) -> None:
    """Make these renderings the base of their files; ``None``: they have none any more."""
    before = read_bases(root)
    now = {path: base for path, base in {**before, **made}.items() if base is not None}
    write_bases(root, now)
    for path in made:
        if now.get(path) != before.get(path):
            remove_file(root / EDDI / "accepted" / path)
    record_bases(root, made)
    for path in made:
        remove_file(root / EDDI / "next" / path)


def _finish_interrupted(root: Path) -> None:
    """Commit the base of files that a killed sync had already replaced.

    Without this, a new rendering after the kill would be merged against a base that is one
    rendering older than the file.
    """
    made: dict[str, str | None] = {}
    bases = read_bases(root)
    for path in files_below(root / EDDI / "next"):
        text, mine = read_text(root / EDDI / "next" / path), read_text(root / path)
        base = made[path] = bases.get(path)
        if isinstance(text, str) and isinstance(mine, str):
            digest, _, theirs = text.partition("\n")
            replaced = digest == hashlib.sha256(mine.encode()).hexdigest()
            # a person may have edited the file between the kill and now
            if replaced or (base is not None and _nearer(mine, theirs, base)):
                made[path] = theirs
    _commit(root, made)


def _nearer(mine: str, theirs: str, base: str) -> bool:
    """Return whether a text was made of ``theirs`` rather than of ``base``."""
    lines = mine.splitlines()
    alike = [
        difflib.SequenceMatcher(None, text.splitlines(), lines, autojunk=False).ratio()
        for text in (theirs, base)
    ]
    return alike[0] > alike[1]


def _relative(root: Path, name: object) -> str:
    try:
        return Path(str(name)).relative_to(root).as_posix() if name else str(root)
    except ValueError:
        return str(name)
