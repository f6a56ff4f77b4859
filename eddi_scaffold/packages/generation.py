"""Bring packages to the state that their answers describe, keeping every hand edit.

All packages of one command are rendered and merged in a scratch folder; the destination changes at
the end, in one step, or not at all.
"""

from __future__ import annotations

import difflib
import os
import shutil
from collections.abc import Callable, Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import partial
from pathlib import Path
from typing import Any

from eddi_scaffold.compiling.package import write_compiled
from eddi_scaffold.packages import transaction
from eddi_scaffold.packages.current import UNCOMMITTED, is_current
from eddi_scaffold.packages.handwritten import lost_sources
from eddi_scaffold.packages.links import follow
from eddi_scaffold.packages.moved import committed_base, gone
from eddi_scaffold.packages.obstacles import obstacles
from eddi_scaffold.packages.renaming import NO_RENAMES, Renames, mentions
from eddi_scaffold.packages.rendering import ANSWERS_FILE, Renderer, Template, read_answers
from eddi_scaffold.packages.review import ADOPT, is_of_d72
from eddi_scaffold.packages.scratch import scratch_folder
from eddi_scaffold.packages.transaction import NEW, NEW_PROGRAM, FileState
from eddi_scaffold.packages.unpacking import unpacked
from eddi_scaffold.packages.workspace import linked_package, refuse_newer
from eddi_scaffold.platforms import PackageAnswers
from eddi_scaffold.problems import EddiError, Place, Problem, error
from eddi_scaffold.regions.bases import BASES, FORMER, bases_of, read_bases, write_bases
from eddi_scaffold.regions.check import RegionStatus, broken_files, open_edits, unfit_files
from eddi_scaffold.regions.files import entries, stays
from eddi_scaffold.regions.generated import GENERATED, listed_generated
from eddi_scaffold.regions.git import committed_text, former_texts
from eddi_scaffold.regions.manifest import record_files, recorded_files
from eddi_scaffold.regions.marked_file import parse
from eddi_scaffold.regions.placements import adopt_ids
from eddi_scaffold.regions.python_text import parse_python, reason_of
from eddi_scaffold.regions.result import Restored
from eddi_scaffold.regions.store import EDDI, PRISTINE, SAVED, in_scratch, save_orphan, save_reject
from eddi_scaffold.regions.sync import Refusal, SyncReport, next_base, sync_package

_BASES = f"/{EDDI}/{BASES}"


@dataclass(frozen=True)
class Outcome:
    """What a command did, or would do.

    Attributes:
        root: folder that all paths are relative to.
        changes: path -> new state, ``None`` for a removed file.
        before: path -> state before, for the changed ones that existed.
        notes: one line each: what happened to hand edits, warnings of Copier.
        attention: a person must look at hand edits.
        left: one line each: what should have changed, but is a link or no regular file.
    """

    root: Path
    changes: Mapping[str, FileState | None]
    before: Mapping[str, FileState]
    notes: Sequence[str]
    attention: bool
    left: Sequence[str] = ()

    def diff(self) -> str:
        """Return the change as a unified diff, paths relative to ``root``, without our records."""
        return "".join(
            _diff(path, self.before.get(path), state)
            for path, state in sorted(self.changes.items())
            if "/.eddi/" not in path and not path.endswith(f"/{ANSWERS_FILE}")
        )


@dataclass
class _Work:
    """What the packages of one command add up to."""

    changes: dict[str, FileState | None] = field(default_factory=dict)
    before: dict[str, FileState] = field(default_factory=dict)
    notes: list[str] = field(default_factory=list)
    left: list[str] = field(default_factory=list)
    links: dict[str, Path] = field(default_factory=dict)
    attention: bool = False


