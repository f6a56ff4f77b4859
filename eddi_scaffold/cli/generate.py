"""``eddi-scaffold generate``: whole packages from models and configurations."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from shlex import quote
from typing import Annotated

import typer

from eddi_scaffold.cli.options import (
    ConfigFiles,
    DefaultGuarantees,
    DryRun,
    Name,
    NodeModels,
    OptionalModelFile,
    System,
    in_a_folder,
)


def generate(
    model: OptionalModelFile = None,
    workspace: Annotated[
        Path | None,
        typer.Option("-w", "--workspace", help="Catkin workspace (for the platform ros1)."),
    ] = None,
    config: ConfigFiles = None,
    output: Annotated[
        Path | None,
        typer.Option(
            "-o", "--output", callback=in_a_folder, help="Folder (for the platform plain)."
        ),
    ] = None,
    platform: Annotated[str, typer.Option(help="ros1 or plain.")] = "ros1",
    system: System = None,
    models: NodeModels = None,
    name: Name = None,
    default_guarantee: DefaultGuarantees = None,
    dry_run: DryRun = False,
) -> None:
    """Generate monitors, or regenerate them; hand-written lines stay.

    Example: eddi-scaffold generate -w catkin_ws -c consert_a_config.yml -m example.xml
    """
    from eddi_scaffold.cli.console import console
    from eddi_scaffold.cli.reporting import finish
    from eddi_scaffold.deployments.wiring.check import members_of
    from eddi_scaffold.deployments.wiring.topics import shared_by_robots
    from eddi_scaffold.packages.assembly import assemble, monitors_of
    from eddi_scaffold.packages.generation import write_packages
    from eddi_scaffold.packages.handwritten import unwritten
    from eddi_scaffold.packages.rendering import own_template
    from eddi_scaffold.packages.workspace import root_below
    from eddi_scaffold.platforms import chosen
    from eddi_scaffold.problems import EddiError, Place, error
    from eddi_scaffold.robot.robot_models import beside_configs

    if model is None and not config:
        raise EddiError(error("G015", "give a model: -m MODEL, or a -c that names its model"))
    target = chosen(platform)
    place, option = (workspace, "-w WORKSPACE") if target.root else (output, "-o FOLDER")
    if place is None:
        raise EddiError(error("G006", f"the platform {platform} needs {option}"))
    if workspace is not None and output is not None:
        message = f"-w is for the platform ros1, -o for plain: the platform is {platform}"
        raise EddiError(error("G014", message, hint="leave the other one out"))
    if target.root and not place.is_dir():
        hint = f"mkdir -p {place}/src"
        raise EddiError(error("G007", "there is no such catkin workspace", Place(str(place)), hint))
    if target.root and place.resolve().name == "src" and not (place / "src").exists():
        hint = f"name the folder above: -w {place.parent}"
        raise EddiError(error("G007", "this is the `src` of a workspace", Place(str(place)), hint))
    root = root_below(place, target.root)
    robot, problems = beside_configs(system, models)
    monitors, found = monitors_of(model, config or [], name, default_guarantee or (), robot)
    problems = [*problems, *found]
    assembly = assemble(monitors, target, root, problems)
    console.problems(assembly.problems)
    outcome = write_packages(
        root, assembly.packages, own_template(), dry_run=dry_run, progress=console.progress
    )
    shared = shared_by_robots(members_of(monitors))
    if shared is not None:
        console.say(f"note: {shared}")
    steps = [f"write this input: {where}" for where in unwritten(root, monitors)]
    steps += _next_steps(target.name, place, assembly.monitors)
    finish(outcome, dry_run=dry_run, next_steps=steps)


def _next_steps(platform: str, place: Path, monitors: Sequence[str]) -> list[str]:
    if platform == "ros1":
        return [
            f"cd {quote(str(place))} && catkin_make -DPYTHON_EXECUTABLE=/usr/bin/python3",
            "source devel/setup.bash",
            "roslaunch eddi_monitor_launcher eddi.launch",
        ]
    return [f"pip install {quote(str(place / monitors[0]))}"]
