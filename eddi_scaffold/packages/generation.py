"""Bring packages to the state that their answers describe; every region keeps its body.

All packages of one command are rendered and planned first; only if none refuses, they are written.
"""

from __future__ import annotations

import difflib
import os
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path, PurePosixPath

from eddi_scaffold.common.problems import EddiError, Place, problem
from eddi_scaffold.packages.handwritten import write_plans
from eddi_scaffold.packages.renaming import NO_RENAMES, Renames
from eddi_scaffold.packages.rendering import ANSWERS_FILE, Renderer, Template, read_answers
from eddi_scaffold.packages.unpacking import Unpacked, scratch_folder, unpacked
from eddi_scaffold.packages.workspace import alone, lacks_answers, refuse_newer
from eddi_scaffold.platforms import PackageAnswers, owner_of
from eddi_scaffold.regions.check import list_regions
from eddi_scaffold.regions.package import (
    EDDI,
    MANIFEST,
    NEW,
    Note,
    Plan,
    bytes_at,
    manifest_of,
    manifest_text,
    read_file,
    text_of,
)
from eddi_scaffold.regions.sync import plan_sync

_STAGE = "rendering"
_IGNORED = b"# What Python leaves behind; yours to edit.\n__pycache__/\n*.pyc\n"
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
        lines: list[str] = []
        for path, after in sorted(self.changes.items()):
            if f"/{EDDI}/" in path or path.endswith(f"/{ANSWERS_FILE}"):
                continue
            texts = (
                (data or b"").decode("utf-8", "replace") for data in (self.before.get(path), after)
            )
            old, new = (text.splitlines(keepends=True) for text in texts)
            start = f"a/{path}" if path in self.before else "/dev/null"
            end = f"b/{path}" if after is not None else "/dev/null"
            lines += difflib.unified_diff(old, new, start, end)
        return "".join(line if line.endswith("\n") else f"{line}\n" for line in lines)


def write_packages(
    root: Path,
    packages: Sequence[PackageAnswers],
    template: Template,
    *,
    renames: Renames = NO_RENAMES,
    dry_run: bool = False,
    progress: Callable[[str], None] = lambda _: None,
) -> WriteResult:
    """Render the packages, and bring what is below ``root`` to the renderings.

    ``progress`` is called with the folder of each package before it is rendered.

    Raises:
        EddiError: hand edits are in the way (H010), a folder was not generated (H012), a model
            cannot be compiled (K028), the destination (F002) or the place of the templates (T001)
            cannot be written, a file was saved meanwhile (F013), another run is at work (F012),
            or a later release made a package (T006); nothing was written.
    """
    places = {package.folder: renames.place(root, package.folder) for package in packages}
    refuse_newer(places.values())
    for place in places.values():
        _refuse_foreign(place)
    if not dry_run:
        template.keep()
    plans: dict[str, Plan] = {}
    editable: set[str] = set()
    with (
        alone(() if dry_run else filter(Path.is_dir, places.values())),
        scratch_folder("eddi-scaffold-") as scratch,
        unpacked(template.bundle or Path(template.location), template.ref) as source,
    ):
        notes = [(note, False) for note in source.notes]  # and whether a person must look
        renderer = Renderer(template, source)
        for number, package in enumerate(packages):
            folder, target = package.folder, places[package.folder]
            if not renames.former and _is_current(target, package, template, source):
                regions = (region for region in list_regions(target) if region.review)
                notes += [(f"{folder}/{region.file}: {region.why}", True) for region in regions]
                continue
            if package.answers:
                progress(folder)
            rendered = Path(scratch, str(number))
            plan = plans[folder] = _planned(renderer, package, rendered, target, renames)
            if not package.answers:
                notes.append((f"{folder}: removed, nothing needs it any more", False))
            notes += [
                (f"{folder}/{note.place}: {note.text}", note.attention) for note in plan.notes
            ]
            if "facts" in package.answers:
                marked = (s.path for s in plan.steps if s.data and b"Manual edit begin" in s.data)
                files = (path for path in marked if not path.startswith((EDDI, ANSWERS_FILE)))
                editable.update(f"{folder}/{path}" for path in files)
        made = (package for package in packages if package.answers)
        owners = ((new.folder, owner_of(str(new.answers["template"]))) for new in made)
        folders = {PurePosixPath(folder).parent for folder, owner in owners if owner.workspace}
        paths = ((folder / ".gitignore").as_posix() for folder in sorted(folders))
        ignoring = {path: _IGNORED for path in paths if not os.path.lexists(root / path)}
        steps = [(folder, plan, step) for folder, plan in plans.items() for step in plan.steps]
        old = {f"{folder}/{s.path}": bytes_at(plan.root, s.path) for folder, plan, s in steps}
        refused = [
            problem("H010", Place(str(plan.root / refusal.file), refusal.line), reason=refusal.text)
            for plan in plans.values()
            for refusal in plan.refusals
        ]
        if refused:
            hint = "Nothing was changed; mend this, and run the command again"
            raise EddiError(*refused[:-1], replace(refused[-1], hint=hint))
        if not dry_run:
            _write(plans, renames, root)
            for path, data in ignoring.items():
                (root / path).write_bytes(data)
            notes += [
                (f"{old} is called {new} now; all in it moved along", False)
                for new, old in renames.former.items()
                if new in plans
            ]
    changes = {f"{folder}/{step.path}": step.data for folder, _, step in steps} | ignoring
    before = {path: data for path, data in old.items() if data is not None}
    lines = list(dict.fromkeys(note for note, _ in notes))
    look = any(attention for _, attention in notes)
    return WriteResult(root, changes, before, lines, look, (), frozenset(editable))