def write_packages(
    root: Path,
    packages: Sequence[PackageAnswers],
    template: Template,
    *,
    within: Path | None = None,
    renames: Renames = NO_RENAMES,
    force: bool = False,
    dry_run: bool = False,
    progress: Callable[[str], None] = lambda _: None,
) -> Outcome:
    """Render the packages, merge them with what is below ``root``, and write the result.

    Args:
        root: folder that the packages' folders are relative to.
        packages: what to render.
        template: where from.
        within: folder that links to editable files may lead into, around ``root``; by default each
            package.
        renames: packages among them that were there under another name.
        force: also packages that a later release made.
        dry_run: change nothing.
        progress: called with the folder of each package before it is rendered.

    Raises:
        EddiError: a hand-edited file has damaged markers (H010), a result does not compile (H011),
            a model cannot be compiled (K028), the destination (F002) or the place of the
            templates (T002) cannot be written, a file was saved meanwhile (F013), or a later
            release made a package (T006); nothing was written.
    """
    if not force:
        refuse_newer(root / package.folder for package in packages)
    work = _Work()
    if not dry_run:
        for place in dict.fromkeys([root, within or root]):
            work.notes += transaction.recover(place)
        template.keep()
    with (
        scratch_folder("eddi-scaffold-") as scratch,
        unpacked(template.bundle or Path(template.location), template.ref) as source,
    ):
        work.notes += source.notes
        renderer = Renderer(template, source)
        for number, package in enumerate(packages):
            rendered = Path(scratch, str(number), "rendered")
            target = root / package.folder
            if not package.answers:
                rendered.mkdir(parents=True)
                notes = [f"{package.folder}: removed, nothing needs it any more"]
            elif package.folder not in renames.involved and is_current(
                target, package, template, source
            ):
                still_open = [_open(package, one) for one in open_edits(target)]
                work.notes += still_open
                work.attention = work.attention or bool(still_open)
                continue
            else:
                progress(package.folder)
                notes = _render(renderer, package, rendered, target)
                if source.notes:
                    (rendered / UNCOMMITTED).write_text("rendered from templates with changes\n")
            _merge_package(root, package, rendered, notes, within, renames, work)
    remains = renames.remains(root, {package.folder for package in packages})
    work.changes.update(dict.fromkeys(remains))
    work.before.update(remains)
    if not dry_run:
        written = _write(root, work, within)
        work.left += written.left
        work.notes += written.notes
    return Outcome(root, work.changes, work.before, work.notes, work.attention, work.left)


def _render(renderer: Renderer, package: PackageAnswers, rendered: Path, target: Path) -> list[str]:
    """Render a package with what Copier does not render, and return what is to be said of it."""
    notes = renderer.render(package.answers, rendered)
    for name, data in package.files.items():
        place = rendered / GENERATED / name
        place.parent.mkdir(parents=True, exist_ok=True)
        place.write_bytes(data)
    problem = write_compiled(rendered)
    if problem is not None:
        raise EddiError(error("K028", problem, Place(str(target))))
    return notes


def _merge_package(
    root: Path,
    package: PackageAnswers,
    rendered: Path,
    notes: list[str],
    within: Path | None,
    renames: Renames,
    work: _Work,
) -> None:
    target = root / package.folder
    if target.is_symlink():
        work.left.append(linked_package(target))
        return
    tree = renames.content(root, package.folder)
    names = [*_names(rendered), *_names(rendered / GENERATED)]
    links = follow(target, tree, names, within, work.links.values())
    found = obstacles(package.folder, tree.others, names)
    stop = found.at_records(ANSWERS_FILE)
    if stop is None:
        written = tree.others or any(not path.startswith(SAVED) for path in tree.files)
        was = read_answers(root / renames.former.get(package.folder, package.folder))
        if written and was is None:
            raise _foreign(target)
        before = {path: state for path, state in tree.files.items() if path not in found.skipped}
        merged = _merged(target, package, before, rendered, found.skipped, was or {})
        stop = found.before(merged.changes)
    if stop is not None:
        work.left.append(found.stop(stop))
        return
    work.left += found.waiting_notes()
    work.links |= {f"{package.folder}/{path}": real for path, real in links.items()}
    changes = merged.changes
    if package.folder in renames.involved:
        after = {p: state for p, state in {**before, **changes}.items() if state is not None}
        former = renames.former.get(package.folder)
        if former is not None:
            work.notes.append(f"{former} is called {package.folder} now; all in it moved along")
            generated = listed_generated(rendered)
            work.left += mentions(after, former, package.folder, generated)
        before = renames.present(target).files
        changes = {p: after.get(p) for p in {*before, *after} if before.get(p) != after.get(p)}
    work.changes.update({f"{package.folder}/{p}": state for p, state in changes.items()})
    work.before.update({f"{package.folder}/{p}": before[p] for p in changes if p in before})
    work.notes += [note for note in (*notes, *merged.look) if note not in work.notes]
    anew = list(_written_anew(target, before, changes))
    work.notes += [f"{package.folder}/{note}" for note, _ in anew]
    is_new = not before and "model_json" in package.answers
    missed = gone(root, package.folder, within or root) if is_new else None
    work.notes += [missed] if missed is not None else []
    work.notes += [f"{package.folder}/{note}" for note in _regions_anew(before, changes)]
    work.notes += [
        f"{package.folder}/{note.file}: {note.text}"
        for note in merged.report.notes
        if not (package.saved and isinstance(note, Restored))  # an adoption says so itself
    ]
    work.notes += found.untouched()
    lost = missed is not None or any(edited for _, edited in anew)
    work.attention = work.attention or merged.is_open or lost


