"""``eddi-scaffold generate``: whole packages from models and configurations."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Annotated

import typer

from eddi_scaffold.cli.console import console
from eddi_scaffold.cli.options import Output, PlatformName, Runtime, SingleProcess
from eddi_scaffold.common.files import read_source
from eddi_scaffold.common.problems import EddiError, Place, problem
from eddi_scaffold.platforms import DEFAULT


def generate(
    deployment: Annotated[
        Path | None, typer.Argument(metavar="DEPLOYMENT", show_default=False)
    ] = None,
    model: Path | None = None,
    workspace: Path | None = None,
    config: list[Path] | None = None,
    output: Output = None,
    platform: PlatformName = DEFAULT,
    system: Path | None = None,
    models: Path | None = None,
    name: str | None = None,
    default_guarantee: list[str] | None = None,
    runtime: Runtime = None,
    single_process: SingleProcess = None,
    rename: list[str] | None = None,
    force: bool = False,
    dry_run: bool = False,
) -> None:
    """Generate monitors, also anew; hand-written lines stay.

    Example: eddi-scaffold generate -w catkin_ws -c consert_a_config.yml -m example.xml

    Args:
        deployment: A deployment.yml, with -o FOLDER alone: a workspace for each of its robots.
        workspace: Workspace, such as catkin's (for a platform that is built in one).
        output: Folder (for the others).
        rename: `OLD=NEW`: the monitor had another name; its package moves, with all in it.
    """
    if deployment is not None:
        values = {
            "--model": model, "--workspace": workspace, "--config": config, "--system": system,
            "--models": models, "--name": name, "--default-guarantee": default_guarantee,
            "--runtime": runtime, "--single-process": single_process, "--rename": rename,
            "--platform": None if platform == DEFAULT else platform,
        }  # fmt: skip
        others = [option for option, value in values.items() if value is not None]
        _generate_fleet(deployment, output, others, force=force, dry_run=dry_run)
        return

    from eddi_scaffold.cli.reporting import destination, finish
    from eddi_scaffold.connect.robot import robot_models
    from eddi_scaffold.deployments.topics import shared_by_robots
    from eddi_scaffold.deployments.wiring import members_of
    from eddi_scaffold.packages.assembly import assemble, monitors_of
    from eddi_scaffold.packages.generation import write_packages
    from eddi_scaffold.packages.handwritten import unwritten
    from eddi_scaffold.packages.renaming import left_behind, read_renames
    from eddi_scaffold.packages.rendering import own_template
    from eddi_scaffold.packages.workspace import alone, packages_root
    from eddi_scaffold.platforms import choices, chosen

    target = chosen(platform)
    place = destination(target, workspace, output)
    root = packages_root(target, place)
    marks = default_guarantee or ()
    with alone(() if dry_run else [root]):
        with robot_models(system, models) as (robot, unsure):
            monitors, problems = monitors_of(
                model, config or [], name, marks, robot, root, rename or ()
            )
        renames = read_renames(rename or (), root, {monitor.package for monitor in monitors})
        moved, options = renames.involved, choices(runtime, single_process)
        assembly = assemble(monitors, target, root, [*unsure, *problems], options, moved)
        console.problems(assembly.problems)
        older = list(left_behind(assembly.present, assembly.packages, monitors, moved))
        outcome = write_packages(
            root,
            assembly.packages,
            own_template(),
            renames=renames,
            force=force,
            dry_run=dry_run,
            progress=console.progress,
        )
    left = [*outcome.left, *(text for text, is_new in older if is_new)]
    notes = [*outcome.notes, *(text for text, is_new in older if not is_new)]
    shared = shared_by_robots(members_of(monitors))
    if shared is not None:
        console.say(f"note: {shared}")
    steps = [f"write {where}" for where in unwritten(root, monitors)]
    steps += target.next_steps(place, assembly.monitors)
    finish(replace(outcome, left=left, notes=notes), dry_run=dry_run, next_steps=steps)


def _generate_fleet(
    deployment: Path, folder: Path | None, others: Sequence[str], *, force: bool, dry_run: bool
) -> None:
    """Write a workspace for each robot of a deployment file, and one for the station."""
    from eddi_scaffold.cli.reporting import finish
    from eddi_scaffold.config.deployment_file import is_fleet
    from eddi_scaffold.deployments.fleet_checks import sites_of
    from eddi_scaffold.monitors.loading import checked_models
    from eddi_scaffold.packages.fleets import open_inputs, places_of, write_sites
    from eddi_scaffold.packages.handwritten import without_written_inputs
    from eddi_scaffold.packages.rendering import own_template
    from eddi_scaffold.packages.workspace import alone

    source = read_source(deployment)
    if not is_fleet(source):
        raise EddiError(problem("K001.deployment", Place(str(deployment))))
    if others:
        raise EddiError(problem("G000.deployment", others=", ".join(others)))
    if folder is None:
        raise EddiError(problem("G006.deployment"))
    sites, problems = sites_of(source, checked_models)
    places = places_of(sites, folder)
    with alone(() if dry_run else places):
        outcome, more = write_sites(
            sites,
            folder,
            own_template(),
            force=force,
            dry_run=dry_run,
            progress=console.progress,
        )

    def packages(name: str) -> list[Path]:
        return [place / name for place in places_of(sites, folder) if (place / name).is_dir()]

    console.problems(without_written_inputs([*problems, *more], packages))
    steps = [f"write this input: {where}" for where in open_inputs(sites, folder)]
    for site in sites:
        steps += [f"{site.name}: {step}" for step in site.next_steps(folder / site.name)]
    finish(outcome, dry_run=dry_run, next_steps=steps)
