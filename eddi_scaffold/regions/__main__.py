"""Command line for Copier's tasks and migrations, ``python <this folder> sync|check``, and people.

Old templates call this for years: the two words and their meaning stay. The working directory is
the package. ``sync`` ends with 0 whatever it finds, because a failing task would make Copier drop
edits of other files; ``check`` ends with 1 when markers are damaged, so that Copier stops before
it has changed anything.
"""

from __future__ import annotations

import sys
import traceback
from collections.abc import Sequence
from functools import partial
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

from . import names

if sys.argv[1:2] == ["--folder"] and __package__ == "copier_regions":
    names.choose(*sys.argv[2:3])
    del sys.argv[1:3]

from .check import accept, broken_files, list_regions, mixed_renderings
from .driver import merge_driver
from .generated import keep_edits_of_old_layout
from .git import committed_text
from .interrupted import begin_update
from .lock import BusyError, locked
from .manifest import ANSWERS
from .sync import AGAIN, SyncReport, sync_package

_WAIT_S = 10.0
_USAGE = """\
usage: python <this folder> [--folder .NAME] sync|check|status   (in the package's folder)
       python <this folder> [--folder .NAME] accept ID|FILE ...   (in the package's folder)
       python <this folder> [--folder .NAME] merge-driver %O %A %B %P   (by git)
"""


def main(arguments: Sequence[str] | None = None, root: Path | None = None) -> int:
    """Run one command in ``root`` (default: the working directory); returns the exit status."""
    words = list(sys.argv[1:] if arguments is None else arguments)
    root = root or Path.cwd()
    if words == ["sync"]:
        try:
            with locked(root.parent, _WAIT_S):
                lines = describe(sync_package(root, partial(committed_text, root)))
        except BusyError as busy:
            lines = [f"{root}: error: {busy}: nothing was merged; when it has ended, {AGAIN}"]
        except Exception:  # noqa: BLE001 - a failing task makes Copier drop edits of other files
            lines = [traceback.format_exc(), f"{root}: error: our bug; hand edits are not lost"]
        sys.stderr.write("".join(f"{line}\n" for line in lines))
        return 0
    if words == ["check"]:
        try:
            with locked(root.parent, _WAIT_S):
                lines = _check(root)
        except BusyError as busy:
            lines = [f"{root}: error: {busy}: nothing was changed; when it has ended, update again"]
        sys.stderr.write("".join(f"{line}\n" for line in lines))
        return 1 if lines else 0
    if words == ["status"]:
        lines = _to_be_reviewed(root)
        sys.stdout.write("".join(f"{line}\n" for line in lines))
        return 3 if lines else 0
    if words[:1] == ["accept"] and len(words) > 1:
        try:
            with locked(root.parent, _WAIT_S):
                missing = {*words[1:]} - {*accept(root, words[1:])}
        except BusyError as busy:
            missing = {str(busy)}
        sys.stderr.write("".join(f"{word}: error: not accepted\n" for word in sorted(missing)))
        return 1 if missing else 0
    if len(words) == 5 and words[0] == "merge-driver":
        base, ours, theirs = (root / word for word in words[1:4])
        return merge_driver(base, ours, theirs, words[4])
    sys.stderr.write(_USAGE)
    return 0 if words in (["-h"], ["--help"]) else 2


def _check(root: Path) -> list[str]:
    """Prepare an update; return what stands in its way."""
    broken = broken_files(root)
    if not broken:
        keep_edits_of_old_layout(root)
        stop = begin_update(root, lambda: mixed_renderings(root, partial(committed_text, root)))
        return [f"{ANSWERS}:1: error: {stop}"] if stop else []
    return [f"{refusal.file}:{refusal.line}: error: {refusal.reason}" for refusal in broken]


def _to_be_reviewed(root: Path) -> list[str]:
    return [
        f"{one.file}{f':{one.line}' if one.line else ''}: {one.state}: "
        f"{': '.join(filter(None, (one.id, '; '.join(one.notes))))}"
        for one in list_regions(root)
        if one.review
    ]


def describe(report: SyncReport) -> list[str]:
    """Return the lines that report what a sync did to hand edits."""
    lines = [f"{r.file}:{r.line}: error: {r.reason}; left alone" for r in report.refused]
    for note in report.notes:
        place = note.file if note.line is None else f"{note.file}:{note.line}"
        lines.append(f"{place}: {'warning' if note.attention else 'info'}: {note.text}")
    return lines


def program() -> None:
    """Run the command line."""
    sys.exit(main())


if __name__ == "__main__":
    program()
