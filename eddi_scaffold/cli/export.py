"""``eddi-scaffold export``: the models of an EDDI in their own formats."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from eddi_scaffold.cli.options import ConfigFiles, DefaultGuarantees, Name, in_a_folder


def export(
    model: Annotated[
        Path,
        typer.Argument(
            help="EDDI XML, a model file of a kind, or an eddi_config.yml that names its model."
        ),
    ],
    output: Annotated[
        Path | None,
        typer.Option("-o", "--output", callback=in_a_folder, help="Folder for the files."),
    ] = None,
    into: Annotated[
        Path | None,
        typer.Option("--into", help="EDDI XML into which events or SafeML settings are written."),
    ] = None,
    at: Annotated[
        str,
        typer.Option("--at", help="Fragment path of the element that gets them: `//@a.0/@b.1`."),
    ] = "/",
    kind: Annotated[
        str | None, typer.Option("--kind", help="Only models of this kind, such as consert.")
    ] = None,
    name: Name = None,
    config: ConfigFiles = None,
    default_guarantee: DefaultGuarantees = None,
) -> None:
    """Write each model as a file of its own.

    YAML; networks as XDSL and XMLBIF, trees as Open-PSA.

    With configurations, the models that these are about, with what they add. With --into, one file
    of events or SafeML settings is written into an EDDI, of which every other byte stays.

    Example: eddi-scaffold export example.xml -o models
    """
    import stat
    from dataclasses import replace

    from eddi_scaffold.cli.console import console
    from eddi_scaffold.common.files import read_source
    from eddi_scaffold.common.problems import EddiError, did_you_mean, in_order, problem
    from eddi_scaffold.kinds import kinds
    from eddi_scaffold.monitors.exports import written_into
    from eddi_scaffold.monitors.loading import checked_models, is_config, select_models
    from eddi_scaffold.packages.assembly import monitors_of
    from eddi_scaffold.packages.transaction import FileState, write

    if (output is None) == (into is None):
        raise EddiError(problem("G000.one_destination"))
    if kind is not None and kind not in kinds():
        hint = did_you_mean(kind, kinds()) or f"kinds: {', '.join(kinds())}"
        raise EddiError(problem("G008.kind", hint=hint, kind=kind))
    kind_only = kinds()[kind] if kind else None
    marks = default_guarantee or ()
    is_alone = is_config(read_source(model))  # it names its model
    configs = [*([model] if is_alone else ()), *(config or ())]
    if configs:
        monitors, problems = monitors_of(None if is_alone else model, configs, name, marks)
        chosen = select_models([monitor.model for monitor in monitors], None, kind_only)
    else:
        reading = checked_models(model, marks)
        chosen, problems = select_models(reading.models, name, kind_only), list(reading.problems)
    checked = [problem for item in chosen for problem in item.check()]
    console.problems(in_order([*problems, *checked]))
    if into is not None:
        before = read_source(into)
        old = FileState(before.data, stat.S_IMODE(into.stat().st_mode))
        new = replace(old, data=written_into(before, at, chosen))
        write(into.parent, {into.name: new}, {into.name: before.data})
        console.data(str(into))
        return
    assert output is not None
    files: dict[str, FileState] = {}
    for item in chosen:
        for file, text in item.export().items():
            # Upper and lower case are the same on some disks.
            if file.lower() in map(str.lower, files):
                raise EddiError(problem("G004.one_file", item.place, file=file, model=item.name))
            files[file] = FileState(text.encode())
    write(output, files)
    for file in sorted(files):
        console.data(str(output / file))
