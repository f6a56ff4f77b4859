"""``generate`` of a deployment file: a workspace for each robot, and one for the station."""

from __future__ import annotations

from pathlib import Path

from eddi_scaffold.cli.console import console
from eddi_scaffold.cli.reporting import finish
from eddi_scaffold.common.files import read_source
from eddi_scaffold.common.problems import EddiError, Place, problem
from eddi_scaffold.config.deployment_file import is_fleet
from eddi_scaffold.deployments.sites import sites_of
from eddi_scaffold.monitors.loading import checked_models
from eddi_scaffold.packages.fleets import open_inputs, places_of, write_sites
from eddi_scaffold.packages.handwritten import without_written_inputs
from eddi_scaffold.packages.rendering import own_template
from eddi_scaffold.packages.workspace import alone


def generate_fleet(
    deployment: Path, folder: Path | None, others: list[str], *, force: bool, dry_run: bool
) -> None:
    """Write the workspaces of a deployment file.

    Args:
        deployment: the file.
        folder: that gets a folder for each robot.
        others: options that were given, and that the file excludes.
        force: also packages that a later release made.
        dry_run: print the difference, change nothing.

    Raises:
        EddiError: it cannot be used (K001), or options are missing (G006) or too many (G000).
    """
    source = read_source(deployment)
    if not is_fleet(source):
        raise EddiError(problem("K001.deployment", Place(str(deployment))))
    if others:
        raise EddiError(problem("G000.deployment", others=", ".join(others)))
    if folder is None:
        raise EddiError(problem("G006.deployment"))
    sites, problems = sites_of(source, checked_models)
    with alone(() if dry_run else places_of(sites, folder)):
        outcome, found = write_sites(
            sites,
            folder,
            own_template(),
            force=force,
            dry_run=dry_run,
            progress=console.progress,
        )
    places = places_of(sites, folder)

    def packages(name: str) -> list[Path]:
        return [place / name for place in places if (place / name).is_dir()]

    console.problems(without_written_inputs([*problems, *found], packages))
    steps = [f"write this input: {where}" for where in open_inputs(sites, folder)]
    for site in sites:
        steps += [f"{site.name}: {step}" for step in site.next_steps(folder / site.name)]
    finish(outcome, dry_run=dry_run, next_steps=steps)
