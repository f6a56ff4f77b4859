"""Packages made ready to be played, with the lines that people wrote in them.

Loading the code of one **executes it**, as its node does: only of what a person names for it.
"""

from __future__ import annotations

import importlib
import sys
from collections.abc import Callable, Sequence
from contextlib import redirect_stdout
from dataclasses import replace
from pathlib import Path
from types import ModuleType
from typing import Any

from eddi_runtime.plain_values import one_line

from eddi_scaffold.common.files import Source
from eddi_scaffold.common.problems import EddiError, Place, Problem, has_errors, problem
from eddi_scaffold.deployments.fleet_checks import sites_of
from eddi_scaffold.deployments.support import check_rings, wired
from eddi_scaffold.deployments.topics import Deployment, check_topics
from eddi_scaffold.monitors.binding import BoundMonitor
from eddi_scaffold.monitors.loading import checked_models
from eddi_scaffold.packages.handwritten import written
from eddi_scaffold.packages.upgrading import groups, monitor_of_text
from eddi_scaffold.recordings.members import Code, Member

Packages = dict[tuple[str, str], Member]
"""Robot (empty where there is one only) and name of a package -> its monitor."""


def packages_in(
    workspace: Path | None, folders: Sequence[Path] = (), *, code: bool = True
) -> Packages:
    """Return the packages in a workspace, in those of several robots, or in some folders.

    Raises:
        EddiError: there are none (U001), or one cannot be run (I020, T005).
    """
    places = [workspace] if workspace is not None else folders
    packages = {}
    for place in places:
        for group in groups(place.resolve() if place.is_symlink() else place, ()):
            for name, answers in group.present.items():
                if "facts_json" in answers:
                    member = load(group.root / name, answers, code=code)
                    namespace = f"/{group.robot}" if group.robot else ""
                    packages[group.robot, name] = replace(member, namespace=namespace)
    return packages


def with_packages(
    monitors: Sequence[BoundMonitor], packages: Packages, robot: str = "", namespace: str = ""
) -> list[Member]:
    """Return monitors in the namespace of a robot, those of which there is a package as it is."""
    members = []
    for monitor in monitors:
        member = packages.get((robot, monitor.package)) or Member(monitor)
        members.append(replace(member, namespace=namespace))
    return members


def robots_of(source: Source, packages: Packages) -> tuple[list[Member], list[Problem]]:
    """Return the monitors of all robots of a deployment file, and warnings.

    Raises:
        EddiError: it, or what it names, has errors.
    """
    sites, problems = sites_of(source, checked_models)
    return [
        member
        for site in sites
        for member in with_packages(site.monitors, packages, site.name, site.robot.form.prefix)
    ], problems


def check_together(members: Sequence[Member]) -> None:
    """Refuse members that nobody could play together.

    Raises:
        EddiError: claims rest on themselves (D003), or two publish one topic (D005).
    """
    monitors = [wired(m.monitor, m.namespace) for m in members if m.monitor.config is not None]
    problems = [*check_rings(monitors), *check_topics(Deployment(monitors))]
    if has_errors(problems):
        raise EddiError(*problems)


def load(folder: Path, answers: dict[str, Any], *, code: bool = True) -> Member:
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
        new()
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
    # A plain package has a runtime of its own, which must be one with that of the others.
    for part in vars(sys.modules[f"{name}.compiled"]).values():
        if isinstance(part, ModuleType) and hasattr(part, "FORMAT"):
            own = importlib.import_module(part.__name__.removeprefix(f"{name}."))
            if part.FORMAT != own.FORMAT:
                raise ImportError("its runtime has another format: run `eddi-scaffold upgrade`")
    if monitor_class().monitor.digest != monitor.facts.digest:
        raise ImportError("its compiled.py is of another model: run `eddi-scaffold upgrade`")
    return lambda: (monitor_class(), input_class())
