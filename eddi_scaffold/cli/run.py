"""``eddi-scaffold run``: monitors on recorded inputs, without ROS and without generation."""

from __future__ import annotations

from collections.abc import Sequence
from enum import Enum
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from eddi_scaffold.cli.options import (
    DefaultGuarantees,
    Json,
    Name,
    NodeModels,
    System,
    for_pictures,
)

if TYPE_CHECKING:
    from eddi_scaffold.common.problems import Problem
    from eddi_scaffold.config.reading import RobotAdditions
    from eddi_scaffold.monitors.binding import BoundMonitor
    from eddi_scaffold.recordings.csv_recording import Tape
    from eddi_scaffold.recordings.packaged import Packaged
    from eddi_scaffold.recordings.playing import Playback, PlayedMonitor, StepRule


CHECKED_BY_BAG = {"K039"}
"""Warnings of what is unchecked because a message is not known: a bag knows its messages."""


class StepsAs(str, Enum):
    """When a monitor steps."""

    NODE = "node"
    ROWS = "rows"


def run(
    files: Annotated[
        list[Path] | None,
        typer.Argument(
            metavar="[FILE]...",
            help="EDDI XML, a model file of a kind, configurations that name their models, or the "
            "folder of a generated package, whose hand-written code is executed then.",
            show_default=False,
        ),
    ] = None,
    inputs: Annotated[
        Path | None,
        typer.Option(
            "-i",
            "--inputs",
            help="CSV with a column t and one per input that no other monitor here gives.",
        ),
    ] = None,
    bag: Annotated[
        Path | None,
        typer.Option("--bag", help="ROS 1 or 2 bag with the topics of the configurations."),
    ] = None,
    config: Annotated[
        list[Path] | None,
        typer.Option(
            "-c", "--config", help="eddi_config.yml: ages, defaults, units; may be repeated."
        ),
    ] = None,
    name: Name = None,
    system: System = None,
    models: NodeModels = None,
    default_guarantee: DefaultGuarantees = None,
    steps_as: Annotated[
        StepsAs,
        typer.Option(
            "--steps", help="As the node would, by mode and frequency, or one for each row."
        ),
    ] = StepsAs.NODE,
    as_json: Json = False,
    as_csv: Annotated[
        bool, typer.Option("--csv", help="Print every step as CSV: t and each value.")
    ] = False,
    plot: Annotated[
        Path | None,
        typer.Option(
            "--plot",
            callback=for_pictures,
            help="SVG to draw into: inputs and outputs; of several monitors, their verdicts.",
        ),
    ] = None,
) -> None:
    """Run monitors on a recording.

    Prints changes of verdicts, or every step as JSON or CSV. Several monitors hear each other.

    Example: eddi-scaffold run two_conserts.xml -c consert_a_config.yml --inputs recording.csv
    """
    import json

    from eddi_scaffold.cli.console import console
    from eddi_scaffold.common.files import refuse_input
    from eddi_scaffold.common.problems import EddiError, problem
    from eddi_scaffold.connect.robot import robot_models
    from eddi_scaffold.packages.assembly import monitors_of
    from eddi_scaffold.packages.transaction import FileState, write
    from eddi_scaffold.recordings.playing import play
    from eddi_scaffold.recordings.results import changes, picture, steps, table, watched

    if as_json and as_csv:
        raise EddiError(problem("G000.formats"))
    if (inputs is None) == (bag is None):
        raise EddiError(problem("G000.one_recording"))
    others = {"config": config, "name": name, "marks": default_guarantee}
    package = _package(files or [], **others, system=system, models=models)
    configs: list[Path] = []
    monitors: list[BoundMonitor] = []
    problems: list[Problem] = []
    if package is not None:
        monitors = [package.monitor]
    else:
        with robot_models(system, models) as (robot, problems):
            model_files, configs = _models_and_configs(files or [], config or [], robot)
            marks = default_guarantee or ()
            monitors, more = monitors_of(model_files, configs, name, marks, robot)
        problems += more
        problems += _unused_lines(monitors, configs)
    _check_number(monitors, configs, one_only="--csv" if as_csv else None)
    rhythms = _rhythms(monitors, steps_as)
    if bag is not None:
        tape, found = _from_bag(monitors, bag, package)
        problems = [problem for problem in problems if problem.code not in CHECKED_BY_BAG]
    else:
        tape, found = _from_csv(monitors, inputs, package, configs)
    console.problems([*problems, *found])
    if plot is not None:
        refuse_input(plot)  # before anything is printed

    def begun() -> Playback:
        return play(_parts(monitors, rhythms, package, from_bag=bag is not None), tape)

    playing = watched(begun(), console.progress)
    if package is not None:
        playing = package.raising(playing, lambda one: console.problems([one], summary=False))
    if as_json:
        for row in steps(playing):
            console.data(json.dumps(row))
    else:
        for line in (table if as_csv else changes)(playing):
            console.data(line)
    if plot is not None:
        named = (f"{monitor.kind.title} {monitor.model.name}" for monitor in monitors)
        title = next(named) if len(monitors) == 1 else f"{len(monitors)} monitors, their verdicts"
        write(plot.parent, {plot.name: FileState(picture(title, begun()).encode())})


