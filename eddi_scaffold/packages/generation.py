"""Bring packages to the state that their answers describe; every region keeps its body.

All packages of one command are rendered and planned first; only if none refuses, they are written.
"""

from __future__ import annotations

import difflib
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path

from eddi_scaffold.common.problems import EddiError, Place, problem
from eddi_scaffold.packages.handwritten import ADOPT, is_of_d72, lost_sources, write_plans
from eddi_scaffold.packages.renaming import NO_RENAMES, Renames
from eddi_scaffold.packages.rendering import ANSWERS_FILE, Renderer, Template, read_answers
from eddi_scaffold.packages.unpacking import Unpacked, scratch_folder, unpacked
from eddi_scaffold.packages.workspace import alone, lacks_answers, refuse_newer
from eddi_scaffold.platforms import PackageAnswers
from eddi_scaffold.regions.check import list_regions
from eddi_scaffold.regions.package import (
    EDDI,
    MANIFEST,
    NEW,
    bytes_at,
    manifest_of,
    manifest_text,
    obstacle,
    read_file,
    text_of,
)
from eddi_scaffold.regions.sync import Plan, plan_sync

_IGNORED = f"{EDDI}/.gitignore"
_STAGE = "rendering"
_CHANGED = b"# The templates had changes that were not committed.\n"


@dataclass(frozen=True)
class WriteResult:
    """What a command did, or would do.

    Attributes:
        root: folder that all paths are relative to.
        changes: path -> new bytes, ``None`` for a removed file.
        before: path -> bytes before, for the changed ones that existed.
        notes: one line each: what happened to hand edits, warnings of Copier.
        attention: a person must look at hand edits.
        left: one line each: what should have changed, but a person must decide.
        editable: paths of generated files of monitors that have regions.
    """

    root: Path
    changes: Mapping[str, bytes | None]
    before: Mapping[str, bytes]
    notes: Sequence[str]
    attention: bool
    left: Sequence[str] = ()
    editable: frozenset[str] = frozenset()

    def diff(self) -> str:
        """Return the change as a unified diff, paths relative to ``root``, without our records."""
        return "".join(
            _diff(path, self.before.get(path), data)
            for path, data in sorted(self.changes.items())
            if f"/{EDDI}/" not in path and not path.endswith(f"/{ANSWERS_FILE}")
        )


@dataclass
class _Work:
    """What the packages of one command add up to."""

    plans: dict[str, Plan] = field(default_factory=dict)
    changes: dict[str, bytes | None] = field(default_factory=dict)
    before: dict[str, bytes] = field(default_factory=dict)
    notes: list[str] = field(default_factory=list)
    editable: set[str] = field(default_factory=set)
    attention: bool = False


def write_packages(
    root: Path,
    packages: Sequence[PackageAnswers],
    template: Template,
    *,
    renames: Renames = NO_RENAMES,
    force: bool = False,
    dry_run: bool = False,
    progress: Callable[[str], None] = lambda _: None,
) -> WriteResult:
    """Render the packages, and bring what is below ``root`` to the renderings.

    Args:
        root: folder that the packages' folders are relative to.
        packages: what to render.
        template: where from.
        renames: packages among them that were there under another name.
        force: also packages that a later release made.
        dry_run: change nothing.
        progress: called with the folder of each package before it is rendered.

    Raises:
        EddiError: hand edits are in the way (H010), a folder was not generated (H012), a model
            cannot be compiled (K028), the destination (F002) or the place of the templates (T001)
            cannot be written, a file was saved meanwhile (F013), another run is at work (F012),
            or a later release made a package (T006); nothing was written.
    """
    places = {one.folder: renames.place(root, one.folder) for one in packages}
    if not force:
        refuse_newer(places.values())
    for place in places.values():
        _refuse_foreign(place)
    if not dry_run:
        template.keep()
    work = _Work()
    with (
        alone(() if dry_run else filter(Path.is_dir, places.values())),
        scratch_folder("eddi-scaffold-") as scratch,
        unpacked(template.bundle or Path(template.location), template.ref) as source,
    ):
        work.notes += source.notes
        renderer = Renderer(template, source)
        for number, package in enumerate(packages):
            target = places[package.folder]
            if not renames.former and _is_current(target, package, template, source):
                _tell_open(package, target, work)
                continue
            if package.answers:
                progress(package.folder)
            rendered = Path(scratch, str(number))
            changed = bool(source.notes)
            plan, warnings = _planned(renderer, package, rendered, target, renames, changed=changed)
            work.plans[package.folder] = plan
            work.notes += warnings
            _tell(package, plan, target, work)
            for step in plan.steps:
                path, old = f"{package.folder}/{step.path}", bytes_at(target, step.path)
                work.changes[path] = step.data
                work.before |= {path: old} if old is not None else {}
        _refuse(work.plans.values())
        if not dry_run:
            _write(work.plans, renames, root)
    written = {} if dry_run else work.plans
    mentions = renames.mentions(root, written)
    work.attention = work.attention or bool(mentions)
    notes = [*dict.fromkeys(work.notes), *renames.notes(written), *mentions]
    editable = frozenset(work.editable)
    return WriteResult(root, work.changes, work.before, notes, work.attention, (), editable)


