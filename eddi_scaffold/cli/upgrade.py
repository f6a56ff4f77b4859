"""``eddi-scaffold upgrade``: newer model, configuration or templates into existing packages."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from eddi_scaffold.cli.options import (
    ConfigFiles,
    DryRun,
    Force,
    NodeModels,
    System,
    WherePackagesAre,
)


def upgrade(
    packages: Annotated[
        list[Path] | None, typer.Argument(help="Package folders; default: all of the workspace.")
    ] = None,
    workspace: WherePackagesAre = None,
    model: Annotated[Path | None, typer.Option("-m", "--model", help="Newer model file.")] = None,
    config: ConfigFiles = None,
    system: System = None,
    models: NodeModels = None,
    force: Force = False,
    dry_run: DryRun = False,
) -> None:
    """Bring packages to this release; hand edits stay.

    Monitors are compiled of the models in their packages. To change a model or a configuration,
    run `generate` again; with -m or -c this command does the same for packages that are there, and
    makes no new ones.

    Example: eddi-scaffold upgrade -w catkin_ws -m example_v2.xml --dry-run
    """
    from dataclasses import replace

    from eddi_scaffold.cli.console import console
    from eddi_scaffold.cli.reporting import finish
    from eddi_scaffold.common.problems import EddiError, problem
    from eddi_scaffold.connect.robot import robot_models
    from eddi_scaffold.packages import upgrading
    from eddi_scaffold.packages.generation import WriteResult, write_packages
    from eddi_scaffold.packages.rendering import own_template
    from eddi_scaffold.packages.workspace import alone, linked_package

    if not config and (system is not None or models is not None):
        raise EddiError(problem("G000.no_configuration"))
    outcomes: list[WriteResult] = []
    template = own_template()
    places = upgrading.roots(workspace, packages or [])
    with alone(() if dry_run else places), robot_models(system, models) as (robot, unsure):
        groups = upgrading.groups(workspace, packages or [])
        upgrading.refuse_for_several(groups, model, config or [])
        plans = [(g, *upgrading.targets(g, model, config or [], robot)) for g in groups]
        console.problems(unsure)
        for group, targets, problems in plans:
            console.problems(problems)
            outcome = write_packages(
                group.root,
                targets,
                template,
                force=force,
                dry_run=dry_run,
                progress=console.progress,
            )
            links = [linked_package(link) for link in group.links]
            left = [*links, *upgrading.compiled_before(targets), *outcome.left]
            outcomes.append(replace(outcome, left=left))
    finish(*outcomes, dry_run=dry_run)
