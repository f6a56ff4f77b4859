"""Bring packages to the state that their answers describe, keeping every hand edit.

All packages of one command are rendered and merged in a scratch folder; the destination changes at
the end, in one step, or not at all.
"""

from __future__ import annotations

import ast
import difflib
import shutil
import tempfile
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from eddi_scaffold import transaction
from eddi_scaffold.platforms import PackageAnswers
from eddi_scaffold.problems import EddiError, Place, error
from eddi_scaffold.project import ANSWERS_FILE, Template, read_answers, render
from eddi_scaffold.regions.check import broken_files
from eddi_scaffold.regions.generated import (
    changed_generated,
    forget_generated,
    recorded_generated,
    save_generated_edits,
)
from eddi_scaffold.regions.store import save_orphan
from eddi_scaffold.regions.sync import Refusal, next_base, sync_package
from eddi_scaffold.transaction import FileState
from eddi_scaffold.unpacking import unpacked

PRIVATE_ANSWERS = ("_commit", "_src_path")
"""What Copier itself writes into an answers file."""


@dataclass(frozen=True)
class Outcome:
    """What a command did, or would do.

    Attributes:
        root: folder that all paths are relative to.
        changes: path -> new state, ``None`` for a removed file.
        before: path -> state before, for the changed ones that existed.
        notes: one line each: what happened to hand edits, warnings of Copier.
        attention: a person must look at hand edits.
    """

    root: Path
    changes: Mapping[str, FileState | None]
    before: Mapping[str, FileState]
    notes: Sequence[str]
    attention: bool

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
    attention: bool = False


def existing(root: Path) -> dict[str, dict[str, Any]]:
    """Return folder name -> answers of the generated packages directly below ``root``."""
    folders = sorted(path for path in root.iterdir() if path.is_dir()) if root.is_dir() else []
    found = ((folder.name, read_answers(folder)) for folder in folders)
    return {name: answers for name, answers in found if answers is not None}


def bring(
    root: Path,
    packages: Sequence[PackageAnswers],
    template: Template,
    *,
    dry_run: bool = False,
    progress: Callable[[str], None] = lambda _: None,
) -> Outcome:
    """Render the packages, merge them with what is below ``root``, and write the result.

    Args:
        root: folder that the packages' folders are relative to.
        packages: what to render.
        template: where from.
        dry_run: change nothing.
        progress: told the folder of each package before it is rendered.

    Raises:
        EddiError: a hand-edited file has damaged markers (H010), a result does not compile (H011),
            or the destination cannot be written (F002); nothing was written.
    """
    if not dry_run:
        transaction.recover(root)
    work = _Work()
    with (
        tempfile.TemporaryDirectory(prefix="eddi-scaffold-") as scratch,
        unpacked(template.location, template.ref) as source,
    ):
        work.notes += source.notes
        for number, package in enumerate(packages):
            progress(package.folder)
            rendered = Path(scratch, str(number), "rendered")
            notes = render(package.answers, template, source, rendered)
            _bring_one(root, package, rendered, notes, work)
    if not dry_run:
        _write(root, work.changes)
    return Outcome(root, work.changes, work.before, work.notes, work.attention)


def _bring_one(
    root: Path, package: PackageAnswers, rendered: Path, notes: list[str], work: _Work
) -> None:
    target = root / package.folder
    before = transaction.tree_of(target)
    staged = rendered.with_name("staged")
    if before:
        if read_answers(target) is None:
            hint = f"move it away, or choose another Model id (a generated one has {ANSWERS_FILE})"
            raise EddiError(
                error("H012", "the folder exists and was not generated", Place(str(target)), hint)
            )
        _refuse(broken_files(target), target)
        # outside edits are merged per definition, which text that is not Python does not have
        _check_python({p: s for p, s in before.items() if f".eddi/pristine/{p}" in before}, target)
        shutil.copytree(target, staged, ignore=shutil.ignore_patterns(".git", "__pycache__"))
        saved = _keep_generated_edits(staged, rendered)
        notes += saved
        work.attention = work.attention or bool(saved)
    _lay(rendered, staged)
    for body in package.saved:
        save_orphan(staged, body)
    report = sync_package(staged)
    _refuse(report.refused, target)
    for name, data in package.files.items():
        (staged / name).parent.mkdir(parents=True, exist_ok=True)
        (staged / name).write_bytes(data)
    after = transaction.tree_of(staged)
    _check_python(after, target)
    changed = {
        path: after.get(path) for path in {*before, *after} if before.get(path) != after.get(path)
    }
    work.changes.update({f"{package.folder}/{path}": state for path, state in changed.items()})
    work.before.update(
        {f"{package.folder}/{path}": before[path] for path in changed if path in before}
    )
    work.notes += [note for note in notes if note not in work.notes]
    work.notes += [f"{package.folder}/{note.file}: {note.text}" for note in report.notes]
    work.attention = work.attention or report.needs_attention


