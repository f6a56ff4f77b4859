"""The workspaces of several robots, written as one: all of them, or none."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path

from eddi_scaffold.common.problems import Problem
from eddi_scaffold.deployments.fleet_checks import Site
from eddi_scaffold.packages.assembly import assemble
from eddi_scaffold.packages.generation import WriteResult, write_packages
from eddi_scaffold.packages.renaming import left_behind
from eddi_scaffold.packages.rendering import Template
from eddi_scaffold.packages.workspace import existing, root_below


def places_of(sites: Sequence[Site], folder: Path) -> list[Path]:
    """Return the folders that are written: of all robots, and of the packages of each."""
    return [folder, *(_root(site, folder) for site in sites)]


def write_sites(
    sites: Sequence[Site],
    folder: Path,
    template: Template,
    *,
    dry_run: bool = False,
    progress: Callable[[str], None] = lambda _: None,
) -> tuple[WriteResult, list[Problem]]:
    """Write a workspace for each robot into a folder, as one step; the rest as for one.

    Returns:
        What was done, with paths relative to ``folder``, and warnings.

    Raises:
        EddiError: a package cannot be made; nothing was written.
    """
    plans = {
        site: assemble(site.monitors, site.platform, _root(site, folder), ()) for site in sites
    }
    packages = [
        replace(package, folder=(Path(site.name, site.platform.root) / package.folder).as_posix())
        for site, plan in plans.items()
        for package in plan.packages
    ]
    outcome = write_packages(folder, packages, template, dry_run=dry_run, progress=progress)
    decide = [*outcome.left]
    for site, plan in plans.items():
        own = {monitor.package for monitor in site.monitors}
        decide += [
            f"{site.name}: {name} is no monitor of this robot in the deployment file, and still "
            "runs; remove its folder and repeat this"
            for name, answers in plan.present.items()
            if "facts" in answers and name not in own
        ]
        old = left_behind(plan.present, plan.packages, site.monitors, ())
        decide += [f"{site.name}: {text}" for text, is_new in old if is_new]
    known, roots = {site.name for site in sites}, {site.platform.root for site in sites}
    for place in sorted(folder.iterdir()) if folder.is_dir() else []:
        is_ours = place.is_dir() and not place.is_symlink() and place.name not in known
        if is_ours and any(existing(place / root) for root in roots):
            robot = f"{place.name} is no robot of the deployment file"
            decide.append(f"{robot}, and its monitors may still run")
    problems = [problem for plan in plans.values() for problem in plan.problems]
    return replace(outcome, left=decide), problems


def _root(site: Site, folder: Path) -> Path:
    return root_below(folder / site.name, site.platform.root)