@dataclass(frozen=True)
class _Merged:
    """A package with its new rendering.

    Attributes:
        changes: path -> new state, ``None`` for a removed file.
        look: inputs without their sources, files that do not fit their base, what is
            left to do since an earlier run.
        report: what happened to hand edits.
        is_open: a person must look at hand edits, because of this run or of an earlier one.
    """

    changes: Mapping[str, FileState | None]
    look: Sequence[str]
    report: SyncReport
    is_open: bool


def _merged(
    target: Path,
    package: PackageAnswers,
    before: Mapping[str, FileState],
    rendered: Path,
    skipped: Collection[str],
    was: Mapping[str, Any],
) -> _Merged:
    """Merge a rendering with the files of a package, in the scratch folder.

    Args:
        target: where the package is, for messages.
        package: what was rendered.
        before: its files, empty for a new one.
        rendered: the rendering.
        skipped: files of the rendering that wait for an obstacle in their place.
        was: its answers before, maybe under another name.
    """
    staged = rendered.with_name("staged")
    waiting: Mapping[str, str] = {}
    if before:
        _copy(before, staged)
        _refuse(broken_files(staged), target)
        # outside edits are merged per definition, which text that is not Python does not have
        bases = read_bases(staged)
        _check_python(before, bases, target)
        waiting = {name: text for name, text in bases.items() if name in skipped}
        if waiting:  # they stay as they are on the disk
            write_bases(staged, {n: t for n, t in bases.items() if n not in waiting})
    _copy_rendering(rendered, staged, skipped)
    for body in package.saved:
        save_orphan(staged, body)
    for name, lines in package.adopted.items():
        save_reject(staged, name, lines, ".adopted")

    def earlier(path: str) -> str | None:
        state = before.get(path)
        return committed_text(target, path) if state is None else state.text

    with in_scratch():
        report = sync_package(staged, earlier)
        if waiting:
            write_bases(staged, {**read_bases(staged), **waiting})
            record_files(staged, recorded_files(staged))  # what all of it was made of
    _refuse(report.refused, target)
    for name in _names(rendered / PRISTINE):
        header = package.headers.get(Path(name).name)
        if header:
            (staged / name).write_text(header + (staged / name).read_text("utf-8"), "utf-8")
    after = {
        path: _with_mode(state, before.get(path))
        for path, state in transaction.tree_of(staged).items()
        if package.answers or not _is_record(path)
    }
    ours = {*_names(rendered / PRISTINE), *_names(rendered / GENERATED)}
    _check_python(after, ours, target)
    changed = {p: after.get(p) for p in {*before, *after} if before.get(p) != after.get(p)}
    lost = lost_sources(staged, was, package.answers)
    unfit = unfit_files(staged, partial(former_texts, target)) if package.answers else ()
    look = [
        *(f"{package.folder}: {one}" for one in lost),
        *(
            f"{package.folder}/{one.file}: {'; '.join(one.notes)}"
            for one in unfit
            if one.file not in skipped
        ),
    ]
    still_open = {(one.id, one.file): one for one in open_edits(staged)}
    is_open = bool(look) or report.needs_attention or bool(still_open)
    said = [note.text for note in report.notes]
    look += [
        _open(package, still_open[one.id, one.file])
        for one in (open_edits(target) if still_open else ())
        if (one.id, one.file) in still_open and not any(repr(one.id) in text for text in said)
    ]
    return _Merged(changed, look, report, is_open)