def _write(root: Path, changes: Mapping[str, FileState | None]) -> None:
    """Write in the order of ``sync``: killed in between, a plain Copier run still merges right."""
    ordered = sorted(changes, key=lambda path: (_turn(path, changes[path]), path))
    follows = {
        path: path.replace("/.eddi/base/", "/", 1) for path in ordered if "/.eddi/base/" in path
    }
    meanwhile = {
        base.replace("/.eddi/base/", "/.eddi/next/", 1): FileState(next_base(text.data, new.data))
        for base, file in follows.items()
        if (text := changes.get(file)) is not None and (new := changes[base]) is not None
    }
    transaction.write(root, {path: changes[path] for path in ordered}, follows, meanwhile)


def _turn(path: str, state: FileState | None) -> int:
    """Return when a file is written: saved edits, the rest, what came back, the base."""
    folder = path.partition("/.eddi/")[2].partition("/")[0]
    if folder in {"orphans", "rejects"}:
        return 2 if state is None else 0
    return 3 if folder == "base" else 1


def _keep_generated_edits(staged: Path, rendered: Path) -> list[str]:
    """Save edited generated-only files before they are replaced, and drop those that vanished."""
    edited = changed_generated(staged)
    saved = save_generated_edits(staged, edited)
    notes = [
        f"{name} says do not edit, but was edited: your text is kept in {copy.relative_to(staged)}"
        for name, copy in zip(edited, saved, strict=True)
    ]
    for name in recorded_generated(staged):
        if not (rendered / name).exists():
            (staged / name).unlink(missing_ok=True)
    forget_generated(staged)
    return notes


def _lay(rendered: Path, staged: Path) -> None:
    """Put a rendering over a package; an editable file that is there stays for the merge."""
    shutil.rmtree(staged / ".eddi" / "pristine", ignore_errors=True)
    editable = {
        path.relative_to(rendered / ".eddi" / "pristine")
        for path in _files(rendered / ".eddi" / "pristine")
    }
    for path in _files(rendered):
        relative = path.relative_to(rendered)
        target = staged / relative
        if relative in editable and target.exists():
            continue
        target.parent.mkdir(parents=True, exist_ok=True)
        shutil.copy(path, target)


def _files(folder: Path) -> Iterable[Path]:
    return sorted(path for path in folder.rglob("*") if path.is_file())


def _refuse(refusals: Sequence[Refusal], target: Path) -> None:
    if refusals:
        raise EddiError(
            *(
                error("H010", refusal.reason, Place(str(target / refusal.file), refusal.line))
                for refusal in refusals
            )
        )


def _check_python(after: Mapping[str, FileState], target: Path) -> None:
    for path, state in after.items():
        if path.endswith(".py") and not path.startswith(".eddi/"):
            try:
                ast.parse(state.data)
            except (SyntaxError, ValueError) as problem:
                line = getattr(problem, "lineno", None)
                message = (
                    f"the hand-written code is not valid Python: {getattr(problem, 'msg', problem)}"
                )
                raise EddiError(error("H011", message, Place(str(target / path), line))) from None


def _diff(path: str, before: FileState | None, after: FileState | None) -> str:
    old = before.data.decode("utf-8", "replace").splitlines(keepends=True) if before else []
    new = after.data.decode("utf-8", "replace").splitlines(keepends=True) if after else []
    lines = difflib.unified_diff(
        old, new, f"a/{path}" if before else "/dev/null", f"b/{path}" if after else "/dev/null"
    )
    return "".join(line if line.endswith("\n") else f"{line}\n" for line in lines)
