"""The regions of every package below a folder, for ``eddi-scaffold regions``."""

from __future__ import annotations

import os
import re
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cache, partial
from pathlib import Path
from typing import Any

from eddi_scaffold.common.files import read_regular, saved_meanwhile
from eddi_scaffold.common.problems import EddiError, Place, Problem, did_you_mean, problem
from eddi_scaffold.monitors.binding import BoundMonitor
from eddi_scaffold.monitors.input_binding import UnwrittenInput
from eddi_scaffold.packages.rendering import ANSWERS_FILE, read_answers
from eddi_scaffold.packages.workspace import alone
from eddi_scaffold.regions.check import RegionStatus, list_regions, plan_accept
from eddi_scaffold.regions.markers import Marker, read_marker
from eddi_scaffold.regions.package import EDDI, KEPT, SavedError
from eddi_scaffold.regions.sync import Plan


@dataclass(frozen=True)
class HandwrittenRegion:
    """One region of one package.

    Attributes:
        file: path as the user would write it.
        status: the report of the regions tool.
    """

    file: str
    status: RegionStatus

    def as_json(self) -> dict[str, object]:
        """Return the stable JSON form of ``regions --json``."""
        state = self.status
        return {
            "id": state.id,
            "file": self.file,
            "line": state.line,
            "state": state.state,
            "notes": list(state.notes),
        }


ADOPT = (
    "this file is of the D7.2 tools: it runs as it is, and no regeneration fits it to the model;"
    " `eddi-scaffold adopt OLD_PACKAGE` puts its bodies into regions"
)
_OF_D72 = re.compile(r"^class EDDIInput\s*(\(\s*(object)?\s*\))?\s*:", re.MULTILINE)
_WHAT = {"process": "input", "node": "node"}
"""First word of the id of a region -> what a person writes in it."""


def unwritten(root: Path, monitors: Iterable[BoundMonitor]) -> list[str]:
    """Return what a person must still write, and where: inputs, methods of a kind."""
    needed = {
        monitor.package: {
            *(binding.regions[0] for binding in monitor.inputs if not binding.is_given),
            *(method.name for method in monitor.needed_methods),
        }
        for monitor in monitors
    }
    return [
        f"this {_WHAT[status.id.partition('_')[0]]}: {root / package / status.file}:{status.line}"
        for package, ids in needed.items()
        for status in (list_regions(root / package) if ids else ())
        if status.id in ids and status.state == "untouched"
    ]


def lost_sources(package: Path, before: Mapping[str, Any], after: Mapping[str, Any]) -> list[str]:
    """Return a line for each input that was made of messages, and is left to nobody now.

    Args:
        package: the folder with its newest files.
        before: its former answers.
        after: its answers.
    """
    made = {marker.id: line for marker, line, _ in _statements(before)}
    lost, titles = {}, {}
    for marker, line, title in _statements(after):
        names = (marker.id, *marker.was)
        was = next((made[name] for name in names if made.get(name)), None)
        if was is not None and not line:
            lost[names], titles[names] = was, title
    edited = set(written(package)) if lost else set()
    return [
        f"input {titles[names]!r} has no source any more: it was made by `{was}`"
        for names, was in lost.items()
        if not edited.intersection(names)
    ]


def _statements(answers: Mapping[str, Any]) -> list[tuple[Marker, str, str]]:
    """Return each input, its generated statement, none where a person must write it, and its id.

    Answers may be of an older release, or damaged: what is not there says nothing.
    """
    found = []
    inputs = answers.get("inputs")
    for one in inputs if isinstance(inputs, list) else ():
        if isinstance(one, dict) and isinstance(body := one.get("body"), list) and body:
            marker = read_marker(str(one.get("region_begin")), 1)
            if isinstance(marker, Marker):
                waits = body[-1] == f"self.{one.get('attribute')} = None"
                found.append((marker, "" if waits else str(body[-1]), str(one.get("title"))))
    return found


def written(package: Path) -> list[str]:
    """Return the ids of the regions of a package in which somebody has written."""
    return [region.id for region in list_regions(package) if region.state == "edited"]