def _open(package: PackageAnswers, left: RegionStatus) -> str:
    id_ = left.id if left.state != "rejected" else ""
    words = (f"{package.folder}/{left.file}", id_, "; ".join(left.notes))
    return ": ".join(filter(None, words))


def _written_anew(
    target: Path, before: Mapping[str, FileState], changes: Mapping[str, FileState | None]
) -> Iterator[tuple[str, bool]]:
    """Yield what is to be said of each editable file that somebody removed.

    With it: whether git knows of hand edits that were in it.
    """
    editable = _bases_before(before)
    for path, state in sorted(changes.items()):
        was_made = path in editable or f"{FORMER}/{path}" in before
        if path in before or state is None or not was_made:
            continue
        committed = committed_text(target, path)
        if committed != state.text:
            there = f"; `git -C {target} checkout HEAD -- {path}` brings back what was committed"
            yield (
                f"{path}: it was missing and is written anew, without hand edits"
                + (there if committed is not None else ""),
                committed not in {None, committed_base(target, path)},
            )


def _bases_before(before: Mapping[str, FileState]) -> Mapping[str, str]:
    record = before.get(f"{EDDI}/{BASES}")
    return bases_of((record and record.text) or "")


def _regions_anew(
    before: Mapping[str, FileState], changes: Mapping[str, FileState | None]
) -> Iterator[str]:
    """Yield what is to be said of each region that somebody removed."""
    for path, text in _bases_before(before).items():
        states = (before.get(path), changes.get(path))
        base, (old, new) = parse(text)[0], (parse((one and one.text) or "")[0] for one in states)
        missing = base.regions.keys() - adopt_ids(old, base).regions.keys()
        for id_ in sorted(missing & new.regions.keys() if path in before else ()):
            yield f"{path}: the region {id_!r} was missing and is back, with the generated text"


def _is_record(path: str) -> bool:
    """Tell whether a file is only of use to a package: neither a person's nor a saved text."""
    return path == ANSWERS_FILE or (path.startswith(".eddi/") and not path.startswith(SAVED))


def _foreign(target: Path) -> EddiError:
    if (target / EDDI).is_dir():
        message = f"this package lacks its {ANSWERS_FILE}, which says what it was made of"
        hint = f"`git -C {target} checkout -- {ANSWERS_FILE}` brings it back; or move it away"
        return EddiError(error("H012", message, Place(str(target)), hint))
    hint = f"move it away, or choose another Model id (a generated one has {ANSWERS_FILE})"
    return EddiError(
        error("H012", "the folder exists and was not generated", Place(str(target)), hint)
    )


def _copy(files: Mapping[str, FileState], folder: Path) -> None:
    """Lay files into the scratch folder; what they may do is decided when they are written."""
    for parent in dict.fromkeys((folder / path).parent for path in files):
        parent.mkdir(parents=True, exist_ok=True)
    for path, state in files.items():
        (folder / path).write_bytes(state.data)


def _with_mode(state: FileState, before: FileState | None) -> FileState:
    """Return a file with the mode that it has, or that a new one gets; a program can be run."""
    if before is None:
        return replace(state, mode=NEW_PROGRAM if state.executable else NEW)
    may_run = (before.mode & 0o444) >> 2 if state.executable else 0
    return replace(state, mode=before.mode | may_run)


