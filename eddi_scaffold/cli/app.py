"""The Typer application: global options and the commands in the order of the work."""

from __future__ import annotations

from collections.abc import Callable
from typing import Annotated

import typer

from eddi_scaffold import __version__
from eddi_scaffold.cli import (
    adopt,
    answers,
    check,
    compose,
    connect,
    diagram,
    event,
    example,
    explain,
    export,
    generate,
    merge_driver,
    parse_rossystem,
    regions,
    run,
    show,
    status,
    trace,
    upgrade,
)
from eddi_scaffold.cli.console import console
from eddi_scaffold.cli.everywhere import with_global_options

app = typer.Typer(
    name="eddi-scaffold",
    help="Turn a design-time EDDI into runtime monitors, without losing a hand-written line.",
    epilog="Start with: eddi-scaffold example two-conserts demo",
    context_settings={"help_option_names": ["-h", "--help"]},
    rich_markup_mode=None,
    pretty_exceptions_enable=False,
    no_args_is_help=True,
)


def _version(wanted: bool) -> None:
    if wanted:
        console.data(f"eddi-scaffold {__version__}")
        raise typer.Exit


@app.callback()
@with_global_options
def options(
    *,
    version: Annotated[
        bool, typer.Option("--version", callback=_version, is_eager=True, help="Print the version.")
    ] = False,
) -> None:
    """Turn a design-time EDDI into runtime monitors, without losing a hand-written line."""


_COMMANDS: dict[str, Callable[..., None]] = {
    "example": example.example,
    "check": check.check,
    "show": show.show,
    "parse-rossystem": parse_rossystem.parse_rossystem,
    "connect": connect.connect,
    "run": run.run,
    "generate": generate.generate,
    "upgrade": upgrade.upgrade,
    "adopt": adopt.adopt,
    "status": status.status,
    "trace": trace.trace,
    "regions": regions.regions,
    "merge-driver": merge_driver.merge_driver,
    "diagram": diagram.diagram,
    "compose": compose.compose,
    "export": export.export,
    "answers": answers.answers,
    "event": event.event,
    "explain": explain.explain,
}
for _name, _command in _COMMANDS.items():
    app.command(_name)(with_global_options(_command))
