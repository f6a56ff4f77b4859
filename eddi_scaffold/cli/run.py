"""``eddi-scaffold run``: monitors and packages on recorded inputs, without ROS."""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Literal

import typer

from eddi_scaffold.cli.console import console
from eddi_scaffold.cli.options import Files, for_pictures
from eddi_scaffold.common.files import read_source, refuse_input
from eddi_scaffold.common.problems import EddiError, Place, Problem, problem

if TYPE_CHECKING:
    from eddi_scaffold.recordings.csv_recording import Recording
    from eddi_scaffold.recordings.members import Member


CHECKED_BY_BAG = {"K039"}
"""Warnings of what is unchecked because a message is not known: a bag knows its messages."""


def run(
    files: Files = None,
    inputs: Path | None = None,
    bag: Path | None = None,
    config: list[Path] | None = None,
    workspace: Path | None = None,
    no_code: bool = False,
    name: str | None = None,
    system: Path | None = None,
    models: Path | None = None,
    default_guarantee: list[str] | None = None,
    steps_as: Annotated[Literal["node", "rows"], typer.Option("--steps")] = "node",
    as_json: bool = False,
    as_csv: bool = False,
    why: str | None = None,
    plot: Annotated[Path | None, typer.Option("--plot", callback=for_pictures)] = None,
) -> None:
    """Run monitors on a recording.

    Prints changes of verdicts and why claims do not hold, or every step. Several monitors hear each
    other.

    Example: eddi-scaffold run two_conserts.xml -c consert_a_config.yml --inputs recording.csv

    Args:
        files: EDDI XML, a model file of a kind, configurations that name their models, a
            deployment.yml, or folders of packages, whose hand-written code is executed.
        inputs: CSV with a column t and one per input that no other monitor here gives, called by
            the input, `monitor.input` or `/topic`.
        bag: ROS 1 or 2 bag with the topics of the configurations.
        config: eddi_config.yml: ages, defaults, units; may be repeated.
        workspace: Workspace or output folder: its packages run, or of them those of the files.
        name: Which model of the file, or robot of a deployment.yml.
        no_code: Leave out the code of packages.
        steps_as: As the node would, by mode and frequency, or one for each row.
        as_csv: Print every step as CSV: t and each value.
        why: Print only when and why this claim does not hold: ID, or MONITOR.ID.
        plot: SVG to draw into: inputs and outputs; of several monitors, their verdicts.
    """
    from eddi_scaffold.packages.transaction import write
    from eddi_scaffold.recordings.playing import ROWS, play, played, raising
    from eddi_scaffold.recordings.results import changes, picture, sentences, steps, table

    forms = {"--json": as_json, "--csv": as_csv, "--why": why is not None}
    if sum(forms.values()) > 1:
        names = " and ".join(name for name, chosen in forms.items() if chosen)
        raise EddiError(problem("G000.exclude", options=names))
    options = {
        "--config": config or [], "--name": name, "--default-guarantee": default_guarantee or (),
        "--system": system, "--models": models,
    }  # fmt: skip
    members, recording = recorded(files or [], inputs, bag, workspace, options, code=not no_code)
    if as_csv and len(members) > 1:
        names = ", ".join(member.name for member in members)
        raise EddiError(problem("G000.one_monitor", one_only="--csv", names=names))
    if plot is not None:
        refuse_input(plot)  # before anything is printed
    rule = ROWS if steps_as == "rows" else None
    playback = play(played(members, rule), recording)
    playback = raising(playback, lambda p: console.problems([p], summary=False))
    if why is not None:
        lines = sentences(playback, why)
    elif as_json:
        lines = map(json.dumps, steps(playback))
    else:
        lines = (table if as_csv else changes)(playback)
    for line in lines:
        console.data(line)
    if plot is not None:
        first = members[0].monitor
        title = f"{first.kind.title} {first.model.name}"
        title = title if len(members) == 1 else f"{len(members)} monitors, their verdicts"
        svg = picture(title, play(played(members, rule), recording))
        write(plot.parent, {plot.name: svg.encode()})


