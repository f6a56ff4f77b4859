"""``eddi-scaffold compose``: do these ConSerts fit together?"""

from __future__ import annotations

from typing import Annotated

import typer

from eddi_scaffold.cli import exit_status
from eddi_scaffold.cli.options import DefaultGuarantees, Json


def compose(
    conserts: Annotated[
        list[str], typer.Argument(metavar="[NAME=]FILE...", help="ConSert YAML or EDDI XML files.")
    ],
    default_guarantee: DefaultGuarantees = None,
    as_json: Json = False,
) -> None:
    """Check whether ConSerts can be composed, and report why not.

    Example: eddi-scaffold compose ConSertA.yml ConSertB.yml
    """
    from pathlib import Path

    from eddi_scaffold.cli.console import console
    from eddi_scaffold.kinds.consert.compose import compose as composition_of
    from eddi_scaffold.kinds.consert.model import ConSert
    from eddi_scaffold.monitors.loading import checked_models
    from eddi_scaffold.problems import EddiError, error

    instances = []
    for argument in conserts:
        label, separator, file = argument.partition("=")
        named = bool(separator) and not Path(argument).exists()
        reading = checked_models(Path(file if named else argument), default_guarantee or ())
        found = [(one.name, one.data) for one in reading.models if isinstance(one.data, ConSert)]
        if named and len(found) != 1:
            message = f"{file} contains {len(found)} ConSerts, `NAME=` can name only one"
            raise EddiError(error("G010", message, hint="leave the name out"))
        instances += [(label if named else name, consert) for name, consert in found]
        if not as_json:
            console.problems(reading.problems)
    repeated = sorted({name for name, _ in instances if [n for n, _ in instances].count(name) > 1})
    if repeated:
        message = f"two instances are called {repeated[0]!r}"
        raise EddiError(error("G011", message, hint="give them names: NAME=FILE"))
    result = composition_of(instances)
    if as_json:
        console.json(result.as_json())
    else:
        for line in result.as_text():
            console.data(line)
    if not result.composable:
        raise typer.Exit(exit_status.NO)