def _planned(
    renderer: Renderer, package: PackageAnswers, rendered: Path, target: Path, renames: Renames
) -> Plan:
    """Render a package, with what Copier does not render, and plan to bring it there."""
    rendering = rendered / NEW / _STAGE
    records: dict[str, bytes | None] = {ANSWERS_FILE: None}
    if package.answers:
        renderer.render({**package.answers, "stage": _STAGE}, rendered)
        for name, data in package.files.items():
            (rendering / name).parent.mkdir(parents=True, exist_ok=True)
            (rendering / name).write_bytes(data)
        changed = _CHANGED if renderer.source.notes else b""
        answers = (rendered / ANSWERS_FILE).read_bytes() + changed
        records = {ANSWERS_FILE: answers}
    else:
        rendering.mkdir(parents=True)
    includes = "launcher.include_{}".format  # regions of the launcher about renamed packages
    regions = {includes(new): includes(old) for new, old in renames.former.items()}
    more = (package.saved, package.adopted, regions)
    plan = plan_sync(target, rendering, records, *more)
    lost = "its generated text is nowhere any more: name the model with -m"
    refusals = [*plan.refusals, *(Note(name, None, lost) for name in package.lacks)]
    return plan._replace(refusals=refusals)


def _write(plans: Mapping[str, Plan], renames: Renames, root: Path) -> None:
    renames.move(root)
    try:
        write_plans([plan._replace(root=root / folder) for folder, plan in plans.items()])
    except EddiError:
        renames.move(root, back=True)
        raise
    renames.move_inside(root)


def _refuse_foreign(target: Path) -> None:
    """Refuse a folder that is a link, or that is no package of ours (EddiError, H012)."""
    if target.is_symlink():
        raise EddiError(problem("H012.link", Place(str(target)), target=target.name))
    inside = {path.name for path in target.iterdir()} if target.is_dir() else set()
    is_empty = not (inside - {EDDI, ANSWERS_FILE} or (target / MANIFEST).exists())
    if is_empty or read_answers(target) is not None:
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
    answers, today = read_answers(target) or {}, {**package.answers, **origin}
    if any(answers.get(key, None if value else value) != value for key, value in today.items()):
        return False
    if package.files.keys() - manifest.files.keys():
        return False
    for name, known in manifest.files.items():
        file = read_file(target, name)
        if file is None or file.faults or len(file.sides) > 1 or not known.issuperset(file.digests):
            return False
        no_program = file.data.startswith(b"#!") and not file.mode & 0o100
        if no_program or package.files.get(name, file.data) != file.data:
            return False
    made = {name: next(iter(known)) for name, known in manifest.files.items()}
    data = (target / ANSWERS_FILE).read_bytes()
    text = manifest_text(made, text_of(data))
    return not data.endswith(_CHANGED) and (target / MANIFEST).read_bytes() == text.encode()
