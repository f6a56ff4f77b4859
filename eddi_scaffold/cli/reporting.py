"""Reports of the commands that change packages."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Sequence

import typer

from eddi_scaffold.cli import exit_status
from eddi_scaffold.cli.console import console
from eddi_scaffold.packages.generation import Outcome

_SHOWN = 12


def finish(outcome: Outcome, *, dry_run: bool, next_steps: Sequence[str] = ()) -> None:
    """Print what changed and end the command with 0, or with 3 when a person must look.

    Raises:
        typer.Exit: hand edits need a look (3).
    """
    if dry_run:
        diff = outcome.diff()
        if diff:
            console.data(diff.rstrip("\n"))
        console.say(f"{_files(outcome)} would change below {outcome.root}")
    else:
        _list_changes(outcome)
    for note in outcome.notes:
        console.say(f"note: {note}")
    for line in outcome.left:
        console.say(f"left alone: {line}")
    if outcome.attention:
        console.say("hand edits need a look: `eddi-scaffold regions --check` lists them")
    if outcome.attention or outcome.left:
        raise typer.Exit(exit_status.LOOK)
    if not dry_run and next_steps:
        console.say("next:")
        for step in next_steps:
            console.say(f"  {step}")


def _files(outcome: Outcome) -> str:
    return "1 file" if len(outcome.changes) == 1 else f"{len(outcome.changes)} files"


def _list_changes(outcome: Outcome) -> None:
    if not outcome.changes:
        console.success(f"nothing to change below {outcome.root}")
        return
    folders: dict[str, list[str]] = defaultdict(list)
    for path in sorted(outcome.changes):
        if "/.eddi/" not in path:
            folder, _, rest = path.partition("/")
            folders[folder].append(f"{_sign(outcome, path)} {rest}")
    console.success(f"{outcome.root}: {_files(outcome)}")
    for folder, lines in folders.items():
        console.say(f"  {folder}/")
        for line in lines[:_SHOWN]:
            console.say(f"    {line}")
        if len(lines) > _SHOWN:
            console.say(f"    ... and {len(lines) - _SHOWN} more")


def _sign(outcome: Outcome, path: str) -> str:
    if outcome.changes[path] is None:
        return "-"
    return "~" if path in outcome.before else "+"
