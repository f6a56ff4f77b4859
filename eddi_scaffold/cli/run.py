"""``eddi-scaffold run``: monitors on recorded inputs, without ROS and without generation."""

from __future__ import annotations

import json
from collections.abc import Iterator, Sequence
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Literal

import typer

from eddi_scaffold.cli.console import console
from eddi_scaffold.cli.options import Files, for_pictures
from eddi_scaffold.common.files import read_source, refuse_input
from eddi_scaffold.common.problems import EddiError, Place, Problem, has_errors, problem

if TYPE_CHECKING:
    from eddi_scaffold.monitors.binding import BoundMonitor
    from eddi_scaffold.monitors.config_reading import RobotAdditions
    from eddi_scaffold.packages.running import Packaged
    from eddi_scaffold.recordings.csv_recording import Recording
    from eddi_scaffold.recordings.playing import Playback


CHECKED_BY_BAG = {"K039"}
"""Warnings of what is unchecked because a message is not known: a bag knows its messages."""


def run(
    files: Files = None,
    inputs: Path | None = None,
    bag: Path | None = None,
    config: list[Path] | None = None,
    name: str | None = None,
    system: Path | None = None,
    models: Path | None = None,
    default_guarantee: list[str] | None = None,
    steps_as: Annotated[Literal["node", "rows"], typer.Option("--steps")] = "node",
    as_json: bool = False,
    as_csv: bool = False,
    plot: Annotated[Path | None, typer.Option("--plot", callback=for_pictures)] = None,
) -> None:
    """Run monitors on a recording.

    Prints changes of verdicts, or every step as JSON or CSV. Several monitors hear each other.

    Example: eddi-scaffold run two_conserts.xml -c consert_a_config.yml --inputs recording.csv

    Args:
        files: EDDI XML, a model file of a kind, configurations that name their models, or the
            folder of a generated package, whose hand-written code is executed then.
        inputs: CSV with a column t and one per input that no other monitor here gives.
        bag: ROS 1 or 2 bag with the topics of the configurations.
        config: eddi_config.yml: ages, defaults, units; may be repeated.
        steps_as: As the node would, by mode and frequency, or one for each row.
        as_csv: Print every step as CSV: t and each value.
        plot: SVG to draw into: inputs and outputs; of several monitors, their verdicts.
    """
    from eddi_scaffold.connect.robot import robot_models
    from eddi_scaffold.packages.assembly import monitors_of, only
    from eddi_scaffold.packages.transaction import FileState, write
    from eddi_scaffold.recordings.playing import ROWS, of_messages, of_values, play, step_rule
    from eddi_scaffold.recordings.results import changes, picture, steps, table

    if (as_json and as_csv) or (inputs is None) == (bag is None):
        raise EddiError(problem("G000.formats" if as_json and as_csv else "G000.one_recording"))
    package = _package(files or [], (config, name, default_guarantee, system, models))
    monitors = [package.monitor] if package is not None else []
    configs: list[Path] = []
    problems: Sequence[Problem] = ()
    if package is None:
        with robot_models(system, models) as (robot, unsure):
            model_files, configs = _models_and_configs(files or [], config or [], robot)
            marks = default_guarantee or ()
            monitors, problems = monitors_of(model_files, configs, name, marks, robot)
        problems = [*unsure, *problems, *_unused_lines(monitors, configs)]
    if not configs:
        only(monitors)
    if as_csv and len(monitors) > 1:
        names = ", ".join(monitor.model.name for monitor in monitors)
        raise EddiError(problem("G000.one_monitor", one_only="--csv", names=names))
    if inputs is not None:
        recording, more = _from_csv(monitors, inputs, package, configs)
    elif bag is not None:
        recording, more = _from_bag(monitors, bag, package)
        problems = [problem for problem in problems if problem.code not in CHECKED_BY_BAG]
    console.problems([*problems, *more])
    if plot is not None:
        refuse_input(plot)  # before anything is printed
    rules = [ROWS if steps_as == "rows" else step_rule(monitor) for monitor in monitors]

    def played() -> Playback:
        if bag is not None:
            node = None if package is None else package.from_messages()
            return play(of_messages(monitors, rules, node), recording)
        node = None if package is None else package.from_values()
        return play(of_values(monitors, rules, node), recording)

    playback = played()
    if package is not None:
        playback = package.raising(playback, lambda p: console.problems([p], summary=False))
    lines = (
        map(json.dumps, steps(playback)) if as_json else (table if as_csv else changes)(playback)
    )
    for line in lines:
        console.data(line)
    if plot is not None:
        title = f"{monitors[0].kind.title} {monitors[0].model.name}"
        title = title if len(monitors) == 1 else f"{len(monitors)} monitors, their verdicts"
        write(plot.parent, {plot.name: FileState(picture(title, played()).encode())})


