"""What people wrote in packages: their regions, what is open, what waits to be written."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterable, Sequence
from functools import cache, partial
from pathlib import Path

from eddi_scaffold.common.files import saved_meanwhile
from eddi_scaffold.common.problems import EddiError, Place, Problem, problem
from eddi_scaffold.monitors.binding import BoundMonitor
from eddi_scaffold.monitors.input_binding import UnwrittenInput
from eddi_scaffold.packages.rendering import ANSWERS_FILE, read_answers
from eddi_scaffold.packages.workspace import alone
from eddi_scaffold.regions.check import list_regions, plan_accept
from eddi_scaffold.regions.package import EDDI, KEPT, Plan, SavedError


def unwritten(root: Path, monitors: Iterable[BoundMonitor]) -> list[str]:
    """Return what a person must still write, and where: inputs, methods of a kind."""
    lines = []
    for monitor in monitors:
        ids = {binding.regions[0]: "input" for binding in monitor.inputs if not binding.is_given}
        ids |= {method.name: "node" for method in monitor.needed_methods}
        for region in list_regions(root / monitor.package) if ids else ():
            if region.id in ids and region.state == "untouched":
                place = f"{root / monitor.package / region.file}:{region.line}"
                lines.append(f"this {ids[region.id]}: {place}")
    return lines


def written(package: Path) -> list[str]:
    """Return the ids of the regions of a package in which somebody has written."""
    return [region.id for region in list_regions(package) if region.state == "edited"]


def without_written_inputs(
    problems: Iterable[Problem], packages: Callable[[str], Sequence[Path]]
) -> list[Problem]:
    """Leave out what is not true any more, because a person has written the region of the input.

    ``packages``: name of a package -> the folders where it is.
    """

    @cache
    def edited(package: str) -> list[list[str]]:
        return [written(folder) for folder in packages(package)]

    def is_written(problem: Problem) -> bool:
        if not isinstance(problem, UnwrittenInput):
            return False
        places = edited(problem.package)
        return bool(places) and all(map(set(problem.regions).intersection, places))

    return [problem for problem in problems if not is_written(problem)]


def until_written_near(problems: Iterable[Problem], files: Iterable[Path]) -> list[Problem]:
    """Return the same, where the packages are looked for near the files that were checked."""
    folders = list(dict.fromkeys(file.resolve().parent for file in files))
    return without_written_inputs(problems, partial(packages_of, folders=folders))


def packages_of(package: str, folders: Iterable[Path]) -> list[Path]:
    """Return where the package of a monitor is, in workspaces around or below some folders.

    Only the places of a catkin workspace and of ``generate -o`` are looked at, nothing else.
    """
    files: dict[Path, None] = {}
    for folder in folders:
        places = [(folder, pattern) for pattern in ("", "*/", "src/*/", "*/src/*/")]
        places += [(parent, "src/*/") for parent in folder.parents]
        for place, pattern in places:
            files |= dict.fromkeys(sorted(place.glob(f"{pattern}{package}/{ANSWERS_FILE}")))
    return [path.parent for path in files if path.is_file()]


def packages_below(folder: Path) -> list[Path]:
    """Return the generated packages in a folder, itself included (EddiError, U001, for none)."""
    packages = []
    for root, folders, files in os.walk(folder):
        made = ANSWERS_FILE in files and (EDDI in folders or read_answers(Path(root)))
        if made or Path(root, KEPT).is_dir():  # one that has left, with texts of a person
            packages.append(Path(root))
        folders[:] = sorted({*folders} - {".git", "build", "devel", "install", EDDI})
    if not packages:
        raise EddiError(problem("U001.nothing_here", Place(str(folder))))
    return packages


def accept_regions(folder: Path, ids: Iterable[str]) -> Sequence[str]:
    """Confirm that bodies in a package, or in those of a folder, were looked at and are right.

    Raises:
        EddiError: there is nothing of such a name to accept (U004), or a package cannot be written.
    """
    chosen, accepted = set(ids), set[str]()
    packages = packages_below(folder)
    with alone(packages):
        for package in packages:
            plan, ids_here = plan_accept(package, chosen)
            write_plans([plan])
            accepted |= {*ids_here}
    for missing in sorted(chosen - accepted):
        raise EddiError(problem("U004", Place(str(folder)), missing=missing, folder=folder))
    return sorted(accepted)


def write_plans(plans: Sequence[Plan]) -> None:
    """Write what was planned for packages: first every byte beside its place, then only renames.

    Raises:
        EddiError: one cannot be written (F002), or a file was saved meanwhile (F013).
    """
    try:
        for plan in plans:
            plan.prepare()
        for plan in plans:
            plan.finish()
    except SavedError as saved:
        raise saved_meanwhile(Path(saved.filename)) from None
    except OSError as failure:
        reason = failure.strerror or str(failure)
        place = Place(str(failure.filename or plans[0].root))
        raise EddiError(problem("F002.write", place, reason=reason)) from None
