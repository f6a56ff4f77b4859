"""Command line for Copier's tasks and migrations, and people: ``python <this folder> WORD ...``."""

from __future__ import annotations

import json
import sys
from collections.abc import Iterator, Sequence
from importlib.util import module_from_spec, spec_from_file_location
from pathlib import Path

if not __package__:  # run as a folder, of any name: become a package, leave no trace
    sys.dont_write_bytecode = True
    _here = Path(__file__).resolve().parent
    sys.path.pop(0)  # this folder: its modules are none of everybody's
    _spec = spec_from_file_location("copier_regions", _here / "__init__.py")
    assert _spec is not None
    __package__ = _spec.name
    sys.modules[__package__] = module_from_spec(_spec)

from .check import list_regions, plan_accept
from .package import (
    NEW,
    BusyError,
    SavedError,
    is_relative,
    locked,
    manifest_of,
    obstacle,
    read_file,
)
from .sync import Note, Plan, plan_sync
from .tables import place_tables

_USAGE = """\
usage: python <this folder> sync PACKAGE STAGE [TABLES [FOLDER]]
                                                 place the rendering in PACKAGE/.eddi/new/STAGE;
                                                 TABLES: {path: SHA-256} of files in FOLDER
       python <this folder> damage PACKAGE       tell whether markers are damaged
       python <this folder> status PACKAGE       list what is open; status 3 when something is
       python <this folder> accept PACKAGE ID... note that bodies were looked at
"""


def main(arguments: Sequence[str] | None = None) -> int:
    """Run one command; returns the exit status."""
    words = list(sys.argv[1:] if arguments is None else arguments)
    if words[:1] in (["-h"], ["--help"]):
        sys.stdout.write(_USAGE)
        return 0
    if len(words) < 2 or words[0] not in {"sync", "damage", "status", "accept"}:
        sys.stderr.write(_USAGE)
        return 2
    root = Path(words[1]).resolve()
    if words[0] == "status":
        lines = list(_open(root))
        sys.stdout.write("".join(f"{line}\n" for line in lines))
        return 3 if lines else 0
    if words[0] == "damage":
        lines = list(_damage(root))
        sys.stderr.write("".join(f"{line}\n" for line in lines))
        return 1 if lines else 0
    try:
        with locked(root):
            if words[0] == "accept":
                plan, found = plan_accept(root, words[2:])
                missing = sorted({*words[2:]} - {*found})
                sys.stderr.write("".join(f"{word}: error: nothing to accept\n" for word in missing))
                return run(plan) or (1 if missing else 0)
            stage = words[2] if words[2:] else ""
            rendering = root / NEW / stage
            if not is_relative(stage) or not rendering.is_dir():
                sys.stderr.write(f"{rendering}: error: there is no rendering\n")
                return 2
            folder = Path(words[4]) if any(words[4:]) else None
            tables = json.loads(words[3]) if words[3:] else {}
            missing = list(place_tables(root, rendering, tables, folder))
            if missing:
                hint = "give its folder, as with `-d tables_folder=FOLDER`"
                sys.stderr.write(f"error: {', '.join(missing)} is not there: {hint}\n")
            return run(plan_sync(root, rendering))
    except BusyError as busy:
        sys.stderr.write(f"error: {busy}: run the command again when that one has ended\n")
        return 1


def run(plan: Plan) -> int:
    """Do what was planned, and say it; returns 1 where nothing could be done."""
    failed = described(plan.refusals, "error")
    if not failed:
        try:
            plan.prepare()
            plan.finish()
        except SavedError as saved:
            failed = [f"{saved}: error: it was saved while this command was running"]
        except OSError as refused:
            failed = [f"{refused.filename or plan.root}: error: {refused.strerror}"]
    lines = failed or described(plan.notes, "warning")
    sys.stderr.write("".join(f"{line}\n" for line in lines))
    if failed:
        sys.stderr.write("Nothing was changed: no file of yours. Mend that, and run this again.\n")
    return 1 if failed else 0


def described(notes: Sequence[Note], word: str) -> list[str]:
    """Return a line for each note, with a word for those that a person must look at."""
    return [f"{note.place}: {word if note.attention else 'note'}: {note.text}" for note in notes]


def _open(root: Path) -> Iterator[str]:
    for region in list_regions(root):
        if region.review:
            words = ": ".join(filter(None, (region.state, region.id, "; ".join(region.notes))))
            yield f"{Note(region.file, region.line, '').place}: {words}"


def _damage(root: Path) -> Iterator[str]:
    for name in sorted(manifest_of(root).files):
        stop, file = obstacle(root, name), read_file(root, name)
        if stop is not None:
            yield f"{name}: error: {stop}"
        for fault in file.faults if file is not None else ():
            yield f"{name}:{fault.line}: error: {fault.reason}"


def program() -> None:
    """Run the command line."""
    sys.exit(main())


if __name__ == "__main__":
    program()
