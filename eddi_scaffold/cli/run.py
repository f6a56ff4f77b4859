"""``eddi-scaffold run``: a monitor on recorded inputs, without ROS and without generation."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from eddi_scaffold.cli.options import DefaultGuarantees, Json, Name


def run(
    model: Annotated[Path, typer.Argument(help="EDDI XML, or a model file of a kind.")],
    inputs: Annotated[
        Path, typer.Option("-i", "--inputs", help="CSV with a column t and one per input.")
    ],
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
        Path | None, typer.Option("--plot", help="SVG to draw inputs and outputs into.")
    ] = None,
) -> None:
    """Run a monitor on a recording; print what changes, or every step as JSON or CSV.

    Example: eddi-scaffold run two_conserts.xml -c consert_a_config.yml --inputs recording.csv
    """
    import json

    from eddi_scaffold.assembly import monitors_of
    from eddi_scaffold.console import console
    from eddi_scaffold.problems import EddiError, error
    from eddi_scaffold.recording import read_recording
    from eddi_scaffold.running import changes, picture, steps, table
    from eddi_scaffold.source import read_source
    from eddi_scaffold.transaction import FileState, write

    if as_json and as_csv:
        raise EddiError(error("G016", "--json and --csv exclude each other"))
    configs = [config] if config is not None else []
    monitors, problems = monitors_of(model, configs, name, default_guarantee or ())
    if len(monitors) != 1:
        names = ", ".join(monitor.model.name for monitor in monitors)
        message = f"the file holds several models: {names}"
        raise EddiError(error("G005", message, hint="choose one with --name, or give a -c"))
    types = {binding.model.id: binding.model.type for binding in monitors[0].inputs}
    recording, found = read_recording(read_source(inputs), types)
    if recording is None:
        raise EddiError(*problems, *found)
    console.problems([*problems, *found])
    if as_json:
        for t, output in steps(monitors[0], recording):
            console.data(json.dumps({"t": t, "outputs": output}))
    else:
        for line in (table if as_csv else changes)(monitors[0], recording):
            console.data(line)
    if plot is not None:
        drawn = FileState(picture(monitors[0], recording).encode())
        write(plot.parent, {plot.name: drawn})
