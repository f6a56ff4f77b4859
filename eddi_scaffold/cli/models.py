"""Commands on models: ``diagram compose export``."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Annotated

import typer

from eddi_scaffold.cli.console import ExitStatus, console
from eddi_scaffold.cli.options import Output, for_pictures
from eddi_scaffold.common.files import read_source
from eddi_scaffold.common.problems import EddiError, Place, did_you_mean, in_order, problem


def diagram(
    model: Path,
    output: Annotated[Path | None, typer.Option("-o", "--output", callback=for_pictures)] = None,
    name: str | None = None,
    default_guarantee: list[str] | None = None,
) -> None:
    """Draw a model as SVG.

    With several models in the file, one picture for each.

    Of a deployment.yml: its robots, their monitors, and whose guarantees fulfil whose demands.

    Example: eddi-scaffold diagram two_conserts.xml --name ConSertA -o conserta.svg

    Args:
        model: EDDI XML, a model file of a kind, an eddi_config.yml that names its model, or
            deployment.yml.
        output: SVG file, or a folder for one picture per model.
    """
    from eddi_scaffold.config.deployment_file import is_fleet
    from eddi_scaffold.deployments.fleet_checks import picture_of_fleet
    from eddi_scaffold.monitors.exports import pictures
    from eddi_scaffold.monitors.loading import checked_models, model_for
    from eddi_scaffold.monitors.survey import configured
    from eddi_scaffold.packages.transaction import write

    source = read_source(model)
    single = output is None or output.suffix.lower() == ".svg"
    if is_fleet(source):
        files = {f"{source.stem}.svg": picture_of_fleet(source, checked_models)}
    else:
        source, configs, warnings = configured(source, (), name)  # one that names its model
        marks = default_guarantee or ()
        if configs and name is not None:
            name = model_for(configs[0], checked_models(Path(source.name), marks).models).name
        files, problems = pictures(Path(source.name), name, marks, single=single)
        console.problems([*warnings, *problems])
    if output is None:
        console.data("\n".join(svg.rstrip("\n") for svg in files.values()))
        return
    if single:
        files, output = dict(zip([output.name], files.values(), strict=True)), output.parent
    write(output, {file: svg.encode() for file, svg in files.items()})
    for file in files:
        console.say(f"{output / file}")


def compose(
    conserts: list[Path],
    default_guarantee: list[str] | None = None,
    as_json: bool = False,
) -> None:
    """Check whether ConSerts can be composed, and report why not.

    Example: eddi-scaffold compose ConSertA.yml ConSertB.yml

    Args:
        conserts: ConSert YAML or EDDI XML files.
    """
    from eddi_scaffold.kinds.consert.compose import compose as composition_of
    from eddi_scaffold.kinds.consert.consert_model import ConSertModel
    from eddi_scaffold.monitors.loading import complete_reading, read_models

    marks = default_guarantee or ()
    sources = [read_source(file) for file in conserts]
    readings = [read_models(source, marks) for source in sources]
    models = [[m for m in r.models if isinstance(m, ConSertModel)] for r in readings]
    # a mark is wrong where no file has its guarantee
    case = "C008.no_guarantee"
    wrong = [
        {p.message for p in reading.problems if p.case == case}
        for reading, inside in zip(readings, models, strict=True)
        if inside
    ]
    instances = []
    for source, reading, inside in zip(sources, readings, models, strict=True):
        problems = tuple(
            p
            for p in reading.problems
            if p.case != case or all(p.message in messages for messages in wrong)
        )
        complete_reading(source, replace(reading, problems=problems))
        if not inside:
            raise EddiError(problem("F004.no_consert", Place(source.name)))
        instances += [(model.name, model.data) for model in inside]
        if not as_json:
            console.problems(problems)
    result = composition_of(instances)
    if as_json:
        console.json(result.as_json())
    else:
        console.problems(result.problems)
        for line in result.as_text():
            console.data(line)
    if not result.composable:
        raise typer.Exit(ExitStatus.NO)


def export(
    model: Path,
    output: Output = None,
    into: Path | None = None,
    at: str = "/",
    kind: str | None = None,
    name: str | None = None,
    config: list[Path] | None = None,
    default_guarantee: list[str] | None = None,
) -> None:
    """Write each model as a file of its own.

    YAML; networks as XDSL and XMLBIF, trees as Open-PSA.

    With configurations, the models that these are about, with what they add. With --into, one file
    of events or SafeML settings is written into an EDDI, of which every other byte stays.

    Example: eddi-scaffold export example.xml -o models

    Args:
        model: EDDI XML, a model file of a kind, or an eddi_config.yml that names its model.
        output: Folder for the files.
        into: EDDI XML into which events or SafeML settings are written.
        at: Fragment path of the element that gets them: `//@a.0/@b.1`.
        kind: Only models of this kind, such as consert.
    """
    from eddi_scaffold.kinds import kinds
    from eddi_scaffold.monitors.exports import written_into
    from eddi_scaffold.monitors.loading import checked_models, is_config, select_models
    from eddi_scaffold.packages.assembly import monitors_of
    from eddi_scaffold.packages.transaction import write

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
        new = written_into(before, at, chosen)
        write(into.parent, {into.name: new}, {into.name: before.data})
        console.data(str(into))
        return
    assert output is not None
    files: dict[str, bytes] = {}
    for item in chosen:
        for file, text in item.export().items():
            # Upper and lower case are the same on some disks.
            if file.lower() in map(str.lower, files):
                raise EddiError(problem("G004.one_file", item.place, file=file, model=item.name))
            files[file] = text.encode()
    write(output, files)
    for file in sorted(files):
        console.data(str(output / file))