def _package(files: Sequence[Path], others: Sequence[object]) -> Packaged | None:
    """Return the package that is named in place of a model; its code is executed."""
    from eddi_scaffold.packages.rendering import ANSWERS_FILE

    folder = next((path for path in files if (path / ANSWERS_FILE).is_file()), None)
    if folder is None:
        inside = [file for path in files for file in sorted(path.glob(f"*/{ANSWERS_FILE}"))]
        if inside:
            place = Place(str(inside[0].parent.parent))
            names = " or ".join(str(answers.parent) for answers in inside)
            raise EddiError(problem("G000.folder_of_packages", place, inside=names))
        return None
    if len(files) > 1 or any(others):
        raise EddiError(problem("G000.package", Place(str(folder))))
    from eddi_scaffold.packages.running import load

    return load(folder)


def _unused_lines(monitors: Sequence[BoundMonitor], configs: Sequence[Path]) -> Iterator[Problem]:
    """Warn of hand-written lines in the packages of these monitors (I014)."""
    from eddi_scaffold.packages.handwritten import packages_of, written

    folders = list(dict.fromkeys([Path.cwd(), *(path.resolve().parent for path in configs)]))
    for monitor in monitors if configs else ():
        for package in packages_of(monitor.package, folders):
            lines = ", ".join(written(package))
            if lines:
                yield problem("I014.lines", Place(str(package)), lines=lines)


def _models_and_configs(
    files: Sequence[Path], configs: Sequence[Path], robot: RobotAdditions | None
) -> tuple[list[Path], list[Path]]:
    """Separate models from configurations, which may be given instead of their models."""
    from eddi_scaffold.config.file import named_model_path
    from eddi_scaffold.monitors.config_reading import read_file
    from eddi_scaffold.monitors.loading import is_config

    if len(files) == 1 and configs:
        return list(files), list(configs)
    sources = {path: read_source(path) for path in files}
    models = [path for path, source in sources.items() if not is_config(source)]
    for path in [] if models else files:
        parsed, problems = read_file(sources[path], robot)
        if has_errors(problems):
            raise EddiError(*problems)
        if any(named_model_path(config) is None for config in parsed):
            place = Place(str(path))
            raise EddiError(problem("F003.configuration_without_model", place, path=path))
    return models, [*configs, *(path for path in sources if path not in models)]


def _from_csv(
    monitors: Sequence[BoundMonitor],
    path: Path,
    package: Packaged | None,
    configs: Sequence[Path],
) -> tuple[Recording, Sequence[Problem]]:
    from eddi_scaffold.monitors.survey import inputs_of_others
    from eddi_scaffold.recordings.csv_recording import read_recording
    from eddi_scaffold.recordings.playing import columns, more_than_all

    others = partial(inputs_of_others, configs)
    recording, problems = read_recording(read_source(path), columns(monitors), others)
    problems += more_than_all(monitors, recording, str(path))
    if any(monitor.config is None for monitor in monitors):
        hint = "give it with -c" if package is None else "generate the package with -c"
        problems.append(problem("I016", hint=hint))
    return recording, [*problems, *(package.out_of_reach() if package is not None else ())]


def _from_bag(
    monitors: Sequence[BoundMonitor], path: Path, package: Packaged | None
) -> tuple[Recording, Sequence[Problem]]:
    from eddi_scaffold.recordings.bags import read_bag
    from eddi_scaffold.recordings.playing import published

    if any(monitor.config is None for monitor in monitors):
        raise EddiError(problem("G000.bag"))
    recording, problems = read_bag(path, monitors, published(monitors))
    for monitor in monitors if package is None else ():
        # Values that only code of a person gives stay unknown here.
        by_hand = [b.model.id for b in monitor.inputs if b.requires and not b.is_given]
        if by_hand:
            problems.append(problem("I014.by_hand", by_hand=", ".join(by_hand)))
    return recording, problems