def _planned(
    renderer: Renderer,
    package: PackageAnswers,
    rendered: Path,
    target: Path,
    renames: Renames,
    *,
    changed: bool,
) -> tuple[Plan, list[str]]:
    """Render a package, with what Copier does not render, and plan to bring it there.

    Returns:
        The plan, and what is to be said of the rendering.
    """
    rendering = rendered / NEW / _STAGE
    beside: dict[str, bytes | None] = dict.fromkeys([ANSWERS_FILE, _IGNORED])
    if package.answers:
        warnings = renderer.render({**package.answers, "stage": _STAGE}, rendered)
        for name, data in package.files.items():
            place = rendering / name
            place.parent.mkdir(parents=True, exist_ok=True)
            place.write_bytes(data)
        beside = {name: (rendered / name).read_bytes() for name in beside}
        beside[ANSWERS_FILE] = (beside[ANSWERS_FILE] or b"") + (_CHANGED if changed else b"")
    else:
        warnings = [f"{package.folder}: removed, nothing needs it any more"]
        rendering.mkdir(parents=True)
    more = (package.saved, package.adopted, renames.regions)
    return plan_sync(target, rendering, beside, *more), warnings


def _tell(package: PackageAnswers, plan: Plan, target: Path, work: _Work) -> None:
    """Note what happens to a person's text in a package."""
    was = read_answers(target) or {}
    lost = lost_sources(target, was, package.answers)
    work.notes += [f"{package.folder}: {one}" for one in lost]
    for note in plan.notes:
        work.notes.append(f"{package.folder}/{note.place}: {note.text}")
    work.attention |= bool(lost) or any(note.attention for note in plan.notes)
    if "facts_json" in package.answers:
        marked = (s.path for s in plan.steps if s.data and b"Manual edit begin" in s.data)
        names = (name for name in marked if not name.startswith((EDDI, ANSWERS_FILE)))
        work.editable |= {f"{package.folder}/{name}" for name in names}


def _tell_open(package: PackageAnswers, target: Path, work: _Work) -> None:
    for region in list_regions(target):
        if region.review:
            words = (f"{package.folder}/{region.file}", region.id, "; ".join(region.notes))
            work.notes.append(": ".join(filter(None, words)))
            work.attention = True


def _refuse(plans: Iterable[Plan]) -> None:
    problems = []
    for plan in plans:
        for refusal in plan.refusals:
            file = plan.root / refusal.file
            hint = ADOPT if is_of_d72(file) else None
            place = Place(str(file), refusal.line)
            problems.append(problem("H010", place, hint=hint, reason=refusal.text))
    if problems:
        last = problems[-1]
        hint = last.hint or "Nothing was changed; mend this, and run the command again"
        raise EddiError(*problems[:-1], replace(last, hint=hint))


def _write(planned: Mapping[str, Plan], renames: Renames, root: Path) -> None:
    renames.move(root)
    try:
        write_plans([replace(plan, root=root / folder) for folder, plan in planned.items()])
    except EddiError:
        renames.move(root, back=True)
        raise
    renames.move_inside(root)


def _refuse_foreign(target: Path) -> None:
    """Refuse a folder that is a link, or that is no package of ours.

    Raises:
        EddiError: that is so (H012).
    """
    if target.is_symlink():
        raise EddiError(problem("H012.link", Place(str(target)), target=target.name))
    mine = {EDDI, ANSWERS_FILE}
    if not target.is_dir() or (
        not (target / MANIFEST).exists() and not ({path.name for path in target.iterdir()} - mine)
    ):
        return
    if read_answers(target) is not None:
        return
    if (target / EDDI).is_dir():
        raise lacks_answers(target)
    raise EddiError(problem("H012.foreign", Place(str(target)), answers=ANSWERS_FILE))


def _is_current(
    target: Path, package: PackageAnswers, template: Template, source: Unpacked
) -> bool:
    """Return whether a rendering would change nothing, by what the package itself records."""
    manifest = manifest_of(target)
    unsure = source.changed or package.saved or manifest.mixed or (target / NEW).exists()
    if unsure or not (package.answers and manifest.exists):
        return False
    origin = {"_commit": source.commit, "_src_path": template.location}
    answers = read_answers(target) or {}
    wanted = {**package.answers, **origin}
    nothing = object()
    if any(answers.get(key, nothing) != value for key, value in wanted.items()):
        return False
    for name, known in manifest.files.items():
        file = read_file(target, name) if obstacle(target, name) is None else None
        whole = file is not None and len(file.sides) == 1 and not file.faults
        if file is None or not whole or not known.issuperset(file.digests):
            return False
        if package.files.get(name, file.data) != file.data:
            return False
        if file.data.startswith(b"#!") and not file.mode & 0o100:
            return False
    made = {name: next(iter(known)) for name, known in manifest.files.items()}
    data = (target / ANSWERS_FILE).read_bytes()
    text = manifest_text(made, text_of(data))
    return not data.endswith(_CHANGED) and (target / MANIFEST).read_bytes() == text.encode()


def _diff(path: str, before: bytes | None, after: bytes | None) -> str:
    old, new = (
        (data or b"").decode("utf-8", "replace").splitlines(keepends=True)
        for data in (before, after)
    )
    start, end = f"a/{path}" if before else "/dev/null", f"b/{path}" if after else "/dev/null"
    lines = difflib.unified_diff(old, new, start, end)
    return "".join(line if line.endswith("\n") else f"{line}\n" for line in lines)
