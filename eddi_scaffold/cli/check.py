"""``eddi-scaffold check`` and ``show``: what is in files, and what is wrong with it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from eddi_scaffold.cli.console import ExitStatus, console, count_line
from eddi_scaffold.cli.options import PLATFORMS
from eddi_scaffold.common.files import read_source
from eddi_scaffold.common.problems import EddiError, has_errors, in_order
from eddi_scaffold.platforms import DEFAULT

if TYPE_CHECKING:
    from eddi_scaffold.kinds import Model


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
    hazards: bool = False,
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
        hazards: Also what is missing between the hazards of an EDDI and the guarantees.
    """
    from eddi_scaffold.connect.robot import check_robots, robot_models
    from eddi_scaffold.deployments.checking import check_files
    from eddi_scaffold.monitors.input_binding import UnwrittenInput
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
    problems += check_files(others, default_guarantee or (), robot, platform, hazards=hazards)
    problems = in_order(until_written_near(problems, files))
    if as_json:
        console.json({"problems": [problem.as_json() for problem in problems]})
    else:
        console.problems(problems, summary=False)
        by_hand = [
            one.by_hand for one in problems if isinstance(one, UnwrittenInput) and one.by_hand
        ]
        if by_hand and not console.verbose:
            console.say(f"to be written by hand: {', '.join(by_hand)}")
        if unread:
            console.say(f"not checked: {', '.join(map(str, unread))}")
        counts = count_line([problem for problem in problems if console.shows(problem)])
        more = f" (-v shows {count_line(problems)})" if problems and not counts else ""
        console.say(f"{counts or 'no problems'} in {', '.join(map(str, files))}{more}")
    if has_errors(problems):
        raise typer.Exit(ExitStatus.NO)


def show(
    model: Path,
    name: str | None = None,
    config: list[Path] | None = None,
    default_guarantee: list[str] | None = None,
    as_json: bool = False,
) -> None:
    """Show the models of a file as a tree, or as JSON.

    With configurations also what they add, such as thresholds and bins, what they accept in place
    of known values, and the claims that rest on it.

    Example: eddi-scaffold show example.xml -c consert_a_config.yml

    Args:
        model: EDDI XML, a model file of a kind, .rossystem or .ros; or an eddi_config.yml that
            names its model.
    """
    from eddi_scaffold.deployments.joining import accepted_of, unanswered
    from eddi_scaffold.monitors.config_reading import read_file
    from eddi_scaffold.monitors.loading import (
        is_config,
        model_for,
        read_models,
        select_models,
        unfit,
    )
    from eddi_scaffold.monitors.survey import configured, mros_of, only, survey_of

    source = read_source(model)
    robot = mros_of(source)
    if robot is not None:
        if as_json:
            console.json(robot.document)
        else:
            if robot.tree:
                console.data("\n".join(robot.tree))
            console.problems(robot.problems)
        if has_errors(robot.problems):
            raise typer.Exit(ExitStatus.NO if robot.tree else ExitStatus.BAD_INPUT)
        return
    if name is None and not config and not as_json and is_config(source):
        names = [each.config.Model.id for each in read_file(source)[0]]
        if len(names) > 1:  # a robot: its models in turn
            for each in names:
                show(model, each, None, default_guarantee)
            return
    source, configs, warnings = configured(
        source, [read_source(path) for path in config or ()], name
    )
    marks = default_guarantee or ()
    survey, problems = survey_of(source)
    reading = read_models(source, marks)
    if has_errors(problems) or (not reading.models and has_errors(reading.problems)):
        raise EddiError(*(problems if has_errors(problems) else reading.problems))
    chosen: Sequence[Model] = reading.models
    if name is not None:
        named = [config for config in configs if config.config.Model.id == name]
        chosen = [model_for(config, reading.models) for config in named]
        chosen = chosen or select_models(reading.models, name)
        survey = only(survey, chosen)
    accepted, models, wrong = accepted_of(reading.models, configs, marks)
    pairs = list(zip(reading.models, models, strict=True))
    if as_json:
        rows = [acceptance.as_json() for acceptance in accepted]
        console.json({**survey, "accepted": rows} if configs else survey)
    else:
        _print(survey, reading.models, [joined for model, joined in pairs if model in chosen])
        for item in reading.hazards.items.values() if reading.hazards and name is None else ():
            console.data(item.title)
        if accepted:
            console.data("\n".join(["", "accepted:", *(f"  {a.as_text()}" for a in accepted)]))
    of_models = [] if as_json else [*reading.problems, *reading.unread, *unfit(chosen)]
    of_models = unanswered(of_models, [model for model, joined in pairs if joined is not model])
    console.problems([*warnings, *wrong, *of_models])
    if wrong or has_errors(reading.problems):  # what remains of the file was shown
        raise typer.Exit(ExitStatus.NO)


def _print(survey: Mapping[str, Any], models: Sequence[Model], chosen: Sequence[Model]) -> None:
    from eddi_scaffold.kinds import kinds
    from eddi_scaffold.monitors.survey import is_one_of

    for model in chosen:
        console.data(f"{kinds()[model.kind].title} {model.name}")
        for line in model.outline():
            console.data(f"  {line}")
        for linked in model.links.values():
            names = "; ".join(f"{link.class_name} {link.name}" for link in linked.links)
            console.data(f"  {linked.element} {linked.id} is linked with {names}")
    for other in survey["models"]:
        if not is_one_of(other, models):
            counts = ", ".join(f"{number} {what}" for what, number in other["counts"].items())
            console.data(f"{other['kind']} {other['name']} ({counts}); no monitor yet")
