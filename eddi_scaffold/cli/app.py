"""The Typer application: global options and the commands in the order of the work."""

from __future__ import annotations

from typing import Annotated

import typer

from eddi_scaffold import __version__
from eddi_scaffold.cli import (
    adopt,
    answers,
    check,
    compose,
    diagram,
    event,
    example,
    export,
    generate,
    parse_rossystem,
    regions,
    run,
    show,
    status,
    trace,
    upgrade,
)
from eddi_scaffold.cli.console import console

app = typer.Typer(
    name="eddi-scaffold",
    help="Turn a design-time EDDI into runtime monitors, without losing a hand-written line.",
    epilog="-q, -v, --color and --traceback may stand behind the command as well. "
    "Start with: eddi-scaffold example two-conserts demo",
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
def options(
    version: Annotated[
        bool, typer.Option("--version", callback=_version, is_eager=True, help="Print the version.")
    ] = False,
    quiet: Annotated[bool, typer.Option("-q", "--quiet", help="Print errors only.")] = False,
    verbose: Annotated[bool, typer.Option("-v", "--verbose", help="Print infos as well.")] = False,
    color: Annotated[
        bool | None, typer.Option("--color/--no-color", help="Default: on a terminal.")
    ] = None,
    traceback: Annotated[
        bool, typer.Option("--traceback", help="Show where a bug happened.")
    ] = False,
) -> None:
    """Turn a design-time EDDI into runtime monitors, without losing a hand-written line."""
    console.quiet, console.verbose, console.colour = quiet, verbose, color


app.command("example")(example.example)
app.command("check")(check.check)
app.command("show")(show.show)
app.command("parse-rossystem")(parse_rossystem.parse_rossystem)

app.command("run")(run.run)
app.command("generate")(generate.generate)
app.command("upgrade")(upgrade.upgrade)
app.command("adopt")(adopt.adopt)
app.command("status")(status.status)
app.command("trace")(trace.trace)
app.command("regions")(regions.regions)
app.command("diagram")(diagram.diagram)
app.command("compose")(compose.compose)
app.command("export")(export.export)
app.command("answers")(answers.answers)
app.command("event")(event.event)