def _package(files: Sequence[Path], **others: object) -> Packaged | None:
    """Return the package that is named in place of a model; its code is executed."""
    from eddi_scaffold.common.problems import EddiError, Place, problem
    from eddi_scaffold.packages.rendering import ANSWERS_FILE

    folder = next((path for path in files if (path / ANSWERS_FILE).is_file()), None)
    if folder is None:
        inside = [one for path in files for one in sorted(path.glob(f"*/{ANSWERS_FILE}"))]
        if inside:
            raise EddiError(
                problem(
                    "G000.folder_of_packages",
                    Place(str(inside[0].parent.parent)),
                    inside=" or ".join(str(one.parent) for one in inside),
                )
            )
        return None
    if len(files) > 1 or any(others.values()):
        raise EddiError(problem("G000.package", Place(str(folder))))
    from eddi_scaffold.recordings.packaged import load

    return load(folder)


def _unused_lines(monitors: Sequence[BoundMonitor], configs: Sequence[Path]) -> list[Problem]:
    """Warn of hand-written lines in the packages of these monitors (I014)."""
    from eddi_scaffold.common.problems import Place, problem
    from eddi_scaffold.packages.handwritten import packages_of, written

    near = list(dict.fromkeys([Path.cwd(), *(path.resolve().parent for path in configs)]))
    found = []
    for monitor in monitors if configs else ():
        for package in packages_of(monitor.package, near):
            lines = ", ".join(written(package))
            if lines:
                found.append(problem("I014.lines", Place(str(package)), lines=lines))
    return found


def _models_and_configs(
    files: Sequence[Path], configs: Sequence[Path], robot: RobotAdditions | None
) -> tuple[list[Path], list[Path]]:
    """Separate models from configurations, which may be given instead of their models."""
    from eddi_scaffold.common.files import read_source
    from eddi_scaffold.common.problems import EddiError, Place, problem
    from eddi_scaffold.config.file import named_model_path
    from eddi_scaffold.config.reading import read_config
    from eddi_scaffold.monitors.loading import is_config

    if len(files) == 1 and configs:
        return list(files), list(configs)
    sources = {path: read_source(path) for path in files}
    models = [path for path, source in sources.items() if not is_config(source)]
    for path in [] if models else files:
        parsed, problems = read_config(sources[path], robot)
        if parsed is None:
            raise EddiError(*problems)
        if named_model_path(parsed) is None:
            raise EddiError(
                problem("F003.configuration_without_model", Place(str(path)), path=path)
            )
    return models, [*configs, *(path for path in sources if path not in models)]


def _check_number(
    monitors: Sequence[BoundMonitor], configs: Sequence[Path], one_only: str | None
) -> None:
    """Refuse several models without configurations, and what shows one monitor only."""
    from eddi_scaffold.common.problems import EddiError, problem
    from eddi_scaffold.packages.assembly import only

    if not configs:
        only(monitors)
    if len(monitors) > 1 and one_only is not None:
        names = ", ".join(monitor.model.name for monitor in monitors)
        raise EddiError(problem("G000.one_monitor", one_only=one_only, names=names))


def _rhythms(monitors: Sequence[BoundMonitor], steps_as: StepsAs) -> list[StepRule]:
    from eddi_scaffold.recordings.parts import rhythm
    from eddi_scaffold.recordings.playing import ROWS

    return [ROWS if steps_as is StepsAs.ROWS else rhythm(monitor) for monitor in monitors]


def _parts(
    monitors: Sequence[BoundMonitor],
    rhythms: Sequence[StepRule],
    package: Packaged | None,
    *,
    from_bag: bool,
) -> Sequence[PlayedMonitor]:
    from eddi_scaffold.recordings.parts import of_messages, of_values

    if from_bag:
        made = package.from_messages() if package is not None else None
        return of_messages(monitors, rhythms, made)
    made = package.from_values() if package is not None else None
    return of_values(monitors, rhythms, made)


def _from_csv(
    monitors: Sequence[BoundMonitor],
    path: Path | None,
    package: Packaged | None,
    configs: Sequence[Path],
) -> tuple[Tape, Sequence[Problem]]:
    from functools import partial

    from eddi_scaffold.common.files import read_source
    from eddi_scaffold.common.problems import problem
    from eddi_scaffold.monitors.survey import inputs_beside
    from eddi_scaffold.recordings.csv_recording import read_tape
    from eddi_scaffold.recordings.parts import beyond_whole, columns

    assert path is not None
    others = partial(inputs_beside, configs)
    tape, found = read_tape(read_source(path), columns(monitors), others)
    found += beyond_whole(monitors, tape, str(path))
    if any(monitor.config is None for monitor in monitors):
        hint = "give it with -c" if package is None else "generate the package with -c"
        found.append(problem("I016", hint=hint))
    found += package.without_lines() if package is not None else []
    return tape, found


def _from_bag(
    monitors: Sequence[BoundMonitor], path: Path, package: Packaged | None
) -> tuple[Tape, Sequence[Problem]]:
    from eddi_scaffold.common.problems import EddiError, problem
    from eddi_scaffold.recordings.bags import read_bag, written_by_hand
    from eddi_scaffold.recordings.parts import published

    if any(monitor.config is None for monitor in monitors):
        raise EddiError(problem("G000.bag"))
    tape, problems = read_bag(path, monitors, published(monitors))
    for monitor in monitors if package is None else ():
        by_hand = written_by_hand(monitor)
        if by_hand:
            problems.append(problem("I014.by_hand", by_hand=", ".join(by_hand)))
    return tape, problems
