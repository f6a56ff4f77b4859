"""Command line for Copier's tasks and migrations, and people: ``python <this folder> WORD ...``."""

from __future__ import annotations

import sys
from collections.abc import Iterable, Iterator, Mapping, Sequence
from importlib.util import module_from_spec, spec_from_file_location
from pathlib import Path
from typing import TextIO

if not __package__:  # run as a folder, of any name: become a package, leave no trace
    sys.dont_write_bytecode = True
    _here = Path(__file__).resolve().parent
    sys.path.pop(0)  # this folder: its modules are none of everybody's
    _spec = spec_from_file_location("copier_regions", _here / "__init__.py")
    assert _spec is not None
    __package__ = _spec.name
    sys.modules[__package__] = module_from_spec(_spec)

from . import package
from .check import list_regions, plan_accept
from .package import NEW, BusyError, Plan
from .sync import plan_sync

_USAGE = """\
usage: python <this folder> sync PACKAGE STAGE [FILES [FOLDER]]
                                                 place the rendering in PACKAGE/.eddi/new/STAGE;
                                                 FILES: {path: SHA-256} of those in FOLDER
       python <this folder> damage PACKAGE       tell whether markers are damaged
       python <this folder> status PACKAGE       list what is open; status 3 when something is
       python <this folder> accept PACKAGE ID... note that bodies were looked at
"""


def main(arguments: Sequence[str] | None = None) -> int:
    """Run one command; returns the exit status."""
    words = list(sys.argv[1:] if arguments is None else arguments)
    if len(words) < 2 or words[0] not in {"sync", "damage", "status", "accept"}:
        asked = words[:1] in (["-h"], ["--help"])
        (sys.stdout if asked else sys.stderr).write(_USAGE)
        return 0 if asked else 2
    command, root, rest = words[0], Path(words[1]).resolve(), words[2:]
    if command == "status":
        return 3 if _written(sys.stdout, _open(root)) else 0
    if command == "damage":
        return 1 if _written(sys.stderr, _damage(root)) else 0
    try:
        with package.locked(root):
            return _accept(root, rest) if command == "accept" else _sync(root, *rest[:3])
    except BusyError as busy:
        return _written(sys.stderr, [f"error: {busy}: run the command again when that has ended"])


def _accept(root: Path, ids: Sequence[str]) -> int:
    plan, accepted = plan_accept(root, ids)
    missing = sorted({*ids} - {*accepted})
    _written(sys.stderr, (f"{id_}: error: nothing to accept" for id_ in missing))
    return run(plan) or (1 if missing else 0)


def _sync(root: Path, stage: str = "", files: str = "{}", folder: str = "") -> int:
    rendering = root / NEW / stage
    if not package.is_relative(stage) or not rendering.is_dir():
        return 2 * _written(sys.stderr, [f"{rendering}: error: there is no rendering"])
    if files != "{}":
        import json  # noqa: PLC0415 - as most packages have none

        place = Path(folder) if folder else None
        missing = [*place_files(root, rendering, json.loads(files), place)]
        hint = "give its folder, as with `-d files_folder=FOLDER`. Nothing was changed."
        if _written(sys.stderr, (f"error: {name} is not there: {hint}" for name in missing)):
            return 2
    return run(plan_sync(root, rendering))


def place_files(
    root: Path, rendering: Path, files: Mapping[str, str], folder: Path | None
) -> Iterator[str]:
    """Put files, known by SHA-256, of the package or a folder into a rendering; yield lost ones."""
    for name, digest in files.items():
        data = package.known_file(root, name, digest, folder)
        if data is None:
            yield name
        else:
            (rendering / name).parent.mkdir(parents=True, exist_ok=True)
            (rendering / name).write_bytes(data)


def run(plan: Plan) -> int:
    """Do what was planned, and say it; returns 1 where nothing could be done."""
    failed = [f"{note.place}: error: {note.text}" for note in plan.refusals]
    try:
        if not failed:
            plan.prepare()
            plan.finish()
    except OSError as refused:
        failed = [f"{refused.filename or plan.root}: error: {refused.strerror}"]
    if failed:
        hint = "Nothing was changed: no file of yours. Mend that, and run this again."
        return _written(sys.stderr, [*failed, hint])
    words = {True: "warning", False: "note"}
    _written(sys.stderr, (f"{n.place}: {words[n.attention]}: {n.text}" for n in plan.notes))
    return 0


def _written(stream: TextIO, lines: Iterable[str]) -> bool:
    text = "".join(f"{line}\n" for line in lines)
    stream.write(text)
    return bool(text)


def _open(root: Path) -> Iterator[str]:
    for region in list_regions(root):
        if region.review:
            line = f":{region.line}" if region.line else ""
            yield f"{region.file}{line}: {region.state}: {region.why}"


def _damage(root: Path) -> Iterator[str]:
    for name in sorted(package.manifest_of(root).files):
        if stop := package.obstacle(root, name):
            yield f"{name}: error: {stop}"
        elif file := package.read_file(root, name):
            yield from (f"{name}:{fault.line}: error: {fault.reason}" for fault in file.faults)


def program() -> None:
    """Run the command line."""
    sys.exit(main())


if __name__ == "__main__":
    program()
