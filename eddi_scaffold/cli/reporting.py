"""Reports of the commands that change packages."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence

import typer

from eddi_scaffold.cli import exit_status
from eddi_scaffold.cli.console import console
from eddi_scaffold.common.problems import plural
from eddi_scaffold.packages.generation import WriteResult

_SHOWN = 12
_RECORDS = "/.eddi/"
_SIGNS = {"new": "+", "changed": "~", "removed": "-"}


def finish(outcome: WriteResult, *, dry_run: bool, next_steps: Sequence[str] = ()) -> None:
    """Print what changed and end the command with 0, or with 3 when a person must look.

    Raises:
        typer.Exit: hand edits need a look (3).
    """
    finish_all([outcome], dry_run=dry_run, next_steps=next_steps)


def finish_all(
    outcomes: Sequence[WriteResult], *, dry_run: bool, next_steps: Sequence[str] = ()
) -> None:
    """Do the same for what was done in several folders.

    Raises:
        typer.Exit: hand edits need a look in one of them (3).
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
    if dry_run:
        diff = outcome.diff()
        if diff:
            console.data(diff.rstrip("\n"))
        console.say(f"{_size(outcome)} would change below {outcome.root}")
    else:
        _list_changes(outcome)
    for note in outcome.notes:
        console.say(f"note: {note}")
    for line in outcome.left:
        console.say(f"left alone: {line}")
    if outcome.attention:
        console.say("hand edits need a look: see the notes, and `eddi-scaffold regions --check`")


def _records(outcome: WriteResult) -> set[str]:
    return {path for path in outcome.changes if _RECORDS in path}


def _size(outcome: WriteResult) -> str:
    """Return how many files change, without records of hand edits, which people do not read."""
    number = len(outcome.changes) - len(_records(outcome))
    return plural(number, "file") if number or not outcome.changes else "records of hand edits"


def _list_changes(outcome: WriteResult) -> None:
    """Print what changed: each file that may be edited, and a count of the others."""
    if not outcome.changes:
        console.success(f"nothing to change below {outcome.root}")
        return
    console.success(f"{outcome.root}: {_size(outcome)}")
    yours = outcome.editable
    if yours:
        console.say("  yours to edit:")
        for path in sorted(yours, key=lambda path: (not path.endswith(".py"), path))[:_SHOWN]:
            console.say(f"    {_SIGNS[_change(outcome, path)]} {path}")
        if len(yours) > _SHOWN:
            console.say(f"    ... and {len(yours) - _SHOWN} more")
    others = sorted(outcome.changes.keys() - _records(outcome) - yours)
    if others:
        counts = Counter(_change(outcome, path) for path in others)
        what = ", ".join(f"{counts[change]} {change}" for change in _SIGNS if counts[change])
        folders = list(dict.fromkeys(path.partition("/")[0] for path in others))
        more = f" and {len(folders) - _SHOWN} more" if len(folders) > _SHOWN else ""
        console.say(f"  generated: {what}, in {', '.join(folders[:_SHOWN])}{more}")


def _change(outcome: WriteResult, path: str) -> str:
    if outcome.changes[path] is None:
        return "removed"
    return "changed" if path in outcome.before else "new"