def without_written_inputs(
    problems: Iterable[Problem], packages: Callable[[str], Sequence[Path]]
) -> list[Problem]:
    """Leave out what is not true any more, because a person has written the region of the input.

    Args:
        problems: what was found in models and configurations.
        packages: from the name of a package to the folders where it is.
    """

    @cache
    def edited(package: str) -> list[list[str]]:
        return [written(one) for one in packages(package)]

    def is_written(problem: Problem) -> bool:
        if not isinstance(problem, UnwrittenInput):
            return False
        regions = set(problem.regions)
        there = edited(problem.package)
        return bool(there) and all(map(regions.intersection, there))

    return [problem for problem in problems if not is_written(problem)]


def until_written_near(problems: Iterable[Problem], files: Iterable[Path]) -> list[Problem]:
    """Return the same, where the packages are looked for near the files that were checked."""
    near = list(dict.fromkeys(file.resolve().parent for file in files))
    return without_written_inputs(problems, partial(packages_of, near=near))


def packages_of(package: str, near: Iterable[Path]) -> list[Path]:
    """Return where the package of a monitor is, in workspaces around or below some folders.

    Only the places of a catkin workspace and of ``generate -o`` are looked at, nothing else.
    """
    file = f"{package}/{ANSWERS_FILE}"
    found: dict[Path, None] = {}
    for folder in near:
        places = [(folder, pattern) for pattern in ("", "*/", "src/*/", "*/src/*/")]
        places += [(parent, "src/*/") for parent in folder.parents]
        for place, pattern in places:
            found |= dict.fromkeys(sorted(place.glob(f"{pattern}{file}")))
    return [path.parent for path in found if path.is_file()]


def packages_below(folder: Path) -> list[Path]:
    """Return the generated packages in a folder, itself included.

    Raises:
        EddiError: there are none (U001).
    """
    found = []
    for root, folders, files in os.walk(folder):
        made = ANSWERS_FILE in files and (EDDI in folders or read_answers(Path(root)))
        if made or Path(root, KEPT).is_dir():  # one that has left, with texts of a person
            found.append(Path(root))
        skipped = {".git", "build", "devel", "install", EDDI}
        folders[:] = sorted(name for name in folders if name not in skipped)
    if not found:
        raise EddiError(problem("U001.nothing_here", Place(str(folder))))
    return found


def is_of_d72(file: Path) -> bool:
    """Return whether a file has an ``EDDIInput`` as the D7.2 tools wrote it."""
    try:
        return _OF_D72.search(read_regular(file).decode("utf-8", "replace")) is not None
    except OSError:  # a FIFO as well, which would be waited for
        return False


def looked_at(package: Path) -> list[RegionStatus]:
    """List the regions of a package with what a person should look at; a pasted file as a whole."""
    pasted = cache(lambda file: is_of_d72(package / file))
    return [
        replace(region, notes=(*region.notes, ADOPT), review=True)
        if pasted(region.file)
        else region
        for region in list_regions(package)
    ]


def inventory(folder: Path) -> Sequence[HandwrittenRegion]:
    """List the regions of all packages below a folder."""
    return [
        HandwrittenRegion(str(package / status.file), status)
        for package in packages_below(folder)
        for status in looked_at(package)
    ]


def accept_regions(folder: Path, ids: Iterable[str]) -> Sequence[str]:
    """Confirm that bodies were looked at and are right.

    Args:
        folder: a package, or a folder that holds packages.
        ids: of regions.

    Raises:
        EddiError: there is nothing of such a name to accept (U004), or a package cannot be written.
    """
    wanted, accepted = set(ids), set[str]()
    packages = packages_below(folder)
    with alone(packages):
        for package in packages:
            plan, found = plan_accept(package, wanted)
            write_plans([plan])
            accepted |= {*found}
    for missing in sorted(wanted - accepted):
        known = [region.id for package in packages for region in list_regions(package) if region.id]
        hint = did_you_mean(missing, known) if missing not in known else None
        raise EddiError(
            problem("U004", Place(str(folder)), hint=hint, missing=missing, folder=folder)
        )
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
        raise saved_meanwhile(Path(str(saved))) from None
    except OSError as failure:
        reason = failure.strerror or str(failure)
        place = Place(str(failure.filename or plans[0].root))
        raise EddiError(problem("F002.write", place, reason=reason)) from None
