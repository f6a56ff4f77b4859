"""``eddi-scaffold diagram``: a picture of a model."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from eddi_scaffold.cli.console import console
from eddi_scaffold.cli.options import for_pictures
from eddi_scaffold.common.files import read_source


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
    from eddi_scaffold.deployments.drawing import picture_of_fleet
    from eddi_scaffold.monitors.exports import pictures
    from eddi_scaffold.monitors.loading import checked_models
    from eddi_scaffold.monitors.survey import configured
    from eddi_scaffold.packages.transaction import FileState, write

    source = read_source(model)
    single = output is None or output.suffix.lower() == ".svg"
    if is_fleet(source):
        files = {f"{source.stem}.svg": picture_of_fleet(source, checked_models)}
    else:
        chosen = configured(source, ())  # a configuration that names its model
        place, marks = Path(chosen.source.name), default_guarantee or ()
        files, problems = pictures(place, name, marks, single=single)
        console.problems([*chosen.problems, *problems])
    if output is None:
        console.data("\n".join(svg.rstrip("\n") for svg in files.values()))
        return
    if single:
        files, output = dict(zip([output.name], files.values(), strict=True)), output.parent
    write(output, {file: FileState(svg.encode()) for file, svg in files.items()})
    for file in files:
        console.success(f"{output / file}")
