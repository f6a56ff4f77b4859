"""Packages made ready to be played, with the lines that people wrote in them.

Loading the code of one **executes it**, as its node does: only of what a person names for it.
"""

from __future__ import annotations

import importlib
import sys
from collections.abc import Callable, Mapping, Sequence
from contextlib import redirect_stdout
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from eddi_runtime.plain_values import one_line

from eddi_scaffold.common.files import Source
from eddi_scaffold.common.problems import (
    EddiError,
    Place,
    Problem,
    did_you_mean,
    has_errors,
    problem,
)
from eddi_scaffold.deployments.fleet_checks import sites_of
from eddi_scaffold.deployments.support import Deployment, check_rings, wired
from eddi_scaffold.deployments.wiring import check_topics
from eddi_scaffold.monitors.binding import BoundMonitor
from eddi_scaffold.monitors.loading import checked_models
from eddi_scaffold.packages.handwritten import written
from eddi_scaffold.packages.upgrading import groups, monitor_of_text
from eddi_scaffold.recordings.members import Code, Member


@dataclass(frozen=True)
class Packages:
    """Packages of monitors, none of which is loaded yet."""

    # folder -> its robot, empty where there is one only, and its answers
    folders: Mapping[Path, tuple[str, Mapping[str, Any]]]
    code: bool  # whether their code runs

    def members(self) -> list[Member]:
        """Return the monitors of all; with several robots each in the namespace of its name."""
        return [
            replace(self._loaded(folder), namespace=f"/{robot}" if robot else "")
            for folder, (robot, _) in self.folders.items()
        ]

    def with_monitors(
        self, monitors: Sequence[BoundMonitor], robot: str = "", namespace: str = ""
    ) -> list[Member]:
        """Return monitors in the namespace of a robot, those of which there is a package as it is.

        Raises:
            EddiError: one cannot be run (I020).
        """
        known = {folder.name: folder for folder, (of, _) in self.folders.items() if of == robot}
        members = []
        for monitor in monitors:
            folder = known.get(monitor.package)
            member = Member(monitor) if folder is None else self._loaded(folder)
            members.append(replace(member, namespace=namespace))
        return members

    def with_robots(
        self, source: Source, name: str | None = None
    ) -> tuple[list[Member], list[Problem]]:
        """Return the same for the robots of a deployment file, or for one, and warnings.

        Raises:
            EddiError: it, or what it names, has errors, or has no robot of this name (F005).
        """
        sites, problems = sites_of(source, checked_models)
        names = [site.name for site in sites]
        if name is not None and name not in names:
            hint = did_you_mean(name, names) or f"there are: {', '.join(names)}"
            raise EddiError(
                problem("F005", Place(source.name), hint=hint, kind=f"no robot {name!r}")
            )
        return [
            member
            for site in sites
            if name in (None, site.name)
            for member in self.with_monitors(site.monitors, site.name, site.form.prefix)
        ], problems

    def _loaded(self, folder: Path) -> Member:
        return load(folder, self.folders[folder][1], code=self.code)


def packages_in(places: Sequence[Path], *, code: bool = True) -> Packages:
    """Find packages: in workspaces, in folders with those of several robots, or the folders.

    Raises:
        EddiError: there are none (U001), or the answers of one are damaged (T005).
    """
    folders = {}
    for place in places:
        for group in groups(place.resolve() if place.is_symlink() else place, ()):
            for name, answers in group.present.items():
                if "facts" in answers:
                    folders[group.root / name] = group.robot, answers
    return Packages(folders, code)


def check_together(members: Sequence[Member]) -> None:
    """Refuse members that nobody could play together.

    Raises:
        EddiError: two have one name (G004), claims rest on themselves (D003), or two publish one
            topic (D005).
    """
    monitors = [wired(m.monitor, m.namespace) for m in members if m.monitor.config is not None]
    problems = [*check_rings(monitors), *check_topics(Deployment(monitors))]
    first: dict[str, Member] = {}
    for member in members:
        if (other := first.setdefault(member.name, member)) is not member:
            both = f"{other.monitor.model.name!r} and {member.monitor.model.name!r}"
            problems.append(problem("G004.same_package", both=both, package=member.name))
    if has_errors(problems):
        raise EddiError(*problems)


def load(folder: Path, answers: Mapping[str, Any], *, code: bool = True) -> Member:
    """Return the monitor of a package; EddiError I020 if it is none, or its code does not run."""
    place = Place(str(folder))
    rejoined = monitor_of_text(folder, answers)
    if rejoined is None:
        raise EddiError(problem("I020.package", place))
    monitor, _ = rejoined
    if not code:
        return Member(monitor)
    try:
        new = _imported(folder.resolve(), monitor)
    except Exception as failure:  # noqa: BLE001 - whatever hand-written code raises
        raise EddiError(problem("I020.code", place, reason=one_line(failure))) from None
    edited = set(written(folder))
    by_hand = {b.model.id for b in monitor.inputs if f"process_{b.attribute}" in edited}
    return Member(monitor, code=Code(folder, frozenset(by_hand), new))


def _imported(folder: Path, monitor: BoundMonitor) -> Callable[[], tuple[Any, Any]]:
    """Import a package as its node or a program would, and leave no file behind."""
    name = monitor.package
    for place in (folder / "src", folder):
        if (place / name / "EDDIMonitor.py").is_file():
            break
    else:  # the folder is the Python package itself
        place, name = folder.parent, folder.name
    for loaded in [key for key in sys.modules if key.partition(".")[0] == name]:
        del sys.modules[loaded]
    before, sys.dont_write_bytecode = sys.dont_write_bytecode, True
    sys.path.insert(0, str(place))
    try:
        with redirect_stdout(sys.stderr):
            monitor_class = importlib.import_module(f"{name}.EDDIMonitor").EDDIMonitor
            input_class = importlib.import_module(f"{name}.EDDIInput").EDDIInput
    finally:
        sys.path.remove(str(place))
        sys.dont_write_bytecode = before

    def new() -> tuple[Any, Any]:
        return monitor_class(), input_class()

    made, eddi_input = new()
    if not hasattr(eddi_input, "begin_step"):  # one of the D7.2 tools
        raise ImportError("its EDDIInput.py is not the generated one: run `eddi-scaffold adopt`")
    if made.monitor.digest != monitor.facts.digest:
        raise ImportError("its compiled.py is of another model: run `eddi-scaffold upgrade`")
    return new
