"""``eddi-scaffold run``: a monitor on recorded inputs, without ROS and without generation."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from eddi_scaffold.cli.options import DefaultGuarantees, Json, Name, for_pictures

if TYPE_CHECKING:
    from eddi_scaffold.monitors.binding import Monitor
    from eddi_scaffold.problems import Problem
    from eddi_scaffold.replay.running import Play


def run(
    model: Annotated[
        Path | None,
        typer.Argument(
            help="EDDI XML, a model file of a kind, or a configuration that names its model."
        ),
    ] = None,
    inputs: Annotated[
        Path | None,
        typer.Option("-i", "--inputs", help="CSV with a column t and one per input."),
    ] = None,
    bag: Annotated[
        Path | None, typer.Option("--bag", help="ROS 1 bag with the topics of the configuration.")
    ] = None,
    config: Annotated[
        Path | None, typer.Option("-c", "--config", help="eddi_config.yml: ages, defaults, units.")
    ] = None,
    name: Name = None,
    default_guarantee: DefaultGuarantees = None,
    as_json: Json = False,
    as_csv: Annotated[
        bool, typer.Option("--csv", help="Print every step as CSV: t and each value.")
    ] = False,
    plot: Annotated[
        Path | None,
        typer.Option("--plot", callback=for_pictures, help="SVG to draw inputs and outputs into."),
    ] = None,
) -> None:
    """Run a monitor on a recording; print what changes, or every step as JSON or CSV.

    Example: eddi-scaffold run two_conserts.xml -c consert_a_config.yml --inputs recording.csv
    """
    import json

    from eddi_scaffold.cli.console import console
    from eddi_scaffold.packages.assembly import monitors_of
    from eddi_scaffold.packages.transaction import FileState, write
    from eddi_scaffold.problems import EddiError, error
    from eddi_scaffold.replay.running import changes, picture, steps, table, watched

    if as_json and as_csv:
        raise EddiError(error("G016", "--json and --csv exclude each other"))
    if (inputs is None) == (bag is None):
        raise EddiError(error("G020", "give either --inputs FILE.csv or --bag FILE.bag"))
    model, config = _model_and_config(model, config)
    configs = [config] if config is not None else []
    monitors, problems = monitors_of(model, configs, name, default_guarantee or ())
    if len(monitors) != 1:
        names = ", ".join(monitor.model.name for monitor in monitors)
        message = f"the file holds several models: {names}"
        raise EddiError(error("G005", message, hint="choose one with --name, or give a -c"))
    (monitor,) = monitors
    play, found = _from_bag(monitor, bag) if bag is not None else _from_csv(monitor, inputs)
    if play is None:
        raise EddiError(*problems, *found)
    console.problems([*problems, *found])
    play = watched(play, console.progress)
    if as_json:
        for row in steps(monitor, play):
            console.data(json.dumps(row))
    else:
        for line in (table if as_csv else changes)(monitor, play):
            console.data(line)
    if plot is not None:
        drawn = FileState(picture(monitor, play).encode())
        write(plot.parent, {plot.name: drawn})


def _model_and_config(model: Path | None, config: Path | None) -> tuple[Path | None, Path | None]:
    """Tell model and configuration apart; a configuration may stand in place of its model."""
    from eddi_scaffold.config.model_path import named_model_path
    from eddi_scaffold.config.reading import read_config
    from eddi_scaffold.monitors.loading import is_config
    from eddi_scaffold.problems import EddiError, Place, error
    from eddi_scaffold.source import read_source

    if model is None and config is None:
        message = "say of what: run MODEL, or run CONFIG that names its model"
        raise EddiError(error("G015", message))
    if model is None or config is not None:
        return model, config
    source = read_source(model)
    if not is_config(source):
        return model, None
    parsed, problems = read_config(source)
    if parsed is None:
        raise EddiError(*problems)
    if named_model_path(parsed) is None:
        message = "this is an eddi_config.yml, not a model, and it names none"
        hint = f"run MODEL -c {model}, or name it: `parameters: [{{model: FILE}}]`"
        raise EddiError(error("F008", message, Place(source.name), hint))
    return None, model


def _from_csv(monitor: Monitor, path: Path | None) -> tuple[Play | None, Sequence[Problem]]:
    from eddi_scaffold.replay.recordings import read_recording
    from eddi_scaffold.replay.running import of_recording
    from eddi_scaffold.source import read_source

    assert path is not None
    types = {binding.model.id: binding.model.type for binding in monitor.inputs}
    recording, found = read_recording(read_source(path), types)
    return (of_recording(recording) if recording is not None else None), found


def _from_bag(monitor: Monitor, path: Path) -> tuple[Play | None, Sequence[Problem]]:
    from eddi_scaffold.problems import EddiError, error, warning
    from eddi_scaffold.replay.bags import absent, read_bag, written_by_hand
    from eddi_scaffold.replay.running import of_bag

    if monitor.config is None:
        raise EddiError(error("G020", "--bag needs the topics of a configuration: -c"))
    wanted = {one.id: one for binding in monitor.inputs for one in binding.requires}
    bag = read_bag(path, monitor.config, list(wanted.values()))
    problems = [absent(path, bag, list(wanted.values()))]
    by_hand = written_by_hand(monitor)
    if by_hand:
        message = f"only hand-written code gives {', '.join(by_hand)}: unknown here"
        problems.append(warning("I014", message, hint="a `field:` needs no code"))
    return of_bag(monitor, bag), problems
