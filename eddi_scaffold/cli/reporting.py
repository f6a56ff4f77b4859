"""Where packages go, and reports of the commands that change them."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from pathlib import Path

import typer

from eddi_scaffold.cli import exit_status
from eddi_scaffold.cli.console import console
from eddi_scaffold.common.problems import EddiError, Place, plural, problem
from eddi_scaffold.packages.generation import WriteResult
from eddi_scaffold.packages.rendering import ANSWERS_FILE
from eddi_scaffold.platforms import Platform, platforms

_SHOWN = 12
_RECORDS = "/.eddi/"
_SIGNS = {"new": "+", "changed": "~", "removed": "-"}


def destination(platform: Platform, workspace: Path | None, output: Path | None) -> Path:
    """Return the one of ``-w`` and ``-o`` that the platform takes.

    Raises:
        EddiError: it is missing or a package (G006), or the other one is given as well (G000).
    """
    in_workspace = platform.workspace is not None
    place, other, option = workspace, output, "-w WORKSPACE"
    if not in_workspace:
        place, other, option = output, workspace, "-o FOLDER"
    if place is None:
        hint = None
        if other is not None:
            names = [p.name for p in platforms().values() if (p.workspace is None) == in_workspace]
            hint = f"{'-o' if in_workspace else '-w'} is for --platform {' or '.join(names)}"
        raise EddiError(problem("G006.platform", hint=hint, platform=platform.name, option=option))
    if other is not None:
        raise EddiError(problem("G000.alone", platform=platform.name, option=option))
    if (place / ANSWERS_FILE).is_file():
        parent = place.absolute().parent
        raise EddiError(problem("G006.inside_package", Place(str(place)), parent=parent))
    return place


def finish(*outcomes: WriteResult, dry_run: bool, next_steps: Sequence[str] = ()) -> None:
    """Print what changed and end the command with 0, or with 3 when a person must look.

    Raises:
        typer.Exit: hand edits need a look (3).
    """
    for outcome in outcomes:
        _report(outcome, dry_run=dry_run)
    if any(outcome.attention or outcome.left for outcome in outcomes):
        raise typer.Exit(exit_status.LOOK)
    if not dry_run and next_steps:
        console.say("next:")
        for step in next_steps:
            console.say(f"  {step}")


def _report(outcome: WriteResult, *, dry_run: bool) -> None:
    records = {path for path in outcome.changes if _RECORDS in path}
    # Records of hand edits are not counted, which people do not read.
    number = len(outcome.changes) - len(records)
    size = plural(number, "file") if number or not outcome.changes else "records of hand edits"
    if dry_run:
        diff = outcome.diff()
        if diff:
            console.data(diff.rstrip("\n"))
        console.say(f"{size} would change below {outcome.root}")
    elif not outcome.changes:
        console.success(f"nothing to change below {outcome.root}")
    else:
        console.success(f"{outcome.root}: {size}")
        _list_changes(outcome, records)
    for note in outcome.notes:
        console.say(f"note: {note}")
    for line in outcome.left:
        console.say(f"left alone: {line}")
    if outcome.attention:
        console.say("hand edits need a look: see the notes, and `eddi-scaffold regions --check`")


def _list_changes(outcome: WriteResult, records: set[str]) -> None:
    """Print each file that may be edited, and a count of the others."""
    changes = {
        path: "removed" if content is None else "changed" if path in outcome.before else "new"
        for path, content in outcome.changes.items()
    }
    editable = sorted(outcome.editable, key=lambda path: (not path.endswith(".py"), path))
    if editable:
        console.say("  yours to edit:")
        for path in editable[:_SHOWN]:
            console.say(f"    {_SIGNS[changes[path]]} {path}")
        if len(editable) > _SHOWN:
            console.say(f"    ... and {len(editable) - _SHOWN} more")
    others = sorted(changes.keys() - records - outcome.editable)
    if others:
        counts = Counter(changes[path] for path in others)
        what = ", ".join(f"{counts[change]} {change}" for change in _SIGNS if counts[change])
        folders = list(dict.fromkeys(path.partition("/")[0] for path in others))
        more = f" and {len(folders) - _SHOWN} more" if len(folders) > _SHOWN else ""
        console.say(f"  generated: {what}, in {', '.join(folders[:_SHOWN])}{more}")
