"""``eddi-scaffold check``: all problems of all files, with their places."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Annotated

import typer

from eddi_scaffold.cli import exit_status
from eddi_scaffold.cli.console import console, count_line
from eddi_scaffold.cli.options import PLATFORMS
from eddi_scaffold.common.problems import has_errors, in_order
from eddi_scaffold.platforms import DEFAULT


def check(
    files: list[Path],
    system: Path | None = None,
    models: Path | None = None,
    default_guarantee: list[str] | None = None,
    platform: Annotated[
        str | None,
        typer.Option(
            help=f"{PLATFORMS}: can monitors be generated for it? By default, of what has a "
            f"configuration, for {DEFAULT}, with lifecycle for ros2."
        ),
    ] = None,
    as_json: bool = False,
) -> None:
    """Validate files: all problems at once, with places.

    Configurations given together with a model are checked against it, a .rossystem and the message
    types of a configuration against the node models of --models. A deployment.yml is checked with
    all that it names. What `generate` would refuse because of the files is a problem here.

    Example: eddi-scaffold check example.xml consert_a_config.yml

    Args:
        files: EDDI XML, model files of a kind, eddi_config.yml, deployment.yml, .rossystem, .ros;
            or folders with such files.
    """
    from eddi_scaffold.connect.robot import check_robots, robot_models
    from eddi_scaffold.deployments.checking import ByHand, check_files
    from eddi_scaffold.monitors.loading import named_like_mros
    from eddi_scaffold.monitors.survey import files_of
    from eddi_scaffold.packages.handwritten import until_written_near

    unread: list[Path] = []
    for folder in [file for file in files if file.is_dir()]:
        inside, rest = files_of(folder)
        at = files.index(folder)
        files[at : at + 1] = inside
        unread += rest
    robots = [file for file in files if named_like_mros(file.name)]
    others = [file for file in files if file not in robots]
    problems, robot = check_robots(robots, others, models)
    if system is not None:
        reported = {replace(problem, level="warning") for problem in problems}
        with robot_models(system, models) as (robot, unsure):
            problems += [problem for problem in unsure if problem not in reported]
    problems += check_files(others, default_guarantee or (), robot, platform)
    problems = in_order(until_written_near(problems, files))
    if as_json:
        console.json({"problems": [problem.as_json() for problem in problems]})
    else:
        console.problems(problems, summary=False)
        by_hand = [problem.of for problem in problems if isinstance(problem, ByHand)]
        if by_hand and not console.verbose:
            console.say(f"to be written by hand: {', '.join(by_hand)}")
        if unread:
            console.say(f"not checked: {', '.join(map(str, unread))}")
        counts = count_line([problem for problem in problems if console.shows(problem)])
        more = f" (-v shows {count_line(problems)})" if problems and not counts else ""
        console.say(f"{counts or 'no problems'} in {', '.join(map(str, files))}{more}")
    if has_errors(problems):
        raise typer.Exit(exit_status.NO)
