"""``eddi-scaffold compose``: do these ConSerts fit together?"""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Annotated

import typer

from eddi_scaffold.cli import exit_status
from eddi_scaffold.cli.console import console
from eddi_scaffold.common.files import read_source
from eddi_scaffold.common.problems import EddiError, Place, problem


def compose(
    conserts: Annotated[list[str], typer.Argument(metavar="[NAME=]FILE...")],
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
    from eddi_scaffold.kinds.consert.options import marks_elsewhere
    from eddi_scaffold.monitors.loading import complete_reading, read_models

    marks = default_guarantee or ()
    arguments = [_named(argument) for argument in conserts]
    sources = [read_source(file) for _, file in arguments]
    readings = [read_models(source, marks) for source in sources]
    models = [[m for m in r.models if isinstance(m, ConSertModel)] for r in readings]
    elsewhere = marks_elsewhere([[model.data for model in inside] for inside in models], marks)
    instances = []
    for (label, _), source, reading, inside in zip(
        arguments, sources, readings, models, strict=True
    ):
        problems = tuple(p for p in reading.problems if p.message not in elsewhere)
        complete_reading(source, replace(reading, problems=problems))
        if not inside:
            raise EddiError(problem("F004.no_consert", Place(source.name)))
        if label and len(inside) != 1:
            raise EddiError(problem("G004.one_name", source=source.name, number=len(inside)))
        instances += [(label or model.name, model.data) for model in inside]
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
        raise typer.Exit(exit_status.NO)


def _named(argument: str) -> tuple[str, Path]:
    """Return the name that an argument gives to its ConSert, or nothing, and its file."""
    label, separator, file = argument.partition("=")
    if not separator or Path(argument).exists():
        return "", Path(argument)
    return label, Path(file)