def recorded(
    files: Sequence[Path],
    inputs: Path | None,
    bag: Path | None,
    workspace: Path | None,
    options: Mapping[str, Any],
    *,
    code: bool,
) -> tuple[list[Member], Recording]:
    """Return what is to be played and the recording; problems, and whose code runs, are printed."""
    from eddi_scaffold.recordings.bags import read_bag
    from eddi_scaffold.recordings.members import read_values

    if (inputs is None) == (bag is None):
        raise EddiError(problem("G000.one_recording"))
    members, problems = members_of(files, workspace, options, code=code)
    without = any(member.monitor.config is None for member in members)
    if inputs is not None:
        members, recording, more = read_values(read_source(inputs), members)
        if without:
            hint = "generate the package with -c" if members[0].code else "give it with -c"
            more = [*more, problem("I016", hint=hint)]
    elif bag is not None:
        if without:
            raise EddiError(problem("G000.bag"))
        recording, more = read_bag(bag, members)
        problems = [problem for problem in problems if problem.code not in CHECKED_BY_BAG]
    by_hand = [of for member in members for of in member.unknown_without_code]
    if by_hand:
        more = [*more, problem("I014.by_hand", by_hand=", ".join(by_hand))]
    console.problems([*problems, *more])
    executed = [member.name for member in members if member.code is not None]
    if executed or (workspace is not None and code):
        names = ", ".join(executed) or "no package"
        console.say(f"with the code of {names}; --no-code leaves it out")
    return members, recording


def members_of(
    files: Sequence[Path], workspace: Path | None, options: Mapping[str, Any], *, code: bool
) -> tuple[list[Member], list[Problem]]:
    """Return what is to be played, and warnings."""
    from eddi_scaffold.config.deployment_file import is_fleet
    from eddi_scaffold.connect.robot import robot_models
    from eddi_scaffold.monitors.loading import is_config
    from eddi_scaffold.packages.assembly import monitors_of, only
    from eddi_scaffold.packages.running import check_together, packages_in

    config, name, marks, system, models = options.values()
    others = ", ".join(option for option, value in options.items() if value)
    folders, places = [path for path in files if path.is_dir()], [workspace] if workspace else []
    problems: Sequence[Problem] = ()
    if folders or (workspace and not files and not config):
        place = Place(str((folders or places)[0]))
        if len(folders) < len(files) or others or (folders and workspace):
            raise EddiError(problem("G000.package", place))
        members = packages_in(folders or places, code=code).members()
        if not members:
            raise EddiError(problem("U001.nothing_here", place))
    else:
        packages = packages_in(places, code=code)
        source = read_source(files[0]) if len(files) == 1 else None
        if source is not None and is_fleet(source):
            if others not in ("", "--name"):
                raise EddiError(problem("G000.deployment", others=others))
            members, problems = packages.with_robots(source, name)
        else:
            with robot_models(system, models) as (robot, unsure):
                model_files = [path for path in files if not is_config(read_source(path))]
                configs = [*config, *(path for path in files if path not in model_files)]
                monitors, problems = monitors_of(model_files, configs, name, marks, robot)
            if not configs:
                only(monitors)
            members = packages.with_monitors(monitors)
            problems = [*unsure, *problems, *(_unused_lines(members, configs) if code else ())]
    check_together(members)
    return members, [*problems]


def _unused_lines(members: Sequence[Member], configs: Sequence[Path]) -> Iterator[Problem]:
    """Warn of hand-written lines in the packages of these monitors (I014)."""
    from eddi_scaffold.packages.handwritten import packages_of, written

    folders = list(dict.fromkeys([Path.cwd(), *(path.resolve().parent for path in configs)]))
    for member in members if configs else ():
        for package in packages_of(member.monitor.package, folders) if not member.code else ():
            lines = ", ".join(written(package))
            if lines:
                yield problem("I014.lines", Place(str(package)), lines=lines)