def _write(root: Path, work: _Work, within: Path | None = None) -> transaction.Applied:
    """Write in the order of ``sync``: killed in between, a plain Copier run still merges right."""
    changes = work.changes
    ordered = sorted(changes, key=lambda path: (_turn(path, changes[path]), path))
    follows: dict[str, list[str]] = {}
    meanwhile: dict[str, FileState] = {}
    for path in [path for path in ordered if path.endswith(_BASES)]:
        state, folder = changes[path], path.removesuffix(_BASES)
        made = bases_of(state.text or "") if state is not None else {}
        follows[path] = [f"{folder}/{name}" for name in made if f"{folder}/{name}" in changes]
        for name in made:
            text = changes.get(f"{folder}/{name}")
            if text is not None:
                guard = f"{folder}/{EDDI}/next/{name}"
                meanwhile[guard] = FileState(next_base(text.data, made[name].encode()))
                follows[guard] = [path]
    top, place = _places(root, work.links, within)
    return transaction.write(
        top,
        {place(path): changes[path] for path in ordered},
        {place(path): state for path, state in work.before.items()},
        {place(path): [place(file) for file in files] for path, files in follows.items()},
        {place(path): state for path, state in meanwhile.items()},
    )


def _places(
    root: Path, links: Mapping[str, Path], within: Path | None
) -> tuple[Path, Callable[[str], str]]:
    """Return the folder of a transaction, and what turns a path below ``root`` into one in it."""
    if not links:
        return root, lambda path: path
    inside = all(stays(root, real) for real in links.values())
    top = root if inside or within is None else within
    start = os.path.realpath(top)

    def place(path: str) -> str:
        real = links.get(path) or os.path.join(os.path.realpath(root), path)  # noqa: PTH118
        return os.path.relpath(real, start)

    return top, place


def _turn(path: str, state: FileState | None) -> int:
    """Return when a file is written: saved edits, the rest, what came back, the base."""
    folder = path.partition("/.eddi/")[2].partition("/")[0]
    if folder in {"orphans", "rejects"}:
        return 2 if state is None else 0
    return 3 if folder in {BASES, Path(FORMER).name} else 1


def _copy_rendering(rendered: Path, staged: Path, skipped: Collection[str] = ()) -> None:
    """Put a rendering over a package; an editable file that is there stays for the merge."""
    for folder in (PRISTINE, GENERATED):
        shutil.rmtree(staged / folder, ignore_errors=True)
        (staged / folder).mkdir(parents=True)  # maybe without any file
    for record in (UNCOMMITTED, ".eddi/generated.txt"):  # the second is of version 0.1
        (staged / record).unlink(missing_ok=True)
    editable = set(_names(rendered / PRISTINE))
    for name in _names(rendered):
        target = staged / name
        if name in skipped or (name in editable and target.exists()):
            continue
        target.parent.mkdir(parents=True, exist_ok=True)
        shutil.copy(rendered / name, target)


def _names(folder: Path) -> list[str]:
    return sorted(name for name, kind in entries(folder) if kind is None)


def _refuse(refusals: Sequence[Refusal], target: Path) -> None:
    def problem(refusal: Refusal) -> Problem:
        file = target / refusal.file
        hint = ADOPT if is_of_d72(file) else None
        return error("H010", refusal.reason, Place(str(file), refusal.line), hint)

    if refusals:
        raise EddiError(*map(problem, refusals))


def _check_python(files: Mapping[str, FileState], names: Collection[str], target: Path) -> None:
    """Refuse Python of ours that does not parse; what else a person keeps there is theirs."""
    for path in sorted(files.keys() & set(names)):
        if path.endswith(".py"):
            try:
                parse_python(files[path].data)
            except SyntaxError as problem:
                message = f"the hand-written code is not valid Python: {reason_of(problem)}"
                place = Place(str(target / path), problem.lineno)
                raise EddiError(error("H011", message, place)) from None


def _diff(path: str, before: FileState | None, after: FileState | None) -> str:
    old = before.data.decode("utf-8", "replace").splitlines(keepends=True) if before else []
    new = after.data.decode("utf-8", "replace").splitlines(keepends=True) if after else []
    lines = difflib.unified_diff(
        old, new, f"a/{path}" if before else "/dev/null", f"b/{path}" if after else "/dev/null"
    )
    return "".join(line if line.endswith("\n") else f"{line}\n" for line in lines)
